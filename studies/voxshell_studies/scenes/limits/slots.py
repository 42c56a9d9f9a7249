"""Bodies that fall or slide through slots with little play."""

from __future__ import annotations

from functools import cache

import numpy as np
from voxshell_studies.scenes.everyday import forms
from voxshell_studies.scenes.everyday.scene import Form, X, Y, scatter, shift, turn
from voxshell_studies.scenes.limits import bodies
from voxshell_studies.scenes.limits.scene import (
    LimitScene,
    count_steps,
    fallen_way,
    open_world,
    put,
)
from voxshell_studies.scenes.solids import as_mesh, import_manifold

SLOTS = "Narrow slots and holes"


@cache
def plate_with_hole(length: float, width: float, thickness: float) -> Form:
    """A square plate about the origin with a rectangular hole through it, along z."""
    solids = import_manifold()
    side = 4.0 * max(length, width)
    plate = solids.Manifold.cube((side, side, thickness), True)
    hole = solids.Manifold.cube((length, width, 2.0 * thickness), True)
    return Form(f"plate with hole {length:g} {width:g} {thickness:g}", as_mesh(plate - hole))


def _fall_through(
    rate: float, placement: int, bar: Form, play: float, hole: tuple[float, float], thickness: float
) -> float:
    """Return the distance of a tilted bar without friction as a fraction of free fall.

    The bar begins 50 mm through the hole, tilted by half of what its play allows.
    """
    world = open_world(rate)
    put(world, plate_with_hole(*hole, thickness), friction=0.0)
    length = float(np.ptp(bar.vertices[:, 2]))
    tilt = 0.5 * play / thickness
    lean = turn(X, tilt if placement % 2 == 0 else -tilt)
    if hole[0] < 3.0 * hole[1]:
        lean = lean @ turn(Y, tilt * scatter(placement))
    body = put(world, bar, lean @ shift(0.0, 0.0, 0.5 * length - 0.05), 0.2, friction=0.0)
    seconds = 0.22
    start = float(body.position[2])
    world.step(count_steps(rate, seconds))
    return (start - float(body.position[2])) / fallen_way(rate, seconds)


def _fall_as_a_bar(rate: float, placement: int, play: float) -> float:
    bar, hole = forms.box(0.02, 0.02, 0.4), 0.02 + play
    return _fall_through(rate, placement, bar, play, (hole, hole), 0.02)


def _fall_as_a_sheet(rate: float, placement: int) -> float:
    return _fall_through(rate, placement, forms.box(0.1, 0.001, 0.4), 0.0003, (0.102, 0.0013), 0.01)


_RAIL = ((-0.01, -0.01), (0.01, -0.01), (0.015, 0.0), (-0.015, 0.0))
"""Section of a dovetail rail: (y, z), meters."""


@cache
def carriage(play: float) -> Form:
    """A block of 60 by 60 by 30 mm with a slot that leaves a dovetail rail some play, meters.

    The ceiling of its slot is at z = 0.
    """
    wide, narrow = 0.015 + 0.5 * play, 0.01 + 0.5 * play
    points = (
        *((-0.03, -0.01), (-narrow, -0.01), (-wide, 0.0), (wide, 0.0)),
        *((narrow, -0.01), (0.03, -0.01), (0.03, 0.02), (-0.03, 0.02)),
    )
    return bodies.profile(f"carriage {play:g}", points, 0.06)


def _slide_on_a_dovetail(rate: float, placement: int, play: float) -> float:
    """Return the distance of a carriage without friction, of 0.3 m."""
    world = open_world(rate)
    put(world, bodies.profile("dovetail rail", _RAIL, 1.0), friction=0.0)
    yaw = turn((0.0, 0.0, 1.0), 0.3 * play / 0.06 * (1.0 if placement % 2 == 0 else -1.0))
    body = put(
        *(world, carriage(play), shift(-0.3, 0.0, 0.0) @ yaw, 0.3),
        friction=0.0,
        velocity=(0.3, 0.05 * scatter(placement), 0.0),
    )
    world.step(count_steps(rate, 1.0))
    return float(body.pose[0, 3] + 0.3) / 0.3


SCENES = (
    *(
        LimitScene(
            f"square bar of 20 mm falls tilted through a hole with {1e3 * play:g} mm of play",
            SLOTS,
            "distance over free fall",
            "",
            1.0,
            lambda rate, placement, play=play: _fall_as_a_bar(rate, placement, play),
            placements=6,
        )
        for play in (0.0004, 0.002)
    ),
    LimitScene(
        "sheet of 1 mm falls tilted through a slit of 1.3 mm",
        SLOTS,
        "distance over free fall",
        "",
        1.0,
        _fall_as_a_sheet,
        placements=2,
    ),
    LimitScene(
        "carriage slides along a dovetail rail with 0.3 mm of play",
        SLOTS,
        "distance over the true one",
        "",
        1.0,
        lambda rate, placement: _slide_on_a_dovetail(rate, placement, 0.0003),
        placements=6,
    ),
)
