#!/usr/bin/env python3
"""Measures how deep rods and plates that fall aslant go into the ground.

Rods of 1 x 1 x 40 cm and plates of 1 x 20 x 30 cm fall on a slab, each in its own world and in any
orientation. One end lands first, and the impulse there makes the other end faster. What guards against that
is argued in decision 51. All bodies are models at default settings.

    .venv/bin/python benchmarks/aslant.py
    .venv/bin/python benchmarks/aslant.py --speed 6 --rate 200
"""

from __future__ import annotations

import argparse

import numpy as np
import trimesh
import voxshell as vx
from trimesh.transformations import random_rotation_matrix

BODIES = {"rods": (0.01, 0.01, 0.4), "plates": (0.01, 0.2, 0.3)}  # m
RESTITUTIONS = (0.0, 0.6, 1.0)
SECONDS = 0.5


def fall(
    model: vx.Model, slab: vx.Model, restitution: float, speed: float, rate: float, seed: int
) -> float:
    """The depth of the deepest vertex in the ground, over all steps, m."""
    world = vx.World(time_step=1 / rate, sleeping=False)
    world.add(slab, mass=0, pose=(0, 0, -0.1), restitution=1.0)
    rng = np.random.default_rng(seed)
    pose = random_rotation_matrix(rng.random(3))
    vertices = np.asarray(model.mesh.vertices)
    pose[2, 3] = rng.uniform(0.001, 1.5) * speed / rate - (vertices @ pose[2, :3]).min()
    body = world.add(model, mass=1.0, pose=pose, restitution=restitution)
    body.linear_velocity = (0, 0, -speed)
    deepest = 0.0
    for _ in range(round(SECONDS * rate)):
        world.step()
        lowest = (vertices @ body.pose[2, :3]).min() + body.pose[2, 3]
        deepest = max(deepest, -lowest)
    return deepest


def main() -> None:
    """Runs what the arguments name."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=60, help="of each kind (60)")
    parser.add_argument("--speed", type=float, default=3.0, help="m/s (3)")
    parser.add_argument("--rate", type=float, default=60.0, help="steps a second (60)")
    arguments = parser.parse_args()
    slab = vx.Model.from_mesh(trimesh.creation.box((2.0, 2.0, 0.2)))
    print(f"{arguments.count} of each, {arguments.speed:g} m/s, {arguments.rate:g} Hz: depth, mm")
    print(f"{'':>8}  {'restitution':>11}  {'median':>8}  {'95 %':>8}  {'deepest':>8}")
    for name, sides in BODIES.items():
        model = vx.Model.from_mesh(trimesh.creation.box(sides))
        for restitution in RESTITUTIONS:
            depths = 1e3 * np.array(
                [
                    fall(model, slab, restitution, arguments.speed, arguments.rate, seed)
                    for seed in range(arguments.count)
                ]
            )
            figures = [*np.percentile(depths, (50, 95)), depths.max()]
            print(f"{name:>8}  {restitution:11.1f}  " + "  ".join(f"{f:8.3f}" for f in figures))


if __name__ == "__main__":
    main()
