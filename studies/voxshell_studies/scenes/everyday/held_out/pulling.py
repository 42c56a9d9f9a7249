"""Bodies that slide or are pulled, on flat grounds and in grooves."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from voxshell_studies.scenes.everyday import forms, laws
from voxshell_studies.scenes.everyday.held_out import bodies
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
from voxshell_studies.scenes.everyday.sliding import (
    COULOMB,
    as_vector,
    downhill,
    farthest,
    nothing,
    on_ramp,
    slid_way,
    stop_way,
)

if TYPE_CHECKING:
    from voxshell_studies.scenes.everyday.scene import Form, Track

PULL, GROOVE = "Pushed and pulled", "V-grooves"

SLIDES = Measure("distance", "m", downhill, slid_way, 0.05, relative=True)
STOPS = Measure("stopping distance", "mm", downhill, stop_way, 0.05, relative=True, scale=1e3)
STAYS = Measure("creep", "mm", farthest, nothing, 1e-4, scale=1e3)


def _brick() -> Form:
    return forms.box(0.2, 0.1, 0.05)


# ---- pulled --------------------------------------------------------------------------------------

_CRATE, _GRIP = 10.0, 0.4
"""Mass of a crate, kilograms, and its friction."""


def _pulled(placement: int, fraction: float) -> Stage:
    """A crate of 0.3 m, pulled level at its center with a fraction of the force that friction can hold."""
    stage = on_ramp(
        forms.box(0.3, 0.3, 0.1), forms.PLANE, 0.0, placement, friction=_GRIP, mass=_CRATE
    )
    ground, crate = stage.items
    force = fraction * _GRIP * _CRATE * laws.G
    pull = as_vector(stage.world_from_ramp[:, 0] * force)
    return replace(stage, items=(ground, replace(crate, force=pull)), facts={"force": force})


def _pulled_way(track: Track) -> float:
    pull = track.fact("force") / _CRATE - _GRIP * laws.G
    return laws.way(0.0, pull, track.seconds, track.time_step)


_CROSS, _SIDE = math.radians(20.0), 5.0
"""Slope, and acceleration that a level force alone would give, m/s2."""


def _pulled_across(placement: int) -> Stage:
    """A cube of 0.1 m on a slope on which it would hold, pulled level across the slope."""
    stage = on_ramp(forms.box(0.1, 0.1, 0.1), forms.PLANE, _CROSS, placement, friction=0.5)
    ground, cube = stage.items
    pull = as_vector(stage.world_from_ramp[:, 1] * _SIDE)
    return replace(stage, items=(ground, replace(cube, force=pull)))


def _diagonal_way(track: Track) -> float:
    return float(np.hypot(*track.path("body")[-1, :2]))


def _true_diagonal(track: Track) -> float:
    drive = math.hypot(laws.G * math.sin(_CROSS), _SIDE)
    pull = drive - 0.5 * laws.G * math.cos(_CROSS)
    return laws.way(0.0, pull, track.seconds, track.time_step)


def _direction(track: Track) -> float:
    """Of the way, from downhill toward the force, degrees."""
    x, y, _ = track.path("body")[-1]
    return math.degrees(math.atan2(y, x))


def _true_direction(_: Track) -> float:
    return math.degrees(math.atan2(_SIDE, laws.G * math.sin(_CROSS)))


_BOARD, _LOAD, _SMOOTH, _TUG = 2.0, 1.0, 0.2, 20.0
"""Masses of board and box, kilograms, friction of both, and force on the board, newtons."""


def _board(placement: int) -> Stage:
    """A box near the front of a board of 1.2 m that is pulled away beneath it."""
    way = turn(Z, heading(placement))
    board = forms.box(1.2, 0.2, 0.02)
    box = forms.box(0.1, 0.1, 0.1)
    on_it = shift(0.4, 0.0, 0.07) @ turn(Z, heading(3 * placement))
    return Stage(
        (
            Item("ground", forms.PLANE, mass=0.0),
            Item(
                *("board", board, way @ shift(0.0, 0.0, 0.01), _BOARD),
                force=as_vector(way[:3, 0] * _TUG),
            ),
            Item("box", box, way @ on_it, _LOAD),
        ),
        friction=_SMOOTH,
        world_from_ramp=way[:3, :3],
    )


def _along(track: Track, name: str) -> float:
    return float(track.path(name)[-1, 0])


def _board_way(track: Track) -> float:
    drag = _SMOOTH * laws.G * (_LOAD + _LOAD + _BOARD)
    return laws.way(0.0, (_TUG - drag) / _BOARD, track.seconds, track.time_step)


def _box_way(track: Track) -> float:
    return laws.way(0.0, _SMOOTH * laws.G, track.seconds, track.time_step)


_WHIRL = (1.0, 40.0, 0.3, 0.05, 0.045)
"""Speed, spin, friction, outer and inner radius of the ring."""


def _whirl(placement: int) -> Stage:
    speed, spin, friction, outer, inner = _WHIRL
    ring = forms.tube(outer, inner, 0.004)
    return on_ramp(
        *(ring, forms.PLANE, 0.0, placement), friction=friction, speed=speed, spin=(0.0, 0.0, spin)
    )


def _whirl_way(track: Track) -> float:
    return laws.spinning_ring_way(*_WHIRL, track.time_step)


# ---- grooves -------------------------------------------------------------------------------------

RIGHT_ANGLE = 0.25 * math.pi
"""Between a wall of the groove and its middle plane, radians."""


def in_groove(
    form: Form, lie: np.ndarray, degrees: float, placement: int, friction: float
) -> Stage:
    """A body in a V-groove of 90 degrees that falls toward a heading; ``lie`` is its pose in the groove."""
    slope = math.radians(degrees)
    ramp = turn(Z, heading(placement)) @ turn(Y, slope)
    return Stage(
        (
            Item("groove", bodies.groove(2.0, 0.1), ramp, mass=0.0),
            Item("body", form, ramp @ shift(-0.5, 0.0, 0.0) @ lie),
        ),
        friction=friction,
        facts={"slope": slope, "friction": friction},
        world_from_ramp=ramp[:3, :3],
    )


def _groove_way(track: Track) -> float:
    pull = laws.groove_acceleration(track.fact("slope"), track.fact("friction"), RIGHT_ANGLE)
    return laws.way(0.0, pull, track.seconds, track.time_step)


def _block_in_groove(placement: int) -> Stage:
    """A block of 60 mm on its edge, two faces on the walls."""
    side = 0.06
    lie = shift(0.0, 0.0, side / math.sqrt(2.0)) @ turn(X, RIGHT_ANGLE)
    return in_groove(forms.box(0.1, side, side), lie, 40.0, placement, 0.3)


def _rod_in_groove(placement: int) -> Stage:
    """A rod of 30 mm radius that lies along the groove."""
    radius = 0.03
    lie = shift(0.0, 0.0, radius * math.sqrt(2.0)) @ turn(Y, 0.5 * math.pi)
    rod = forms.cylinder(radius, 0.12, 192)
    return in_groove(rod, lie @ turn(Z, heading(3 * placement)), 30.0, placement, 0.5)


SCENES = (
    EverydayScene(
        "container of 1000 kg stops",
        PULL,
        f"{COULOMB}: a box of 5 m pushed at 2 m/s stops after v2 / (2 mu g), mu 0.4.",
        lambda i: on_ramp(
            forms.box(5.0, 2.0, 2.0), forms.PLANE, 0.0, i, friction=0.4, speed=2.0, mass=1000.0
        ),
        1.0,
        (STOPS,),
        held_out=True,
    ),
    EverydayScene(
        "die of 5 mm and 1 g slides down 40 degrees at friction 0.6",
        PULL,
        f"{COULOMB}: distance with a = g (sin 40 deg - 0.6 cos 40 deg) from rest.",
        lambda i: on_ramp(
            forms.box(0.005, 0.005, 0.005),
            forms.slab(0.5),
            math.radians(40.0),
            i,
            friction=0.6,
            at=-0.1,
            mass=0.001,
        ),
        0.4,
        (SLIDES,),
        held_out=True,
    ),
    EverydayScene(
        "brick slides off 3 degrees without friction",
        PULL,
        "Without friction: distance with a = g sin 3 deg from rest, summed over Euler steps.",
        lambda i: on_ramp(_brick(), forms.slab(2.0), math.radians(3.0), i, friction=0.0),
        0.8,
        (SLIDES,),
        held_out=True,
    ),
    EverydayScene(
        "brick holds on 42 degrees at friction 1",
        PULL,
        "Below the friction angle, 45 degrees, nothing moves (Coulomb); width over height, 2 and more, keeps it "
        "from tipping.",
        lambda i: on_ramp(_brick(), forms.PLANE, math.radians(42.0), i, friction=1.0),
        2.0,
        (STAYS,),
        most=5,
        held_out=True,
    ),
    EverydayScene(
        "crate stays below the friction limit",
        PULL,
        "A force of 0.9 mu m g does not move a body (Coulomb); mu 0.4, 10 kg.",
        lambda i: _pulled(i, 0.9),
        2.0,
        (STAYS,),
        most=5,
        held_out=True,
    ),
    EverydayScene(
        "crate moves above the friction limit",
        PULL,
        f"{COULOMB}: distance with a = F / m - mu g, F = 1.3 mu m g, mu 0.4.",
        lambda i: _pulled(i, 1.3),
        1.0,
        (Measure("distance", "m", downhill, _pulled_way, 0.05, relative=True),),
        held_out=True,
    ),
    EverydayScene(
        "cube pulled across a slope leaves diagonally",
        PULL,
        "Friction acts against the motion in any direction (Coulomb): a body that starts from rest goes along the "
        "sum of g sin a downhill and F / m across it, here 56 degrees off, with that less mu g cos a.",
        _pulled_across,
        0.6,
        (
            Measure("distance", "m", _diagonal_way, _true_diagonal, 0.05, relative=True),
            Measure("direction", "degrees", _direction, _true_direction, 2.0),
        ),
        held_out=True,
    ),
    EverydayScene(
        "board is pulled away beneath a box",
        PULL,
        f"{COULOMB}: the box gets mu g, the board (F - mu (2 m + M) g) / M; mu 0.2, 1 kg on 2 kg, 20 N.",
        _board,
        0.4,
        (
            Measure(
                "distance of the board",
                "m",
                lambda t: _along(t, "board"),
                _board_way,
                0.05,
                relative=True,
            ),
            Measure(
                "distance of the box",
                "m",
                lambda t: _along(t, "box"),
                _box_way,
                0.05,
                relative=True,
            ),
        ),
        held_out=True,
    ),
    EverydayScene(
        "spinning ring slides farther",
        PULL,
        "Spin turns friction aside, so that a ring at 1 m/s and 40 rad/s slides 0.46 m; 0.17 m without spin "
        "(Farkas et al. 2003).",
        _whirl,
        1.2,
        (Measure("stopping distance", "mm", downhill, _whirl_way, 0.05, relative=True, scale=1e3),),
        rates=(1000.0, 200.0, 60.0),
        needs=1.2,
        held_out=True,
    ),
    EverydayScene(
        "block on its edge slides down a V-groove",
        GROOVE,
        "Walls at 45 degrees press 1 / sin 45 deg as hard: a = g (sin 40 deg - mu cos 40 deg / sin 45 deg), mu 0.3.",
        _block_in_groove,
        0.6,
        (Measure("distance", "m", downhill, _groove_way, 0.05, relative=True),),
        held_out=True,
    ),
    EverydayScene(
        "rod holds in a V-groove",
        GROOVE,
        "A rod along a groove with walls at 45 degrees holds up to tan a = mu / sin 45 deg: 35 degrees at mu 0.5. "
        "At 30 degrees it holds, though it would slide on a flat slope.",
        _rod_in_groove,
        2.0,
        (STAYS,),
        most=5,
        held_out=True,
    ),
)
