"""Times the steps of bodies that slide, land, or fall close to each other, at default settings.

.venv/bin/python benchmarks/moving.py --help
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable

import numpy as np
import trimesh
import voxshell as vx
from voxshell.measuring.timing import pinned

Scene = tuple[vx.World, int]  # and how many steps are timed


def build_box(*sides: float) -> vx.Model:
    """A default model of a box."""
    return vx.Model.from_mesh(trimesh.creation.box(sides))


def make_world(rate: float, side: float, friction: float = 0.5) -> vx.World:
    """A world with a slab that is as wide as `side`, its top at height zero."""
    world = vx.World(time_step=1.0 / rate, sleeping=False)
    world.add(build_box(side, side, 0.1), mass=0, pose=(0, 0, -0.05), friction=friction)
    return world


def slide(model: vx.Model, height: float, speed: float, friction: float) -> Scene:
    """A body on its base that moves on after it has come to rest."""
    world = make_world(200.0, 2.0, friction)
    body = world.add(model, mass=1, pose=(-0.5, 0, 0.5 * height), friction=friction)
    world.step(50)
    body.linear_velocity = (speed, 0.3 * speed, 0)
    return world, 40 if friction > 0.0 else 150


def land() -> Scene:
    """A cube that falls flat by a millimeter."""
    world = make_world(200.0, 2.0)
    world.add(build_box(0.1, 0.1, 0.1), mass=1, pose=(-0.5, 0, 0.051))
    return world, 20


def drop_on_large(model: vx.Model, pose: np.ndarray) -> Scene:
    """A thin body that turns and falls onto a slab of 5 m, at 60 Hz."""
    world = make_world(60.0, 5.0)
    body = world.add(model, mass=0.05, pose=pose)
    body.angular_velocity = (1, 0.5, 0)
    return world, 60


def fall_together() -> Scene:
    """A grid of 27 cubes with gaps of 5 mm, from the step on in which they may meet."""
    world = make_world(200.0, 2.0)
    cube = build_box(0.1, 0.1, 0.1)
    for place in np.ndindex(3, 3, 3):
        world.add(cube, mass=1, pose=0.105 * np.array(place) + (0, 0, 0.25))
    world.step(20)
    return world, 16


def build_can() -> vx.Model:
    """A default model of a can."""
    return vx.Model.from_mesh(trimesh.creation.cylinder(0.033, 0.12, sections=48))


def drop_needle() -> Scene:
    """A needle that falls aslant and then rolls."""
    needle = vx.Model.from_mesh(trimesh.creation.cylinder(0.0005, 1.0, sections=16))
    return drop_on_large(needle, vx.pose((0, 0, 0.3), xyzw=(0, 0.6, 0, 0.8)))


SCENES: dict[str, Callable[[], Scene]] = {
    "cube slides at 1 m/s": lambda: slide(build_box(0.1, 0.1, 0.1), 0.1, 1.0, 0.5),
    "cube glides at 0.3 m/s": lambda: slide(build_box(0.1, 0.1, 0.1), 0.1, 0.3, 0.0),
    "can glides at 0.3 m/s": lambda: slide(build_can(), 0.12, 0.3, 0.0),
    "cube lands flat": land,
    "sheet of 0.1 mm": lambda: drop_on_large(build_box(0.2, 0.3, 0.0001), vx.pose((0, 0, 0.03))),
    "needle of 1 mm by 1 m": drop_needle,
    "27 cubes fall together": fall_together,
}


def main() -> None:
    """Prints the times of each scene."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--filter", default="", help="part of the names of the scenes to time")
    options = parser.parse_args()
    warnings.simplefilter("ignore", vx.AccuracyWarning)
    with pinned():
        for name, build in SCENES.items():
            if options.filter not in name:
                continue
            world, steps = build()
            world.step(steps)
            timings = 1e3 * world.timings["step"][-steps:]
            print(
                f"{name:24} a step {np.median(timings):7.2f} ms, 99th percentile "
                f"{np.quantile(timings, 0.99):7.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
