"""Many bodies at once: Galton boards and a shaken carton."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from voxshell_studies.scenes.everyday import forms
from voxshell_studies.scenes.everyday.scene import (
    EverydayScene,
    Item,
    Measure,
    Stage,
    X,
    Z,
    heading,
    scatter,
    shift,
    turn,
)
from voxshell_studies.scenes.everyday.sliding import nothing

if TYPE_CHECKING:
    from collections.abc import Callable

    from voxshell_studies.scenes.everyday.scene import Form, Track

CROWD = "Galton board and carton"

_BALLS = 40
_NARROW = (8, 0.03, 0.003, 0.02)
_WIDE = (8, 0.05, 0.004, 0.02)
"""Rows of pegs, their pitch and radius, and the distance of the panes, meters."""


def _galton(
    placement: int, ball: Form, board: tuple[int, float, float, float], friction: float
) -> Stage:
    """40 balls of 16 mm in a block over eight rows of pegs."""
    rows, pitch, _, depth = board
    items = [Item("board", forms.galton(*board), mass=0.0)]
    for i in range(_BALLS):
        x = (i % 5 - 2) * 0.02 + 0.002 * scatter(40 * placement + i)
        z = 0.03 + (i // 5) * 0.02
        pose = shift(x, 0.001 * scatter(40 * placement + i, 2), z) @ turn(X, 3.0 * scatter(i, 3))
        items.append(Item(f"ball {i + 1}", ball, pose, 0.01))
    return Stage(
        tuple(items),
        friction=friction,
        restitution=0.3,
        facts={
            "bottom": -0.9 * pitch * rows,
            "half depth": 0.5 * depth,
            "half width": 0.5 * pitch * (rows + 5),
        },
    )


def _count_balls(track: Track) -> tuple[float, float]:
    """Balls that have left the board below, and those that have left it through a pane or a wall."""
    through, escaped = 0, 0
    for poses in track.poses.values():
        below = np.nonzero(poses[:, 2, 3] < track.fact("bottom"))[0]
        inside = np.abs(poses[: below[0] if len(below) else None, :2, 3])
        limits = (track.fact("half width"), track.fact("half depth"))
        out = bool((inside > limits).any())
        escaped += out
        through += bool(len(below)) and not out
    return float(through), float(escaped)


def _galtons(
    name: str,
    make_ball: Callable[[float], Form],
    board: tuple[int, float, float, float],
    friction: float,
    law: str,
    *,
    rates: tuple[float, ...],
    most: int,
    shown: bool = False,
) -> EverydayScene:
    """Runs at 30 Hz are left out: a ball falls by its diameter in a step."""
    return EverydayScene(
        name,
        CROWD,
        law,
        lambda i: _galton(i, make_ball(0.008), board, friction),
        8.0,
        (
            Measure("balls through", "of 40", lambda t: _count_balls(t)[0], _all_balls, 0.0),
            Measure(
                "balls through panes or walls", "of 40", lambda t: _count_balls(t)[1], nothing, 0.0
            ),
        ),
        rates=rates,
        most=most,
        shown=shown,
        needs=8.0,
        heavy=True,
    )


_NARROW_LAW = "The gaps of 24 mm are 1.5 balls wide: all leave below, unless two make an arch; none passes a pane."
_WIDE_LAW = (
    "The gaps of 42 mm are 2.6 balls wide: no two balls make an arch over them, all leave below, and none "
    "passes a pane."
)


def _all_balls(_: Track) -> float:
    return float(_BALLS)


_CARTON = (0.3, 0.2, 0.2, 0.002)
"""Inside, meters, and its wall."""


def _carton(placement: int) -> Stage:
    """A closed carton with walls of 2 mm, shaken along a heading by 30 mm at 2 Hz, with 14 objects in it."""
    x, y, z, wall = _CARTON
    sides = []
    for axis, inside in enumerate((x, y, z)):
        for sign in (-1.0, 1.0):
            at, size = [0.0, 0.0, 0.0], [x + 2 * wall, y + 2 * wall, z + 2 * wall]
            at[axis] = sign * 0.5 * (inside + wall)
            size[axis] = wall
            sides.append(((at[0], at[1], at[2]), (size[0], size[1], size[2])))
    carton = forms.boxes("carton", tuple(sides))
    direction = np.array([math.cos(heading(placement)), 0.6 * math.sin(heading(placement)), 0.5])
    direction /= np.linalg.norm(direction)

    def path(time: float) -> np.ndarray:
        # From rest: the amplitude grows during the first half second.
        offset = 0.03 * min(time / 0.5, 1.0) * math.sin(4.0 * math.pi * time)
        return shift(*(offset * direction).tolist())

    kinds = (forms.box(0.04, 0.035, 0.03), forms.ball(0.02), forms.cylinder(0.015, 0.04))
    items = [Item("carton", carton, path=path)]
    for i in range(14):
        k = 14 * placement + i
        place = shift(0.1 * (i % 3 - 1), 0.1 * (i // 3 % 2 - 0.5), 0.066 * (i // 6 - 1))
        pose = place @ turn(Z, heading(k)) @ turn(X, 3.0 * scatter(k))
        items.append(Item(f"object {i + 1}", kinds[i % 3], pose, 0.05))
    return Stage(tuple(items), friction=0.4)


def _in_carton(track: Track) -> tuple[float, float]:
    """How many objects are inside at the end, and how deep a vertex is in a wall at most, meters."""
    inside = 0.5 * np.array(_CARTON[:3])
    path = track.item("carton").path
    assert path is not None
    kept, deepest = 0, 0.0
    every = max(round(0.05 / track.time_step), 1)
    for name, poses in track.poses.items():
        vertices = track.item(name).form.vertices
        offset = path(track.seconds)[:3, 3]
        kept += bool((np.abs(poses[-1][:3, 3] - offset) < inside).all())
        for step in range(0, len(poses), every):
            pose = poses[step]
            middle = path(step * track.time_step)[:3, 3]
            if (np.abs(pose[:3, 3] - middle) < inside).all():
                corners = np.abs(vertices @ pose[:3, :3].T + pose[:3, 3] - middle)
                deepest = max(deepest, float((corners - inside).max()))
    return float(kept), deepest


def _all_objects(_: Track) -> float:
    return 14.0


SCENES = (
    *(
        _galtons(
            f"40 {kind} run down a Galton board, {gaps}",
            make,
            board,
            friction,
            law,
            rates=rates,
            most=most,
            shown=kind == "balls",
        )
        for gaps, board, friction, law in (
            ("narrow gaps", _NARROW, 0.2, _NARROW_LAW),
            ("wide gaps", _WIDE, 0.1, _WIDE_LAW),
        )
        for kind, make, rates, most in (
            ("balls", forms.ball, (1000.0, 200.0, 60.0), 3),
            ("dented balls", forms.dented_ball, (200.0, 60.0), 2),
        )
    ),
    EverydayScene(
        "carton of 2 mm shaken with 14 objects",
        CROWD,
        "Walls are solid: nothing leaves a closed carton, and no corner enters a wall.",
        _carton,
        6.0,
        (
            Measure("objects inside", "of 14", lambda t: _in_carton(t)[0], _all_objects, 0.0),
            Measure(
                "deepest in a wall", "mm", lambda t: _in_carton(t)[1], nothing, 1e-3, scale=1e3
            ),
        ),
        rates=(200.0, 60.0),
        most=3,
        shown=True,
        heavy=True,
    ),
)
