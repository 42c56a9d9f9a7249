"""Bodies that begin overlapping, or that are pressed into the ground."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from voxshell_studies.scenes.everyday import forms
from voxshell_studies.scenes.everyday.rolling import lowest_vertex
from voxshell_studies.scenes.everyday.scene import (
    EverydayScene,
    Item,
    Measure,
    Stage,
    Y,
    Z,
    heading,
    scatter,
    shift,
    turn,
)
from voxshell_studies.scenes.everyday.sliding import nothing

if TYPE_CHECKING:
    from voxshell_studies.scenes.everyday.scene import Form, Track

OVERLAP = "Bodies that begin overlapping"


def _half_tori(placement: int) -> Stage:
    """Two tori in a plane whose rims overlap by half their thickness, weightless."""
    form = forms.torus(0.04, 0.01)
    way = turn(Z, heading(placement)) @ turn(Y, scatter(placement))
    reach = 0.5 * (2.0 * 0.05 - 0.01)
    return Stage(
        (
            Item(
                "left", form, way @ shift(-reach, 0.0, 0.0) @ turn(Z, heading(2 * placement)), 0.2
            ),
            Item(
                "right", form, way @ shift(reach, 0.0, 0.0) @ turn(Z, heading(3 * placement)), 0.2
            ),
        ),
        gravity=(0.0, 0.0, 0.0),
    )


def _tori_apart(track: Track) -> float:
    """The distance of the centers at the end, meters."""
    left, right = (track.poses[name][-1][:3, 3] for name in ("left", "right"))
    return float(np.linalg.norm(left - right))


def _touching_tori(_: Track) -> float:
    return 0.1


def _end_speed(track: Track) -> float:
    return max(float(np.linalg.norm(v[-1])) for v in track.velocities.values())


def _half_in(placement: int, ground: Form) -> Stage:
    """A cube of 0.1 m half in the ground."""
    place = shift(0.2 * scatter(placement), 0.2 * scatter(placement, 2), 0.0)
    return Stage(
        (
            Item("ground", ground, mass=0.0),
            Item("body", forms.box(0.1, 0.1, 0.1), place @ turn(Z, heading(placement))),
        )
    )


def _highest(track: Track) -> float:
    return float(track.poses["body"][:, 2, 3].max())


def _half_side(_: Track) -> float:
    return 0.05


def _brick(placement: int) -> Stage:
    """The brick of examples/scenes/bunny_and_balls.toml alone: Bullet's own box, 1 mm over the half-space."""
    pose = shift(0.55, 0.0, 0.021) @ turn(Z, heading(placement))
    form = forms.box(0.1, 0.06, 0.04)
    return Stage(
        (
            Item("ground", forms.PLANE, mass=0.0),
            Item("body", form, pose, 0.2, plain=True),
        )
    )


def _brick_and_ball(placement: int) -> Stage:
    """The same brick; a ball of 0.5 kg falls on it from 0.3 m."""
    stage = _brick(placement)
    hit = shift(0.55 + 0.02 * scatter(placement), 0.01 * scatter(placement, 2), 0.38)
    ball = Item("ball", forms.ball(0.04), hit, 0.5, plain=True)
    return Stage((*stage.items, ball))


SCENES = (
    EverydayScene(
        "tori that overlap by half",
        OVERLAP,
        "The shortest separating translation is along the line of centers, to a distance of twice the outer radius; bodies "
        "that leave an overlap gain no speed from it.",
        _half_tori,
        2.0,
        (
            Measure(
                "distance of the centers",
                "mm",
                _tori_apart,
                _touching_tori,
                1e-3,
                scale=1e3,
                signed=-1,
            ),
            Measure("speed at the end", "m/s", _end_speed, nothing, 0.1),
        ),
        most=10,
        shown=True,
    ),
    *(
        EverydayScene(
            f"cube half in the ground, {where}",
            OVERLAP,
            "The shortest separating translation is up by half its side; a body that leaves an overlap gains no speed from it.",
            lambda i, ground=ground: _half_in(i, ground()),
            3.0,
            (
                Measure(
                    "lowest vertex over the ground", "mm", lowest_vertex, nothing, 5e-4, scale=1e3
                ),
                Measure(
                    "largest height of its center",
                    "mm",
                    _highest,
                    _half_side,
                    2e-3,
                    scale=1e3,
                    signed=1,
                ),
            ),
            most=10,
        )
        for where, ground in (
            ("plane", lambda: forms.PLANE),
            ("slab of 0.2 m", lambda: forms.slab(1.0, 0.2)),
        )
    ),
    EverydayScene(
        "brick of the example scene settles",
        OVERLAP,
        "A brick dropped from 1 mm lies on the ground.",
        _brick,
        2.0,
        (Measure("lowest vertex over the ground", "mm", lowest_vertex, nothing, 2e-4, scale=1e3),),
        engines=("voxshell", "mujoco"),
        most=5,
    ),
    EverydayScene(
        "ball falls on the brick of the example scene",
        OVERLAP,
        "A brick that is hit from above lies on the ground afterwards.",
        _brick_and_ball,
        3.0,
        (Measure("lowest vertex over the ground", "mm", lowest_vertex, nothing, 2e-4, scale=1e3),),
        engines=("voxshell", "mujoco"),
        most=5,
    ),
)
