"""Memory of a process that builds, queries, simulates and fails, over and over."""

from __future__ import annotations

import gc
import resource
import tempfile
import time
import warnings
from contextlib import suppress
from pathlib import Path

import numpy as np
import trimesh
import voxshell as vx

from soak.task import Check, Outcome, Task, Totals

SECONDS = 5.0  # a case
WARM_UP = 30.0  # seconds of work before memory has to be flat
GROWTH = (
    8e6  # bytes that it may grow by after that: a model is smaller, a leak of one a case is not
)
MEGABYTE = 1e6


def work(seed: int, folder: Path) -> None:
    """A round of all that allocates, the same amount each time."""
    ring = trimesh.creation.torus(0.1, 0.03, 24, 12)
    model = vx.Model.from_mesh(ring, resolution=40, cache=False)
    tight = vx.Model.from_mesh(ring, tolerance=1e-3, cache=False)
    path = folder / "model.vxs"
    model.save(path)
    model = vx.Model.load(path)
    rng = np.random.default_rng([seed, 9])
    poses = np.tile(np.eye(4), (200, 1, 1))
    poses[:, :3, 3] = rng.uniform(-0.2, 0.2, (200, 3))
    vx.contacts_batch(model, tight, poses, threads=2)
    scratch = vx.QueryScratch()
    for pose in poses[:50]:
        vx.contacts(model, tight, pose, scratch=scratch)
        vx.distance(model, tight, pose)
    world = vx.World()
    world.add(vx.Plane(offset=-0.1), mass=0)
    for number in range(5):
        poses[number, :3, 3] = (0.0, 0.0, 0.2 * number)
        world.add(model if number % 2 else tight, pose=poses[number])
    world.step(20)
    state = world.save_state()
    world.remove(world.bodies[-1])
    world.contacts()
    del state
    with suppress(vx.VoxshellError):
        vx.Model.from_mesh(ring, resolution=-1)


def read_resident() -> int:
    """Bytes."""
    gc.collect()
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


def prepare() -> Check:
    warnings.simplefilter("ignore")
    folder = Path(tempfile.mkdtemp(prefix="voxshell-soak-"))
    worked, flat_from = 0.0, 0

    def check(case: int) -> Outcome:
        nonlocal worked, flat_from
        began, round_ = time.monotonic(), 0
        while time.monotonic() - began < SECONDS:
            work(1000 * case + round_, folder)
            round_ += 1
        seconds = time.monotonic() - began
        worked += seconds
        resident = read_resident()
        if worked <= WARM_UP + SECONDS:
            flat_from = max(flat_from, resident)
            return Outcome(0, {"rounds": round_})
        growth = resident - flat_from
        stretch = worked - WARM_UP
        assert growth <= GROWTH, (
            f"{growth / MEGABYTE:.1f} MB more than after warm-up, {stretch:.0f} s later"
        )
        return Outcome(
            seconds,
            {"rounds": round_},
            {"stretch": stretch, "growth": growth / MEGABYTE, "resident": resident / MEGABYTE},
        )

    return check


def describe(totals: Totals) -> str:
    if "stretch" not in totals.peaks:
        return ""
    return (
        f"{totals.tallies['rounds']:,.0f} rounds; longest stretch of one process "
        f"{totals.peaks['stretch']:,.0f} s; at most {totals.peaks['growth']:.1f} MB more than after "
        f"warm-up, of {totals.peaks['resident']:.0f} MB"
    )


TASK = Task(
    promise="Memory stays flat while a process builds, queries, simulates and fails",
    oracle="resident memory after a warm-up",
    unit="seconds in one process",
    target=3600,
    prepare=prepare,
    describe=describe,
    done=lambda totals: totals.peaks.get("stretch", 0.0),
    alone=True,
)
