"""Times the steps of concave bodies with contact="regular" and "auto", the default, in turns.

.venv/bin/python benchmarks/contact_modes.py --help
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import trimesh
import voxshell as vx

EXAMPLES = Path(__file__).resolve().parent.parent / "examples/python"
sys.path.append(str(EXAMPLES))

from gripper import WALL, make_mug, write_robot  # noqa: E402
from machine_parts import as_mesh, make_nut  # noqa: E402

BUNNY = "/usr/share/glmark2/models/bunny.obj"  # Debian: glmark2-data
RATE = 200.0  # Hz
Scene = Callable[[vx.World, int], Callable[[vx.World], object] | None]
"""Adds bodies, turned at random by a seed, to a world, and returns what to call before each step."""


def drop(
    world: vx.World, model: vx.Model, count: int, radius: float, rise: float, seed: int
) -> None:
    """Adds bodies in layers of three above the origin, each turned at random."""
    random = np.random.default_rng(seed)
    for number in range(count):
        turn = 2.0 * np.pi * (number % 3) / 3.0 + 0.5 * (number // 3)
        pose = trimesh.transformations.random_rotation_matrix(random.random(3))
        pose[:3, 3] = radius * np.cos(turn), radius * np.sin(turn), rise * (1 + number // 3)
        world.add(model, mass=0.02, pose=pose)


def nuts() -> Scene:
    """16 threaded nuts of 15 mm fall into a mug of 80 mm."""
    nut = vx.Model.from_mesh(as_mesh(make_nut(0.005, 0.001, 0.0015, 0.008, 0.0002)))
    profile = np.array(((0, 0), (0.04, 0), (0.04, 0.1), (0.037, 0.1), (0.037, 0.003), (0, 0.003)))
    mug = vx.Model.from_mesh(trimesh.creation.revolve(profile, sections=96))

    def add(world: vx.World, seed: int) -> None:
        world.add(vx.Plane(), mass=0)
        world.add(mug, mass=0.3)
        drop(world, nut, 16, 0.018, 0.025, seed)

    return add


def bunnies() -> Scene:
    """12 bunnies of 80 mm fall into a bowl."""
    mesh = trimesh.load_mesh(BUNNY)
    mesh.apply_translation(-mesh.bounds.mean(axis=0))
    mesh.apply_scale(0.08 / mesh.extents.max())
    bunny = vx.Model.from_mesh(mesh)
    angles = np.linspace(0.0, np.pi / 2, 16)
    outer = 0.16 * np.column_stack([np.sin(angles), 1.0 - np.cos(angles)])
    inner = outer[::-1] * 0.94 + (0.0, 0.01)
    bowl = vx.Model.from_mesh(trimesh.creation.revolve(np.concatenate([outer, inner]), sections=96))

    def add(world: vx.World, seed: int) -> None:
        world.add(bowl, mass=0)
        drop(world, bunny, 12, 0.055, 0.11, seed)

    return add


def gripper() -> Scene:
    """A robot's two fingers take a mug by its wall, and lift it."""
    mug = vx.Model.from_mesh(make_mug())

    def add(world: vx.World, seed: int) -> Callable[[vx.World], object]:
        world.add(vx.Plane(), mass=0)
        with tempfile.TemporaryDirectory() as folder:
            file = write_robot(Path(folder))
            robot = vx.load_urdf(world, file, tolerance=0.0002, friction=0.9)
        world.add(mug, mass=0.25, pose=(0.263 + WALL, 0, 0.0002), friction=0.9)
        robot.set_targets({"turn": 0.0, "lift": 0.0, "grip": 0.0})
        plan = {200: {"lift": -0.2}, 400: {"grip": 0.024}, 560: {"lift": -0.05}}

        def move(world: vx.World) -> None:
            targets = plan.get(round(world.time * RATE))
            if targets is not None:
                robot.set_targets(targets)

        return move

    return add


SCENES = {"nuts": nuts, "bunnies": bunnies, "gripper": gripper}


def time_steps(
    add: Scene, contact: str, steps: int, seed: int
) -> tuple[float, float, float, float]:
    """Milliseconds of a step and share of its narrow phase, in the first and in the second half.

    The time is that of the processor on one thread, so that other programs hardly matter.
    """
    world = vx.World(1.0 / RATE, contact=contact, sleeping=False, threads=1)  # pyright: ignore[reportArgumentType]
    before = add(world, seed)
    found: list[float] = []
    for _ in range(2):
        world.clear_timings()
        start = time.process_time()
        world.step(steps // 2, before=before)
        spent = time.process_time() - start
        share = world.timings["narrow_phase"].sum() / world.timings["step"].sum()
        found += [1e3 * spent / (steps // 2), float(share)]
    return found[0], found[1], found[2], found[3]


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument(
        "--steps", type=int, default=800, help="of each run, at 200 Hz (%(default)s)"
    )
    parser.add_argument("--seeds", type=int, default=3, help="runs of each mode (%(default)s)")
    parser.add_argument("--scene", choices=SCENES, help="only this scene")
    given = parser.parse_args()
    warnings.simplefilter("ignore", vx.AccuracyWarning)  # the crests of the nuts' threads are thin
    print(
        "milliseconds of a step (share of its narrow phase), first and second half of the run; means of "
        f"{given.seeds} runs"
    )
    for name in [given.scene] if given.scene else SCENES:
        add = SCENES[name]()
        runs: dict[str, list[tuple[float, float, float, float]]] = {"auto": [], "regular": []}
        for seed in range(given.seeds):
            for contact, found in runs.items():
                found.append(time_steps(add, contact, given.steps, seed))
        for contact, found in runs.items():
            first, share, second, other = np.mean(found, axis=0)
            print(
                f"{name:8} {contact:8} {first:6.2f} ({share:4.0%}) {second:6.2f} ({other:4.0%})",
                flush=True,
            )


if __name__ == "__main__":
    main()
