"""Lets round bodies fall, fly and roll on edges, wires, balls and flat ground, and measures how deep they get.

.venv/bin/python benchmarks/round_landings.py --help
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import voxshell as vx
from trimesh.creation import box, capsule, cylinder, icosphere
from trimesh.transformations import random_rotation_matrix, rotation_matrix

RATES = (200, 60, 30)
G = 9.81  # m/s2
DEEP = 5e-4  # meters
BALL = 0.03  # meters, its radius
ROD = 0.005
WIRE = 0.0005
CAPSULE = (0.02, 0.04)  # its radius, and half the length of its axis
LYING = rotation_matrix(np.pi / 2, (1, 0, 0))

Depth = Callable[[np.ndarray], float]  # of a body at a pose, meters


@dataclass(frozen=True)
class Fall:
    """A body that falls on something fixed."""

    body: vx.Model | vx.Sphere
    ground: vx.Model | vx.Box
    depth: Depth
    reach: float  # of the body, meters
    top: float  # of the ground
    heights: tuple[float, ...]  # that it falls
    aside: tuple[float, float]  # of its center
    place: tuple[float, float, float] = (0, 0, 0)  # of the ground

    def run(self, rate: int, height: float, seed: int) -> float:
        """Return how deep the body is at most, in meters."""
        random = np.random.default_rng(seed)
        world = vx.World(time_step=1 / rate)
        world.add(self.ground, mass=0, pose=self.place)
        pose = random_rotation_matrix(random.random(3))
        low = self.top + self.reach + height * random.uniform(0.9, 1.1)
        pose[:3, 3] = random.uniform(*self.aside), random.uniform(-0.02, 0.02), low
        body = world.add(self.body, mass=0.1, pose=pose)
        deepest = 0.0
        for _ in range(int(rate * (np.sqrt(2.2 * (height + self.reach) / G) + 0.1))):
            world.step()
            deepest = max(deepest, self.depth(body.pose))
        return deepest


def ball_in_slab(pose: np.ndarray) -> float:
    """Of a ball in a slab whose edge is the y axis."""
    place = pose[:3, 3]
    return BALL - float(np.linalg.norm(place - np.clip(place, (-0.1, -0.15, -0.1), (0, 0.15, 0))))


def ball_in_rod(pose: np.ndarray) -> float:
    """Of a ball in a rod along the y axis."""
    return BALL + ROD - float(np.hypot(pose[0, 3], pose[2, 3]))


def capsule_in_ball(pose: np.ndarray) -> float:
    """Of a capsule in a ball about the origin."""
    radius, half = CAPSULE
    along = np.clip(-pose[:3, 3] @ pose[:3, 2], -half, half)
    return radius + BALL - float(np.linalg.norm(pose[:3, 3] + along * pose[:3, 2]))


def ellipsoid_in_plane(axes: np.ndarray) -> Depth:
    """Of an ellipsoid in the ground."""
    return lambda pose: float(np.linalg.norm(axes * pose[2, :3]) - pose[2, 3])


def build_rod(radius: float) -> vx.Model:
    """Along the y axis."""
    return vx.Model.from_mesh(cylinder(radius, 0.3, sections=64, transform=LYING))


def build_falls() -> Iterator[tuple[str, Fall]]:
    """What falls on what."""
    ball = vx.Model.from_mesh(icosphere(4, BALL))
    slab = vx.Model.from_mesh(box((0.1, 0.3, 0.1)))
    beside, middle = (0.1 * BALL, 0.9 * BALL), (-0.05, 0, -0.05)
    past = ((0.01, 0.05, 0.2, 1.0), beside, middle)
    yield "ball past a slab", Fall(ball, slab, ball_in_slab, BALL, 0, *past)
    shape = vx.Box((0.05, 0.15, 0.05))
    yield "ball past a vx.Box", Fall(ball, shape, ball_in_slab, BALL, 0, *past)
    yield "vx.Sphere past a slab", Fall(vx.Sphere(BALL), slab, ball_in_slab, BALL, 0, *past)
    heights = (0.05, 0.45)
    near = (-0.5 * BALL, 0.5 * BALL)
    yield "ball on a rod", Fall(ball, build_rod(ROD), ball_in_rod, BALL, ROD, heights, near)
    radius, half = CAPSULE
    mesh = capsule(2 * half, radius, count=[64, 64])
    mesh.apply_translation(-mesh.center_mass)
    model, reach = vx.Model.from_mesh(mesh), radius + half
    near = (-0.5 * reach, 0.5 * reach)
    yield "capsule on a ball", Fall(model, ball, capsule_in_ball, reach, BALL, heights, near)
    ground = vx.Model.from_mesh(box((2, 2, 0.1)))
    for name, axes in (("ellipsoid", (0.08, 0.05, 0.03)), ("egg", (0.03, 0.02, 0.02))):
        mesh = icosphere(4, 1.0).apply_scale(axes)
        depth = ellipsoid_in_plane(np.array(axes))
        flat = ((0.05, 0.3), (0.0, 0.0), (0, 0, -0.05))
        yield (
            f"{name} on a slab",
            Fall(vx.Model.from_mesh(mesh), ground, depth, max(axes), 0, *flat),
        )


def print_falls(seeds: int) -> None:
    """How many falls end deep, and the deepest."""
    for name, fall in build_falls():
        for rate in RATES:
            depths = [fall.run(rate, h, seed) for h in fall.heights for seed in range(seeds)]
            deep = sum(depth > DEEP for depth in depths)
            print(
                f"{name}, {rate} Hz: {deep} of {len(depths)} deeper than 0.5 mm, at most "
                f"{1e3 * max(depths):.2f} mm",
                flush=True,
            )


def print_wires(seeds: int) -> None:
    """How many balls that fly aslant at a wire pass it."""
    wire = build_rod(WIRE)
    for rate in RATES:
        passed = thrown = 0
        for radius in (0.0025, 0.005):
            ball = vx.Model.from_mesh(icosphere(4, radius))
            for speed, seed in np.ndindex(2, seeds):
                random = np.random.default_rng(seed)
                velocity = np.array((*(0.3 * random.normal(size=2)), -1.0))
                velocity *= (1.0, 3.0)[speed] / np.linalg.norm(velocity)
                across = np.array((-velocity[2], 0, velocity[0]))
                across *= random.uniform(-0.6, 0.6) * radius / np.linalg.norm(across)
                world = vx.World(gravity=(0, 0, 0), time_step=1 / rate)
                world.add(wire, mass=0, friction=0)
                pose = random_rotation_matrix(random.random(3))
                pose[:3, 3] = across - random.uniform(0.1, 0.15) * velocity
                body = world.add(ball, mass=0.001, pose=pose, friction=0)
                body.linear_velocity = velocity
                world.step(int(0.35 * rate))
                passed += bool(np.linalg.norm(body.linear_velocity - velocity) < 1e-6)
                thrown += 1
        print(f"balls at a wire, {rate} Hz: {passed} of {thrown} pass", flush=True)


def print_cans() -> None:
    """The least speed that cans keep which land on their side while they roll."""
    ground = vx.Model.from_mesh(box((4, 1, 0.1)))
    for radius, length in ((0.05, 0.06), (0.03, 0.1)):
        can = vx.Model.from_mesh(cylinder(radius, length, sections=96, transform=LYING))
        for rate in RATES:
            kept = []
            for height in (0.002, 0.005, 0.01, 0.02):
                for speed in (0.5, 1.0):
                    world = vx.World(time_step=1 / rate)
                    world.add(ground, mass=0, pose=(1, 0, -0.05))
                    body = world.add(can, mass=1, pose=(0, 0, radius + height))
                    body.linear_velocity = (speed, 0, 0)
                    body.angular_velocity = (0, speed / radius, 0)
                    world.step(rate // 2)
                    kept.append(body.linear_velocity[0] / speed)
            print(
                f"can of {2e3 * radius:g} by {1e3 * length:g} mm lands, {rate} Hz: at least "
                f"{min(kept):.2f} of the speed",
                flush=True,
            )


def main() -> None:
    """Measure all of them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=24, help="of each height or speed (24)")
    seeds = parser.parse_args().seeds
    warnings.simplefilter("ignore", vx.AccuracyWarning)
    print_falls(seeds)
    print_wires(seeds)
    print_cans()


if __name__ == "__main__":
    main()
