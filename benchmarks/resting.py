"""Times the steps of bodies at rest on each other, at default settings.

.venv/bin/python benchmarks/resting.py --help
"""

from __future__ import annotations

import argparse
from collections.abc import Callable

import numpy as np
import trimesh
import voxshell as vx

Bodies = list[tuple[vx.Model, tuple[float, float, float]]]


def build_box(*sides: float) -> vx.Model:
    """A default model of a box."""
    return vx.Model.from_mesh(trimesh.creation.box(sides))


def stack(model: vx.Model, height: float, count: int) -> Bodies:
    """Bodies on top of each other."""
    return [(model, (0.0, 0.0, height * (level + 0.5))) for level in range(count)]


def row(count: int) -> Bodies:
    """Cubes whose sides touch."""
    cube = build_box(0.1, 0.1, 0.1)
    return [(cube, (0.1 * index, 0.0, 0.05)) for index in range(count)]


def wall() -> Bodies:
    """Ten bricks in four courses, without gaps."""
    brick = build_box(0.2, 0.1, 0.06)
    return [
        (brick, (0.2 * place + 0.1 * (course % 2), 0.0, 0.03 + 0.06 * course))
        for course in range(4)
        for place in range(3 - course % 2)
    ]


def cans() -> Bodies:
    """Four cans on top of each other."""
    return stack(vx.Model.from_mesh(trimesh.creation.cylinder(0.033, 0.12, sections=48)), 0.12, 4)


SCENES: dict[str, Callable[[], Bodies]] = {
    "one cube": lambda: row(1),
    "two flush cubes": lambda: row(2),
    "five flush cubes": lambda: row(5),
    "stack of five cubes": lambda: stack(build_box(0.1, 0.1, 0.1), 0.1, 5),
    "stack of five plates": lambda: stack(build_box(0.2, 0.3, 0.01), 0.01, 5),
    "wall of ten bricks": wall,
    "stack of four cans": cans,
}


def add_ground(world: vx.World, kind: str) -> None:
    """Adds a fixed ground with its top at height zero."""
    if kind == "plane":
        world.add(vx.Plane(), mass=0)
        return
    slab = vx.Box((1.0, 1.0, 0.05)) if kind == "box" else build_box(2.0, 2.0, 0.1)
    world.add(slab, mass=0, pose=(0, 0, -0.05))


def time_scene(bodies: Bodies, ground: str, rate: float, steps: int) -> tuple[float, float, float]:
    """The median and the 99th percentile of a step, and the median of its queries, milliseconds."""
    world = vx.World(time_step=1.0 / rate, sleeping=False)
    add_ground(world, ground)
    for model, place in bodies:
        world.add(model, mass=1, pose=place)
    world.step(100 + steps)
    timings = world.timings[-steps:]
    step = 1e3 * timings["step"]
    query = 1e3 * float(np.median(timings["query"]))
    return float(np.median(step)), float(np.quantile(step, 0.99)), query


def main() -> None:
    """Prints the times of each scene."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    grounds = ("model", "plane", "box")
    parser.add_argument("--ground", choices=grounds, default="model", help="(default: model)")
    parser.add_argument("--rate", type=float, default=200.0, help="steps a second (default: 200)")
    parser.add_argument("--steps", type=int, default=500, help="steps to time (default: 500)")
    options = parser.parse_args()
    for name, build in SCENES.items():
        step, worst, query = time_scene(build(), options.ground, options.rate, options.steps)
        print(
            f"{name:22} a step {step:6.2f} ms, 99th percentile {worst:6.2f}, of the median "
            f"queries {query:6.2f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
