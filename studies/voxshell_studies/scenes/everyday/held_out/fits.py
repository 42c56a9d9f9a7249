"""Pegs in holes, a key, and what hangs on pegs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from voxshell_studies.scenes.everyday import forms, laws
from voxshell_studies.scenes.everyday.held_out import bodies
from voxshell_studies.scenes.everyday.rolling import lowest_vertex
from voxshell_studies.scenes.everyday.scene import (
    EverydayScene,
    Item,
    Joint,
    Measure,
    Stage,
    X,
    Y,
    Z,
    heading,
    scatter,
    shift,
    turn,
)
from voxshell_studies.scenes.everyday.sliding import as_vector, most_turned, nothing

if TYPE_CHECKING:
    from voxshell_studies.scenes.everyday.scene import Track

FIT, HANG = "Pegs and keys", "Hanging on pegs and hooks"

# ---- pegs and keys -------------------------------------------------------------------------------

_HOLE, _DEEP = 0.0102, 0.02


def _peg(placement: int, radius: float, above: float) -> Stage:
    """A peg of 60 mm that is let go over a hole of 10.2 mm radius in a plate, 0.1 mm off its middle."""
    aside = turn(Z, heading(placement)) @ shift(1e-4, 0.0, 0.0)
    peg = forms.cylinder(radius, 0.06, forms.FINE)
    return Stage(
        (
            Item(
                *("plate", forms.tube(0.05, _HOLE, _DEEP, forms.FINE)),
                pose=shift(0.0, 0.0, -0.5 * _DEEP),
                mass=0.0,
            ),
            Item("body", peg, aside @ shift(0.0, 0.0, 0.03 + above), 0.1),
        ),
        friction=0.3,
    )


def _fallen(track: Track) -> float:
    return float(-track.path("body")[-1, 2])


def _free_fall(track: Track) -> float:
    return laws.way(0.0, laws.G, track.seconds, track.time_step)


def _drop(_: Track) -> float:
    return 1e-3


_KEY, _KEYHOLE = 0.01, 0.0104


def _key(placement: int) -> Stage:
    """A square key of 10 mm on an upright hinge in a hole of 10.4 mm, given a spin of 3 rad/s."""
    way = turn(Z, heading(placement))
    sense = 1.0 if placement % 2 == 0 else -1.0
    return Stage(
        (
            Item("plate", bodies.square_hole(_KEYHOLE, 0.02), way, mass=0.0),
            Item(
                *("body", forms.box(_KEY, _KEY, 0.06), way, 0.1),
                spin=(0.0, 0.0, 3.0 * sense),
                joint=Joint("hinge"),
            ),
        ),
    )


def _play(_: Track) -> float:
    return math.degrees(laws.key_play(_KEY, _KEYHOLE))


# ---- what hangs ----------------------------------------------------------------------------------

_PEG, _HANDLE = 0.005, (0.042, 0.023)
"""Radius of a peg; where the middle of the mug's handle is along its x axis, and its inside radius."""


def _mug_on_peg(placement: int) -> Stage:
    """A mug that hangs with its handle on a level peg, 0.2 mm over it, its center below."""
    mug = forms.mug()
    way = turn(Z, heading(placement))
    middle = np.array((_HANDLE[0], 0.0, 0.0))
    up = middle - forms.center_of(mug)
    turned = turn(Y, math.atan2(-float(up[0]), float(up[2])))
    height = 2e-4 - (_HANDLE[1] - _PEG)
    pose = way @ shift(0.0, 0.0, height) @ turned @ shift(-_HANDLE[0], 0.0, 0.0)
    peg = way @ turn(X, 0.5 * math.pi)
    return Stage(
        (
            Item("peg", forms.cylinder(_PEG, 0.1), peg, mass=0.0),
            Item("body", mug, pose, 0.3),
        ),
        facts={"height": _PEG - _HANDLE[1] - float(np.linalg.norm(up))},
    )


def _center_height(track: Track) -> float:
    center = forms.center_of(track.item("body").form)
    pose = track.poses["body"][-1]
    return float(pose[2, :3] @ center + pose[2, 3])


_LINK, _LINKS = (0.025, 0.005), 4
_PITCH = 2.0 * (_LINK[0] - _LINK[1])


def _light_chain(placement: int) -> Stage:
    """Four rings of 20 g that hang in each other; the first is fixed."""
    ring = forms.torus(*_LINK)
    way = turn(Z, heading(placement))
    return Stage(
        tuple(
            Item(
                *(f"ring {i + 1}", ring),
                way
                @ shift(0.0, 0.0, -_PITCH * i)
                @ turn(Z, 0.5 * math.pi * (i % 2))
                @ turn(X, 0.5 * math.pi),
                0.0 if i == 0 else 0.02,
            )
            for i in range(_LINKS)
        )
    )


def _chain_length(track: Track) -> float:
    return float(np.linalg.norm(track.poses[f"ring {_LINKS}"][-1][:3, 3]))


def _true_chain(_: Track) -> float:
    return _PITCH * (_LINKS - 1)


_QUOIT, _POST = (0.05, 0.04, 0.02), 0.01


def _quoit(placement: int) -> Stage:
    """A ring dropped around a post of 20 mm, tilted by 10 degrees and pushed aside at 0.5 m/s."""
    way = turn(Z, heading(placement))
    return Stage(
        (
            Item("ground", forms.slab(1.0), mass=0.0),
            Item("post", forms.cylinder(_POST, 0.12), shift(0.0, 0.0, 0.06), mass=0.0),
            Item(
                *("body", forms.tube(*_QUOIT)),
                pose=shift(0.0, 0.0, 0.06) @ way @ turn(X, math.radians(10.0)),
                mass=0.1,
                velocity=as_vector(way[:3, 0] * (0.5 + 0.1 * scatter(placement))),
            ),
        ),
    )


def _from_post(track: Track) -> float:
    """The distance of the ring's middle from the post's axis at the end, meters."""
    return float(np.linalg.norm(track.poses["body"][-1][:2, 3]))


def _most_from_post(_: Track) -> float:
    return _QUOIT[1] - _POST


SCENES = (
    EverydayScene(
        "peg falls through a hole with 0.2 mm of play",
        FIT,
        "What falls straight through a wider hole touches nothing: free fall, summed over Euler steps.",
        lambda i: _peg(i, 0.01, 0.005),
        0.2,
        (Measure("distance", "m", _fallen, _free_fall, 0.05, relative=True),),
        held_out=True,
    ),
    EverydayScene(
        "peg too wide by 0.3 mm stays on a hole",
        FIT,
        "A peg wider than a hole lies on its rim; it begins 1 mm over that.",
        lambda i: _peg(i, 0.0105, 0.001),
        1.0,
        (Measure("distance down", "mm", _fallen, _drop, 2e-4, scale=1e3),),
        held_out=True,
    ),
    EverydayScene(
        "square key cannot turn in its hole",
        FIT,
        "A square of 10 mm turns in a hole of 10.4 mm by 2.3 degrees: s (cos t + sin t) = hole.",
        _key,
        1.0,
        (Measure("largest turn", "degrees", most_turned, _play, 1.0, signed=1),),
        # Lower rates turn it by more than its play in a step.
        rates=(1000.0, 200.0),
        most=10,
        held_out=True,
    ),
    EverydayScene(
        "mug hangs on a peg by its handle",
        HANG,
        "It rests with its handle's inside on the peg and its center of mass below: the lowest place that it can reach.",
        _mug_on_peg,
        3.0,
        (
            Measure(
                "height of its center",
                "mm",
                _center_height,
                lambda t: t.fact("height"),
                5e-4,
                scale=1e3,
            ),
        ),
        most=10,
        needs=2.0,
        held_out=True,
    ),
    EverydayScene(
        "chain of four light rings hangs",
        HANG,
        "Rigid rings in each other: three times twice the inner radius from the first to the last center.",
        _light_chain,
        3.0,
        (Measure("length", "mm", _chain_length, _true_chain, 0.01, relative=True, scale=1e3),),
        most=5,
        held_out=True,
    ),
    EverydayScene(
        "ring thrown around a post stays around it",
        HANG,
        "A ring that lies around a post is at most its inside radius less the post's off.",
        _quoit,
        2.0,
        (
            Measure(
                "distance from the post",
                "mm",
                _from_post,
                _most_from_post,
                5e-4,
                scale=1e3,
                signed=1,
            ),
            Measure("lowest vertex over the ground", "mm", lowest_vertex, nothing, 3e-4, scale=1e3),
        ),
        most=10,
        needs=2.0,
        held_out=True,
    ),
)
