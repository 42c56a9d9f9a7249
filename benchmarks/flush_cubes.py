"""Times the steps of cubes that rest flush in a row on a slab, at default settings.

.venv/bin/python benchmarks/flush_cubes.py --help
"""

from __future__ import annotations

import argparse

import numpy as np
import trimesh
import voxshell as vx


def time_row(count: int, rate: float, steps: int) -> tuple[float, float]:
    """Median times of a step and of its queries, milliseconds."""
    cube = vx.Model.from_mesh(trimesh.creation.box((0.1, 0.1, 0.1)))
    slab = vx.Model.from_mesh(trimesh.creation.box((2.0, 2.0, 0.1)))
    world = vx.World(time_step=1.0 / rate, sleeping=False)
    world.add(slab, mass=0, pose=(0, 0, -0.05))
    for index in range(count):
        world.add(cube, mass=1, pose=(0.1 * index, 0, 0.05))
    world.step(100 + steps)
    timings = world.timings[-steps:]
    return 1e3 * float(np.median(timings["step"])), 1e3 * float(np.median(timings["query"]))


def main() -> None:
    """Prints the times of each row."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--counts", type=int, nargs="+", default=[1, 2, 5], help="cubes in a row")
    parser.add_argument("--rate", type=float, default=200.0, help="steps a second (default: 200)")
    parser.add_argument("--steps", type=int, default=500, help="steps to time (default: 500)")
    options = parser.parse_args()
    for count in options.counts:
        step, query = time_row(count, options.rate, options.steps)
        print(f"{count} cubes: a step {step:.2f} ms, of which queries {query:.2f} ms")


if __name__ == "__main__":
    main()
