"""Rolls balls over the seams of tiles, and throws round bodies with spin into a room with bars and walls.

.venv/bin/python benchmarks/round_bodies.py
"""

from __future__ import annotations

import warnings
from itertools import product

import numpy as np
import trimesh
import voxshell as vx
from trimesh.creation import box, cylinder, icosphere, torus
from trimesh.transformations import random_rotation_matrix, rotation_matrix, translation_matrix

RATES = (200, 60, 30)
TILE = 0.2  # meters
RADIUS = 0.03  # of the thrown bodies
BODIES = {
    "balls": lambda: icosphere(4, RADIUS),
    "ellipsoids": lambda: icosphere(4, 1.0).apply_scale((RADIUS, 0.7 * RADIUS, 0.7 * RADIUS)),
    "tori": lambda: torus(0.7 * RADIUS, 0.3 * RADIUS, 48, 24),
    "cans": lambda: cylinder(0.7 * RADIUS, 2 * RADIUS, sections=48),
}


def roll(rate: int, tile: vx.Model | vx.Box, ball: vx.Model, radius: float, speed: float, pose):
    """Return the fraction of the speed after two seconds, and the highest hop in meters."""
    world = vx.World(time_step=1 / rate)
    for i, j in np.ndindex(int(2 * speed / TILE) + 3, 3):
        world.add(tile, mass=0, pose=(TILE * i, TILE * (j - 1) + 0.03, -0.01))
    pose = pose.copy()
    pose[:3, 3] = 0.01, 0.0, radius
    body = world.add(ball, mass=0.1, pose=pose)
    body.linear_velocity = (speed, 0, 0)
    body.angular_velocity = (0, speed / radius, 0)
    hop = 0.0
    for _ in range(2 * rate):
        world.step()
        hop = max(hop, abs(body.position[2] - radius))
    return body.linear_velocity[0] / speed, hop


def roll_over_tiles() -> None:
    """Print the slowest of eight orientations of each ball."""
    tiles = {
        "models": vx.Model.from_mesh(box((TILE, TILE, 0.02))),
        "boxes": vx.Box((0.1, 0.1, 0.01)),
    }
    for (name, tile), (radius, speed) in product(tiles.items(), ((0.05, 1.0), (0.03, 0.5))):
        model = vx.Model.from_mesh(icosphere(4, radius))
        for rate in RATES:
            random = np.random.default_rng(0)
            poses = [random_rotation_matrix(random.random(3)) for _ in range(8)]
            left, hops = zip(
                *(roll(rate, tile, model, radius, speed, p) for p in poses), strict=True
            )
            print(
                f"ball of {2e3 * radius:g} mm over {name}, {rate} Hz: {min(left):.3f} of the speed, "
                f"hops by {1e3 * max(hops):.2f} mm",
                flush=True,
            )


def build_room() -> trimesh.Trimesh:
    """A floor with three steps, a bar and walls, as one mesh."""
    parts = [box((1, 1, 0.05), translation_matrix((0, 0, -0.025)))]
    for x, y, high in ((0.3, 0, 0.03), (-0.25, 0.2, 0.012), (0, -0.3, 0.05)):
        parts.append(box((0.1, 0.3, high + 0.02), translation_matrix((x, y, high / 2 - 0.01))))
    turn = translation_matrix((0, 0.1, 0.02)) @ rotation_matrix(np.pi / 2, (0, 1, 0))
    parts.append(cylinder(0.02, 0.6, sections=48, transform=turn))
    for side in (-0.5, 0.5):
        parts.append(box((0.03, 1, 0.3), translation_matrix((side, 0, 0.1))))
        parts.append(box((1, 0.03, 0.3), translation_matrix((0, side, 0.1))))
    return trimesh.boolean.union(parts, engine="manifold")


def throw(
    rate: int, room: vx.Model, body: vx.Model, depth_of, random: np.random.Generator
) -> float:
    """Return how deep a thrown body is at most, in meters, at 30 times a second."""
    restitution, friction = float(random.choice([0, 0, 0.5])), float(random.choice([0.0, 0.5, 1.0]))
    world = vx.World(time_step=1 / rate)
    world.add(room, mass=0, friction=friction, restitution=restitution)
    pose = random_rotation_matrix(random.random(3))
    pose[:3, 3] = (*random.uniform(-0.35, 0.35, 2), 0.15)
    thrown = world.add(body, mass=0.1, friction=friction, restitution=restitution, pose=pose)
    thrown.linear_velocity = random.normal(size=3) * (1, 1, 0.3)
    thrown.angular_velocity = random.normal(size=3) * 15
    deepest = 0.0
    for i in range(int(1.5 * rate)):
        world.step()
        if i % max(rate // 30, 1) == 0:
            deepest = max(deepest, depth_of(thrown.pose))
    return deepest


def throw_into_room() -> None:
    """Print how deep twelve of each body are at most: of every 17th vertex, by trimesh."""
    mesh = build_room()
    room, distance = vx.Model.from_mesh(mesh), trimesh.proximity.ProximityQuery(mesh)
    for rate in RATES:
        for name, make in BODIES.items():
            body = vx.Model.from_mesh(make())
            vertices = np.asarray(body.mesh.vertices)[::17]

            def depth_of(pose: np.ndarray, vertices: np.ndarray = vertices) -> float:
                places = vertices @ pose[:3, :3].T + pose[:3, 3]
                return float(distance.signed_distance(places).max())

            random = np.random.default_rng(5)
            deepest = max(throw(rate, room, body, depth_of, random) for _ in range(12))
            print(f"12 {name} in a room, {rate} Hz: {1e3 * deepest:.2f} mm deep", flush=True)


def main() -> None:
    """Roll and throw."""
    warnings.simplefilter("ignore", vx.AccuracyWarning)
    roll_over_tiles()
    throw_into_room()


if __name__ == "__main__":
    main()
