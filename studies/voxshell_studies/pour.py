"""Bunnies poured into a bin: whether all stay, how calm the heap is, and the time of a step."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from voxshell.measuring.timing import pinned

from voxshell_studies.motion import tabulate
from voxshell_studies.part import Part
from voxshell_studies.scenes.pour import METHODS, Method, PourSettings, build_world

if TYPE_CHECKING:
    from voxshell.simulation.body import Body
    from voxshell.simulation.world import World

    from voxshell_studies.part import Columns, Tables

POURED: tuple[Method, ...] = ("voxshell", "decomposition")
"""Methods that are fast enough to fill the bin."""

RECORDED_EVERY = 1.0 / 30.0
"""Seconds."""


def plan(settings: PourSettings) -> list[Part]:
    """Return one part with all methods in one process."""
    cost = 1e-3 * settings.count * settings.rate * settings.seconds
    return [Part("pour", pour, {"settings": settings}, timed=True, cost=cost)]


def pour(settings: PourSettings) -> Tables:
    """Fill the bin with each method that can, then step all of them in the heap of the models.

    Returns:
        "METHOD": every step of a filling; "heap": step times in the same heap; "poses" and
        "contacts": the recording of the models; "ends": the last place of each body.
    """
    steps = round(settings.rate * settings.seconds)
    tables: dict[str, Columns] = {}
    ends = []
    heap = starts = settings.compute_starts()
    with pinned():
        for method in POURED:
            world, bodies = build_world(settings, method, starts)
            recorder = world.record(every=max(round(RECORDED_EVERY * settings.rate), 1))
            tables[method] = _run(world, bodies, steps)
            poses = np.array([body.pose for body in bodies])
            lost = settings.find_lost(poses)
            ends.append({"method": np.full(len(lost), method), "lost": lost})
            if method == "voxshell":
                heap = poses
                tables |= tabulate(recorder.recording())
        rows = []
        for method in METHODS:
            world, _ = build_world(settings, method, heap)
            # The first step creates the pairs.
            world.step(1 + settings.slow_steps)
            times = world.timings[1:]
            rows += [(method, t["step"], t["narrow_phase"]) for t in times]
    tables["heap"] = dict(
        zip(("method", "step", "narrow_phase"), map(np.array, zip(*rows, strict=True)), strict=True)
    )
    tables["ends"] = {key: np.concatenate([end[key] for end in ends]) for key in ends[0]}
    return tables


def _run(world: World, bodies: list[Body], steps: int) -> Columns:
    names = ("speed", "angular_speed", "fastest", "depth", "contacts")
    columns = {name: np.zeros(steps) for name in names}
    for step in range(steps):
        world.step()
        speeds = np.linalg.norm([body.linear_velocity for body in bodies], axis=1)
        turns = np.linalg.norm([body.angular_velocity for body in bodies], axis=1)
        found = world.contacts()
        values = (
            *(np.median(speeds), np.median(turns), speeds.max()),
            *(found["depth"].max(initial=0.0), len(found)),
        )
        for name, value in zip(names, values, strict=True):
            columns[name][step] = value
    times = {name: world.timings[name].copy() for name in ("step", "narrow_phase")}
    return columns | {f"{name}_seconds": values for name, values in times.items()}
