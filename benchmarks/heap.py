#!/usr/bin/env python3
"""Times steps in which bunnies fall on each other, are poured into a bin, and lie in a heap.

All bodies and the bin are models at default settings, that is, by tolerance. With --uniform they are made
of voxels of 2 mm, the bin of 5 mm, and a pair tests the points of the model that has fewer of them, as in
the thesis. There are 200 steps a second, bodies do not fall asleep, and worlds use one thread.

    .venv/bin/python benchmarks/heap.py                  # falls of two, then 100 poured for 5 s
    .venv/bin/python benchmarks/heap.py --uniform
    .venv/bin/python benchmarks/heap.py --count 400 --heap build/heap.npz   # keeps the heap, or steps a kept one

To compare two versions, step the heap that one of them has kept. Then what the process takes more of memory is
that of the pairs, too: a pouring in the same process leaves memory that is used again.
"""

from __future__ import annotations

import argparse
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import voxshell as vx
from trimesh.transformations import random_rotation_matrix
from voxshell.measuring.timing import pinned
from voxshell_studies.crowd import Engine, build_heap, measure_memory
from voxshell_studies.scenes.bunny import BunnySettings
from voxshell_studies.scenes.pour import PourSettings

if TYPE_CHECKING:
    from collections.abc import Mapping

RATE = 200.0  # Hz
SPEEDS = (0.5, 2.0, 10.0)  # m/s
FALLS = 12
SETTLED_AFTER, TIMED = 50, 200  # steps
STAGES = ("step", "narrow_phase", "query", "reduction", "manifold")


def build(mesh: vx.Mesh, uniform: float | None, points: int | None = None) -> vx.Model:
    """The model, by tolerance unless a voxel size is given."""
    if uniform is None:
        return vx.Model.from_mesh(mesh)
    return vx.Model.from_mesh(mesh, voxel_size=uniform, target_points=points)


def make_world(is_uniform: bool) -> vx.World:
    """An empty world for models of that kind."""
    shell = "fewest" if is_uniform else "auto"
    return vx.World(time_step=1 / RATE, sleeping=False, shell=shell, threads=1)


def engine_of(is_uniform: bool) -> Engine:
    """What heaps of models of that kind are called."""
    return "uniform" if is_uniform else "default"


def describe(values: np.ndarray, unit: float) -> str:
    """Median, 90 and 99 % and the most."""
    figures = [*np.percentile(values / unit, (50, 90, 99)), values.max() / unit]
    return "  ".join(f"{figure:9.3g}" for figure in figures)


def time_falls(is_uniform: bool) -> None:
    """Of a bunny on another one that is held, the steps in which their bounding balls meet."""
    settings = BunnySettings()
    mesh = settings.build_mesh()
    model = build(mesh, settings.voxel_size if is_uniform else None, settings.fine_points)
    radius = float(np.linalg.norm(mesh.vertices - mesh.vertices.mean(axis=0), axis=1).max())
    print(f"\ntwo bunnies of {len(model.shell)} points, narrow phase of a step, us")
    print(f"{'m/s':>6}  {'steps':>6}  {'median':>9}  {'90 %':>9}  {'99 %':>9}  {'most':>9}")
    for speed in SPEEDS:
        rng = np.random.default_rng(3)
        seconds = []
        for _ in range(FALLS):
            world = make_world(is_uniform)
            low = world.add(model, mass=0, pose=random_rotation_matrix(rng.random(3)))
            pose = random_rotation_matrix(rng.random(3))
            pose[:3, 3] = (*rng.uniform(-0.5, 0.5, 2) * radius, 3.0 * radius)
            high = world.add(model, mass=1.0, pose=pose)
            high.linear_velocity = (0, 0, -speed)
            world.step()  # what models prepare at their first step
            for _ in range(100 if speed < SPEEDS[-1] else 40):
                apart = np.linalg.norm(high.pose[:3, 3] - low.pose[:3, 3])
                world.step()
                if apart < 2.0 * radius:
                    seconds.append(world.timings[-1]["narrow_phase"])
        print(f"{speed:6.1f}  {len(seconds):6d}  {describe(np.array(seconds), 1e-6)}")


def print_stages(what: str, timings: np.ndarray) -> None:
    """A line for each stage of the steps."""
    for stage in STAGES:
        print(f"{what:>8}  {stage:>13}  {describe(timings[stage], 1e-3)}")


def pour(settings: PourSettings, is_uniform: bool, threads: int) -> dict[str, np.ndarray]:
    """Times the steps of the pouring. The poses and velocities of the heap that it leaves."""
    world, bodies = build_heap(engine_of(is_uniform), settings, settings.compute_starts(), threads)
    world.step(round(settings.seconds * RATE))
    print_stages("pouring", world.timings)
    return {
        "poses": np.array([b.pose for b in bodies]),
        "velocities": np.array([(b.linear_velocity, b.angular_velocity) for b in bodies]),
    }


def time_heap(
    settings: PourSettings, is_uniform: bool, threads: int, heap: Mapping[str, np.ndarray]
) -> None:
    """Times the steps of a heap, and prints what a comparison has to have in common."""
    world, bodies = build_heap(engine_of(is_uniform), settings, heap["poses"], threads)
    for each, (linear, angular) in zip(bodies, heap["velocities"], strict=True):
        each.linear_velocity, each.angular_velocity = linear, angular
    before = measure_memory()
    world.step(SETTLED_AFTER)
    world.step(TIMED)
    print_stages("heap", world.timings[-TIMED:])
    contacts = world.contacts()
    depth = np.percentile(contacts["depth"], 99)
    height = np.mean([b.pose[2, 3] for b in bodies])
    print(
        f"{len(contacts)} contacts, 99 % of them less deep than {depth * 1e6:.3g} um; bodies are "
        f"{height * 1e3:.4g} mm high; {measure_memory() - before:.0f} MB more memory than before the steps"
    )


def main() -> None:
    """Runs what the arguments name."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--uniform", action="store_true", help="models of voxels of one size")
    parser.add_argument("--count", type=int, default=100, help="bodies in the heap (100)")
    parser.add_argument("--seconds", type=float, default=5.0, help="of pouring (5)")
    parser.add_argument("--heap", type=Path, help="file that the heap is kept in (.npz)")
    parser.add_argument("--threads", type=int, default=1, help="of the heap's worlds (1)")
    parser.add_argument("--no-falls", action="store_true", help="the heap alone")
    arguments = parser.parse_args()
    settings = PourSettings(count=arguments.count, seconds=arguments.seconds)
    path: Path | None = arguments.heap
    with pinned() if arguments.threads == 1 else nullcontext():
        if not arguments.no_falls:
            time_falls(arguments.uniform)
        print(f"\n{settings.count} bunnies in a bin, ms")
        print(f"{'':>8}  {'':>13}  {'median':>9}  {'90 %':>9}  {'99 %':>9}  {'most':>9}")
        heap: Mapping[str, np.ndarray]
        if path is not None and path.exists():
            heap = np.load(path)
        else:
            heap = pour(settings, arguments.uniform, arguments.threads)
            if path is not None:
                path.parent.mkdir(parents=True, exist_ok=True)
                np.savez(path, **heap)
        time_heap(settings, arguments.uniform, arguments.threads, heap)


if __name__ == "__main__":
    main()
