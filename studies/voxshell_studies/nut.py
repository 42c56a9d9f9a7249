"""A nut on its bolt: whether it holds, and whether it turns down its thread."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from voxshell.query.distances import distance
from voxshell.simulation.comparison_shapes import ConvexHull, GImpact
from voxshell.simulation.world import World

from voxshell_studies.motion import tabulate
from voxshell_studies.part import Part
from voxshell_studies.scenes.bolt import BoltSettings, measure_turns
from voxshell_studies.scenes.drop import decompose

if TYPE_CHECKING:
    from voxshell.simulation.body_shapes import Shape

    from voxshell_studies.part import Tables

Mode = Literal["segmented", "regular"]
MODES: tuple[Mode, ...] = ("segmented", "regular")
START_TURNS = 5.3
"""Initial turns up the thread, so that the nut can move down."""

NUT_MASS = 0.05
"""Kilograms."""

RECORDED_EVERY = 1.0 / 60.0
"""Seconds."""


def plan(settings: BoltSettings) -> list[Part]:
    """Return the nut with and without friction, by contact mode; and the fit by method."""
    cost = 2e-3 * settings.rate * settings.seconds
    return [
        *(
            Part(
                f"{name}-{mode}",
                run_nut,
                {"settings": settings, "mode": mode, "friction": friction},
                cost=cost,
            )
            for name, friction in (("hold", settings.friction), ("turn", 0.0))
            for mode in MODES
        ),
        Part("fit", compare_fits, {"settings": settings}, cost=10.0),
    ]


def run_nut(settings: BoltSettings, mode: Mode, friction: float) -> Tables:
    """Return for every step the nut's descent, its turn, and the deepest contact."""
    world = World(shell="fewest", time_step=1.0 / settings.rate, contact=mode, sleeping=False)
    world.add(settings.build_bolt(), mass=0.0, friction=friction, name="bolt")
    start = settings.compute_fit(START_TURNS)
    nut = world.add(settings.build_nut(), mass=NUT_MASS, pose=start, friction=friction, name="nut")
    recorder = world.record(every=max(round(RECORDED_EVERY * settings.rate), 1))
    steps = round(settings.seconds * settings.rate)
    height, turns, sideways, depth = np.zeros((4, steps))
    before, turned = measure_turns(start), 0.0
    for step in range(steps):
        world.step()
        pose = nut.pose
        change = measure_turns(pose) - before
        # The shorter direction: a step turns by less than half a turn.
        turned += change - round(change)
        before = measure_turns(pose)
        height[step] = pose[2, 3] - start[2, 3]
        turns[step] = turned
        sideways[step] = np.hypot(pose[0, 3], pose[1, 3])
        depth[step] = max(float(world.contacts()["depth"].max(initial=0.0)), 0.0)
    columns = {"height": height, "turns": turns, "sideways": sideways, "depth": depth}
    return {
        "steps": {"step": np.arange(1, steps + 1), **columns},
        **tabulate(recorder.recording()),
    }


def compare_fits(settings: BoltSettings) -> Tables:
    """Return the deepest overlap that each method reports where the threads are apart, meters."""
    bolt, nut = settings.build_bolt(), settings.build_nut()
    pose = settings.compute_fit(START_TURNS)
    rows = []
    for method in settings.fit_methods:
        shapes: tuple[Shape, Shape] = (bolt, nut)
        if method == "gimpact":
            shapes = (GImpact(bolt.mesh, margin=0.0), GImpact(nut.mesh, margin=0.0))
        elif method == "decomposition":
            shapes = (decompose(bolt.mesh), decompose(nut.mesh))
        elif method == "hull":
            shapes = (ConvexHull(bolt.mesh.vertices), ConvexHull(nut.mesh.vertices))
        world = World(shell="fewest", gravity=(0.0, 0.0, 0.0), time_step=1.0 / settings.rate)
        world.add(shapes[0], mass=0.0)
        world.add(shapes[1], mass=NUT_MASS, pose=pose)
        world.step()
        found = world.contacts()
        rows.append((len(found), max(float(found["depth"].max(initial=0.0)), 0.0)))
    contacts, depths = np.array(rows).T
    gap = distance(bolt, nut, None, pose, shell="both").distance
    return {
        "methods": {
            "method": np.array(settings.fit_methods),
            "contacts": contacts,
            "depth": depths,
        },
        "gap": {"distance": np.array([gap])},
    }
