"""Prisms that roll over edges, bodies that rock on round bellies, a ring that swings on a peg."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING

from voxshell_studies.scenes.everyday import forms, impact_laws, laws
from voxshell_studies.scenes.everyday.held_out import bodies
from voxshell_studies.scenes.everyday.held_out.rolls import SLOPE, inertia_ratio
from voxshell_studies.scenes.everyday.rolling import BALL, find_period, swing_period
from voxshell_studies.scenes.everyday.scene import (
    EverydayScene,
    Item,
    Measure,
    Stage,
    X,
    Y,
    Z,
    heading,
    shift,
    turn,
)
from voxshell_studies.scenes.everyday.sliding import downhill, farthest, nothing, one

if TYPE_CHECKING:
    from voxshell_studies.scenes.everyday.scene import Track

EDGES, ROUND = "Rolling over edges", "Rocking and swinging"

# ---- edges ---------------------------------------------------------------------------------------


def _prism(placement: int, sides: int) -> Stage:
    """A can of 50 mm radius with flat sides, on one of its edges across a slope of 10 degrees."""
    ramp = turn(Z, heading(placement)) @ turn(Y, SLOPE)
    can = forms.cylinder(BALL, 0.1, sides)
    lie = bodies.lying(BALL) @ turn(Z, 0.5 * math.pi + 2.0 * math.pi / sides * placement)
    return Stage(
        (
            Item("ground", forms.PLANE, ramp, mass=0.0),
            Item("body", can, ramp @ lie),
        ),
        facts={"sides": float(sides), "inertia_ratio": inertia_ratio(can, 2, BALL)},
        world_from_ramp=ramp[:3, :3],
    )


def _smooth_way(track: Track) -> float:
    pull = laws.roll_acceleration(SLOPE, track.fact("inertia_ratio"))
    return laws.way(0.0, pull, track.seconds, track.time_step)


@cache
def _cached_prism(sides: int, ratio: float, seconds: float) -> float:
    return impact_laws.prism_way(SLOPE, sides, BALL, ratio, seconds)


def _edged_way(track: Track) -> float:
    return _cached_prism(int(track.fact("sides")), track.fact("inertia_ratio"), track.seconds)


def _prisms(sides: int) -> EverydayScene:
    return EverydayScene(
        f"can of {sides} sides rolls down 10 degrees",
        EDGES,
        "It is no faster than a round can, g sin a / (1 + I / (m r2)), and no slower than a prism that loses spin "
        "at every edge (McGeer's rimless wheel).",
        lambda i: _prism(i, sides),
        0.8,
        (
            Measure(
                "distance, above a round can's", "m", downhill, _smooth_way, 0.05, True, signed=1
            ),
            Measure("distance, below a prism's", "m", downhill, _edged_way, 0.05, True, signed=-1),
        ),
        held_out=True,
    )


def _pencil(placement: int, degrees: float) -> Stage:
    """A hexagonal pencil of 5 g on a face, across a slope."""
    ramp = turn(Z, heading(placement)) @ turn(Y, math.radians(degrees))
    lie = forms.standing(bodies.pencil()) @ turn(Y, math.pi / 3.0 * placement)
    return Stage(
        (
            Item("ground", forms.slab(1.0), ramp, mass=0.0),
            Item("body", bodies.pencil(), ramp @ shift(-0.3, 0.0, 0.0) @ lie, 0.005),
        ),
        friction=0.9,
        world_from_ramp=ramp[:3, :3],
    )


def _rolls_off(track: Track) -> float:
    return float(downhill(track) > 0.05)


# ---- rocking -------------------------------------------------------------------------------------

_BELLY, _ROCK = 0.1, math.radians(15.0)


def _rocker(placement: int) -> Stage:
    """Half a cylinder of 0.1 m radius on its belly, tilted by 15 degrees."""
    form = bodies.half_cylinder(_BELLY, 0.1)
    way = turn(Z, heading(placement))
    center = turn(Y, _ROCK)[:3, :3] @ forms.center_of(form)
    matter = forms.matter(form, 1.0)
    return Stage(
        (
            Item("ground", forms.slab(1.0), way, mass=0.0),
            Item("body", form, way @ shift(-float(center[0]), 0.0, _BELLY) @ turn(Y, _ROCK)),
        ),
        friction=0.8,
        facts={
            "depth": -float(matter.center_of_mass[2]),
            "gyration": float(matter.inertia[1, 1]),
        },
        world_from_ramp=way[:3, :3],
    )


def _rock_period(track: Track) -> float:
    axes = track.poses["body"][:, :3, 2] @ track.stage.world_from_ramp
    return find_period(axes[:, 0], track.time_step)


def _true_rock(track: Track) -> float:
    return laws.rocking_period(_BELLY, track.fact("depth"), track.fact("gyration"), _ROCK)


_PEG, _HOOP, _SWAY = 0.01, (0.1, 0.09, 0.02), math.radians(10.0)


def _ring_on_peg(placement: int) -> Stage:
    """A ring with 90 mm inside radius that hangs on a level peg of 10 mm radius, 10 degrees aside."""
    ring = forms.tube(*_HOOP, forms.FINE)
    way = turn(Z, heading(placement))
    length = _HOOP[1] * math.cos(math.pi / forms.FINE) - _PEG
    center = way @ turn(Y, _SWAY) @ shift(0.0, 0.0, -length)
    # A side of its inside on the peg.
    lie = turn(X, 0.5 * math.pi) @ turn(Z, 0.5 * math.pi + math.pi / forms.FINE)
    peg = way @ turn(X, 0.5 * math.pi)
    return Stage(
        (
            Item("peg", forms.cylinder(_PEG, 0.1, forms.FINE), peg, mass=0.0),
            Item("body", ring, center @ lie),
        ),
        friction=1.0,
        facts={"length": length * (1.0 + inertia_ratio(ring, 2, _HOOP[1]))},
        world_from_ramp=way[:3, :3],
    )


def _true_sway(track: Track) -> float:
    return laws.pendulum_period(track.fact("length"), _SWAY)


SCENES = (
    _prisms(32),
    _prisms(64),
    EverydayScene(
        "pencil stays on 25 degrees",
        EDGES,
        "A hexagonal pencil rolls off by itself only above 30 degrees: its center is behind its lower edge.",
        lambda i: _pencil(i, 25.0),
        2.0,
        (Measure("creep", "mm", farthest, nothing, 1e-4, scale=1e3),),
        most=5,
        held_out=True,
    ),
    EverydayScene(
        "pencil rolls off 34 degrees",
        EDGES,
        "A hexagonal pencil rolls off by itself above 30 degrees: its center is in front of its lower edge. "
        "Friction 0.9 holds that edge.",
        lambda i: _pencil(i, 34.0),
        1.0,
        (Measure("rolls off", "", _rolls_off, one, 0.0),),
        most=5,
        held_out=True,
    ),
    EverydayScene(
        "half a cylinder rocks",
        ROUND,
        "Period from the energy; for small angles 2 pi sqrt((k2 + (r - d)2) / (g d)), d = 4 r / (3 pi); 15 degrees.",
        _rocker,
        3.0,
        (Measure("period", "s", _rock_period, _true_rock, 0.05, relative=True),),
        rates=(1000.0, 200.0, 60.0),
        most=5,
        needs=2.0,
        held_out=True,
    ),
    EverydayScene(
        "ring swings on a peg",
        ROUND,
        "A ring that rolls on a peg is a pendulum of (r - p) (1 + I / (m r2)), r its inside radius, p the peg's; "
        "10 degrees.",
        _ring_on_peg,
        3.0,
        (Measure("period", "s", swing_period, _true_sway, 0.05, relative=True),),
        rates=(1000.0, 200.0, 60.0),
        most=5,
        needs=2.0,
        held_out=True,
    ),
)
