"""Stacks, arch, card house, lever, wedge."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from voxshell_studies.scenes.everyday import forms, laws
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
from voxshell_studies.scenes.everyday.sliding import nothing, one

if TYPE_CHECKING:
    from collections.abc import Sequence

    from voxshell_studies.scenes.everyday.scene import Form, Track

STACK, BUILT = "Stacks", "Arch, cards, lever, wedge"
RESTS = (
    "Rigid bodies that lie on each other keep the sum of their heights, and a stack whose center of mass is "
    "over its foot does not move."
)


def _stack(placement: int, parts: Sequence[tuple[Form, float, float]]) -> Stage:
    """Bodies on a slab of 1 m, one on the other.

    Args:
        placement: Turns each body about z and sets it aside by up to 2 mm.
        parts: Form, height and mass of each from below, meters and kilograms.
    """
    items = [Item("ground", forms.slab(1.0), turn(Z, heading(placement)), mass=0.0)]
    top = 0.0
    for i, (form, height, mass) in enumerate(parts):
        aside = shift(
            0.002 * scatter(placement, 2 * i + 1), 0.002 * scatter(placement, 2 * i + 2), top
        )
        yaw = turn(Z, heading(placement * (i + 2)))
        items.append(Item(f"body {i + 1}", form, aside @ yaw @ forms.standing(form), mass))
        top += height
    return Stage(tuple(items))


def _worst_height(track: Track) -> float:
    """Of all bodies, the change of height that differs most from none, meters."""
    return max(
        (float(abs(poses[-1][2, 3] - poses[0][2, 3])) for poses in track.poses.values()),
        default=0.0,
    )


def _worst_aside(track: Track) -> float:
    return max(
        float(np.linalg.norm(poses[-1][:2, 3] - poses[0][:2, 3])) for poses in track.poses.values()
    )


HEIGHTS = Measure("largest change of height", "mm", _worst_height, nothing, 1e-4, scale=1e3)


def _stacks(
    name: str,
    parts: Sequence[tuple[str, float, float]],
    *,
    shown: bool = False,
    heavy: bool = False,
) -> EverydayScene:
    """``parts``: see :func:`_stack`, forms by name."""

    def stage(placement: int) -> Stage:
        return _stack(placement, [(_FORMS[form](), height, mass) for form, height, mass in parts])

    return EverydayScene(
        name,
        STACK,
        RESTS,
        stage,
        5.0 if heavy else 10.0,
        (
            HEIGHTS,
            Measure("largest sideways displacement", "mm", _worst_aside, nothing, 5e-4, scale=1e3),
        ),
        most=10,
        shown=shown,
        heavy=heavy,
    )


_FORMS = {
    "plate": lambda: forms.box(0.1, 0.1, 0.001),
    "cube": lambda: forms.box(0.05, 0.05, 0.05),
    "can": lambda: forms.cylinder(0.033, 0.115),
    "mug": forms.mug,
    "brick": lambda: forms.box(0.12, 0.08, 0.04),
}

# ---- arch, cards, lever, wedge -------------------------------------------------------------------

_STONES = 7
_ARCH = (0.2, 0.28, 0.1)
"""Inner and outer radius and depth, meters."""


def _arch(placement: int) -> Stage:
    """A half circle of seven stones on a slab, its plane in a heading."""
    inner, outer, depth = _ARCH
    stone_angle = math.pi / _STONES
    half = 0.5 * stone_angle
    points = tuple(
        (radius * math.cos(math.pi / 2 + a), y, radius * math.sin(math.pi / 2 + a))
        for radius in (inner, outer)
        for a in (-half, half)
        for y in (-0.5 * depth, 0.5 * depth)
    )
    stone = forms.solid(f"stone of {_STONES}", points)
    way = turn(Z, heading(placement))
    items = [Item("ground", forms.slab(1.0), turn(Z, heading(5 * placement)), mass=0.0)]
    for i in range(_STONES):
        angle = (i - 0.5 * (_STONES - 1)) * stone_angle
        items.append(Item(f"stone {i + 1}", stone, way @ turn(Y, angle), 1.0))
    return Stage(tuple(items), friction=0.7)


def worst_way(track: Track) -> float:
    """The largest distance of an origin from its start at the end, meters."""
    return max(
        float(np.linalg.norm(poses[-1][:3, 3] - poses[0][:3, 3])) for poses in track.poses.values()
    )


_CARD = (0.0008, 0.06, 0.09)
_LEAN = math.radians(20.0)


def _cards(placement: int, friction: float) -> Stage:
    """Two cards of 0.8 mm that lean on each other by 20 degrees, on a slab."""
    card = forms.box(*_CARD)
    way = turn(Z, heading(placement))
    items = [Item("ground", forms.slab(1.0), turn(Z, heading(5 * placement)), mass=0.0)]
    for name, side in (("left", -1.0), ("right", 1.0)):
        rotation = turn(Y, -side * _LEAN)
        corners = forms.box(*_CARD).vertices @ rotation[:3, :3].T
        # The upper inner edge at x = 0, the lower one on the ground.
        x = -corners[:, 0].max() if side < 0 else -corners[:, 0].min()
        pose = way @ shift(float(x), 0.0, float(-corners[:, 2].min())) @ rotation
        items.append(Item(name, card, pose, 0.002))
    return Stage(tuple(items), friction=friction)


def _drop(track: Track) -> float:
    """How far the higher card's center has come down, meters."""
    return max(float(poses[0][2, 3] - poses[-1][2, 3]) for poses in track.poses.values())


def _has_fallen(track: Track) -> float:
    return float(_drop(track) > 0.02)


def _lever(placement: int, ratio: float) -> Stage:
    """A plank on an edge: 1 kg on one end at 0.2 m, ``ratio`` kg on the other at 0.1 m."""
    way = turn(Z, heading(placement))
    points = tuple(
        (x, y, z) for y in (-0.05, 0.05) for x, z in ((-0.05, 0.0), (0.05, 0.0), (0.0, 0.06))
    )
    fulcrum = forms.solid("fulcrum", points)
    plank = forms.box(0.5, 0.06, 0.01)
    cube = forms.box(0.04, 0.04, 0.04)
    top = 0.06 + 0.01
    return Stage(
        (
            Item("ground", forms.slab(1.0), mass=0.0),
            Item("fulcrum", fulcrum, way, mass=0.0),
            Item("plank", plank, way @ shift(0.0, 0.0, top - 0.005), 0.2),
            Item("light", cube, way @ shift(0.2, 0.0, top + 0.02), 1.0),
            Item("heavy", cube, way @ shift(-0.1, 0.0, top + 0.02), ratio),
        ),
        friction=0.8,
        world_from_ramp=way[:3, :3],
    )


def _heavy_side(track: Track) -> float:
    """1 where the heavy side's end of the plank is lower at the end, -1 where the other one is."""
    axis = track.poses["plank"][-1][:3, 0] @ track.stage.world_from_ramp
    return float(np.sign(axis[2]) if abs(axis[2]) > math.sin(math.radians(3.0)) else 0.0)


def _other_side(_: Track) -> float:
    return -1.0


_WEDGE = math.radians(30.0)


def _wedge(placement: int) -> Stage:
    """A block of 1 kg on a wedge of 2 kg on a slab, both without friction."""
    way = turn(Z, heading(placement))
    length = 0.4
    height = length * math.tan(_WEDGE)
    points = tuple(
        (x, y, z) for y in (-0.1, 0.1) for x, z in ((0.0, 0.0), (length, 0.0), (0.0, height))
    )
    form = forms.solid("wedge of 30 degrees", points)
    cube = forms.box(0.06, 0.06, 0.06)
    on_it = (
        shift(0.1, 0.0, height - 0.1 * math.tan(_WEDGE)) @ turn(Y, _WEDGE) @ shift(0.0, 0.0, 0.03)
    )
    return Stage(
        (
            Item("ground", forms.slab(2.0), turn(Z, heading(5 * placement)), mass=0.0),
            Item("wedge", form, way @ shift(-0.2, 0.0, 0.0), 2.0),
            Item("block", cube, way @ shift(-0.2, 0.0, 0.0) @ on_it, 1.0),
        ),
        friction=0.0,
        world_from_ramp=way[:3, :3],
    )


def _wedge_way(track: Track) -> float:
    return float(-track.path("wedge")[-1, 0])


def _true_wedge(track: Track) -> float:
    pull = laws.wedge_acceleration(_WEDGE, 1.0, 2.0)
    return laws.way(0.0, pull, track.seconds, track.time_step)


SCENES = (
    _stacks("six plates of 1 mm, stacked", [("plate", 0.001, 0.05)] * 6, shown=True, heavy=True),
    _stacks(
        "cube, can, cube, stacked", [("cube", 0.05, 0.3), ("can", 0.115, 0.3), ("cube", 0.05, 0.3)]
    ),
    _stacks("brick, mug, brick, mug, stacked", [("brick", 0.04, 0.5), ("mug", 0.1, 0.3)] * 2),
    _stacks("five bricks, stacked", [("brick", 0.04, 0.5)] * 5, heavy=True),
    _stacks("100 kg on 1 kg", [("brick", 0.04, 1.0), ("brick", 0.04, 100.0)]),
    EverydayScene(
        "arch of seven stones",
        BUILT,
        "A half circle stands if its thickness is at least 0.107 of its mean radius (Milankovitch) and "
        "friction holds the feet; here 0.33 and friction 0.7.",
        _arch,
        5.0,
        (Measure("largest displacement of a stone", "mm", worst_way, nothing, 5e-4, scale=1e3),),
        most=5,
        shown=True,
        heavy=True,
    ),
    EverydayScene(
        "two cards lean on each other",
        BUILT,
        "They stand if friction at the foot is at least tan(lean) / 2 = 0.18; here 0.4.",
        lambda i: _cards(i, 0.4),
        5.0,
        (Measure("drop", "mm", _drop, nothing, 5e-4, scale=1e3),),
        most=5,
    ),
    EverydayScene(
        "two cards slip",
        BUILT,
        "They slip if friction at the foot is below tan(lean) / 2 = 0.18; here 0.1.",
        lambda i: _cards(i, 0.1),
        3.0,
        (Measure("falls", "", _has_fallen, one, 0.0),),
        most=5,
    ),
    EverydayScene(
        "lever sinks at the heavy side",
        BUILT,
        "1 kg at 0.2 m against 2.5 kg at 0.1 m: the greater moment wins (Archimedes).",
        lambda i: _lever(i, 2.5),
        2.0,
        (Measure("side that sinks", "", _heavy_side, one, 0.0),),
        most=5,
    ),
    EverydayScene(
        "lever sinks at the long side",
        BUILT,
        "1 kg at 0.2 m against 1.5 kg at 0.1 m: the greater moment wins (Archimedes).",
        lambda i: _lever(i, 1.5),
        2.0,
        (Measure("side that sinks", "", _heavy_side, _other_side, 0.0),),
        most=5,
    ),
    EverydayScene(
        "wedge slides away below a block",
        BUILT,
        "Wedge and block without friction: A = m g sin a cos a / (M + m sin2 a), summed over Euler steps.",
        _wedge,
        0.3,
        (
            Measure(
                "distance of the wedge",
                "mm",
                _wedge_way,
                _true_wedge,
                0.05,
                relative=True,
                scale=1e3,
            ),
        ),
    ),
)
