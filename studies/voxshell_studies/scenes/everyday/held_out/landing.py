"""Bodies that fall, and come to rest where they must."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from voxshell_studies.scenes.everyday import forms
from voxshell_studies.scenes.everyday.held_out import bodies
from voxshell_studies.scenes.everyday.held_out.balance import BOOK
from voxshell_studies.scenes.everyday.rolling import lowest_vertex
from voxshell_studies.scenes.everyday.scene import (
    EverydayScene,
    Item,
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
from voxshell_studies.scenes.everyday.sliding import nothing
from voxshell_studies.scenes.everyday.stacks import worst_way

if TYPE_CHECKING:
    from voxshell_studies.scenes.everyday.scene import Form, Track

LAND = "Landing and resting"


def _falling_rod(placement: int) -> Stage:
    """A rod of 1 m and 10 mm, its foot on a smooth slab, released at 30 degrees from the vertical."""
    way = turn(Z, heading(placement))
    form = forms.cylinder(0.005, 1.0, 48)
    lean = turn(Y, math.radians(30.0)) @ turn(Z, heading(3 * placement))
    low = float((form.vertices @ lean[2, :3]).min())
    return Stage(
        (
            Item("ground", forms.slab(3.0), way, mass=0.0),
            Item("body", form, way @ shift(0.0, 0.0, -low) @ lean, 0.2),
        ),
        friction=0.0,
    )


def _aside(track: Track) -> float:
    return float(np.linalg.norm(track.path("body")[:, :2], axis=1).max())


def _slope_of_axis(track: Track) -> float:
    """Of the body's z axis over the level at the end, degrees."""
    return math.degrees(math.asin(min(abs(float(track.poses["body"][-1][2, 2])), 1.0)))


def _landing(
    placement: int, form: Form, mass: float, height: float, tilt: float, length: float
) -> Stage:
    """A body that falls from a height over a slab, tilted by some degrees."""
    lean = (
        turn(Z, heading(placement)) @ turn(X, math.radians(tilt)) @ turn(Z, heading(3 * placement))
    )
    low = float((form.vertices @ lean[2, :3]).min())
    return Stage(
        (
            Item("ground", forms.slab(length), turn(Z, heading(5 * placement)), mass=0.0),
            Item("body", form, shift(0.0, 0.0, height - low) @ lean, mass),
        )
    )


def _tilt(track: Track) -> float:
    """Of the body's z axis from the vertical at the end, degrees; a body that lies upside down counts as level."""
    return math.degrees(math.acos(min(abs(float(track.poses["body"][-1][2, 2])), 1.0)))


def _upright(track: Track) -> float:
    """Of the body's z axis from the vertical at the end, degrees, 0 to 180."""
    return math.degrees(math.acos(max(-1.0, min(1.0, float(track.poses["body"][-1][2, 2])))))


def _lands(
    name: str, form: str, mass: float, height: float, tilt: float, length: float, deep: float
) -> EverydayScene:
    return EverydayScene(
        name,
        LAND,
        "A flat body that has fallen lies flat, its lowest point on the ground.",
        lambda i: _landing(i, _FORMS[form](), mass, height, tilt, length),
        2.0,
        (
            Measure("lowest vertex over the ground", "mm", lowest_vertex, nothing, deep, scale=1e3),
            Measure("tilt at the end", "degrees", _tilt, nothing, 1.0),
        ),
        most=10,
        needs=2.0,
        held_out=True,
    )


_FORMS = {
    "washer": lambda: forms.tube(0.0025, 0.0013, 0.0005, 48),
    "sheet": lambda: forms.box(1.0, 1.0, 0.001),
}


def _sunken_book(placement: int) -> Stage:
    """A book that begins 2 mm inside a slab."""
    pose = shift(0.2 * scatter(placement), 0.2 * scatter(placement, 2), 0.013) @ turn(
        Z, heading(placement)
    )
    return Stage(
        (
            Item("ground", forms.slab(1.0), mass=0.0),
            Item("body", forms.box(*BOOK), pose, 0.5),
        )
    )


def _jump(track: Track) -> float:
    """The largest height of a flat book's middle, meters."""
    return float(track.poses["body"][:, 2, 3].max())


def _half_book(_: Track) -> float:
    return 0.5 * BOOK[2]


_CUPS = 3


def _cups(placement: int) -> Stage:
    """Three conical cups in each other on a slab, 50 g each."""
    items = [Item("ground", forms.slab(1.0), turn(Z, heading(placement)), mass=0.0)]
    for i in range(_CUPS):
        pose = shift(0.0, 0.0, 0.015 * i) @ turn(Z, heading(placement * (i + 2)))
        items.append(Item(f"cup {i + 1}", bodies.cup(), pose, 0.05))
    return Stage(tuple(items))


def _between_walls(placement: int) -> Stage:
    """A ball of 0.1 m that falls 20 mm into a V-groove of 90 degrees, 3 mm off its middle."""
    way = turn(Z, heading(placement))
    pose = way @ shift(0.0, 0.003, 0.05 * math.sqrt(2.0) + 0.02) @ turn(X, 2.0 * scatter(placement))
    return Stage(
        (
            Item("groove", bodies.groove(1.0, 0.15), way, mass=0.0),
            Item("body", forms.ball(0.05), pose),
        )
    )


def _height(track: Track) -> float:
    return float(track.poses["body"][-1][2, 3])


def _wedged_height(_: Track) -> float:
    return 0.05 * math.sqrt(2.0)


SCENES = (
    EverydayScene(
        "rod falls flat on a smooth slab",
        LAND,
        "Without friction nothing moves its center aside (Newton), and it ends up lying.",
        _falling_rod,
        1.5,
        (
            Measure("largest sideways displacement", "mm", _aside, nothing, 2e-3, scale=1e3),
            Measure("slope at the end", "degrees", _slope_of_axis, nothing, 0.2),
        ),
        most=10,
        needs=1.5,
        held_out=True,
    ),
    _lands("washer of 5 mm lands flat", "washer", 0.001, 0.005, 10.0, 0.3, 5e-5),
    _lands("sheet of 1 m and 1 mm lands flat", "sheet", 3.0, 0.005, 10.0, 3.0, 3e-4),
    EverydayScene(
        "mug lands upright",
        LAND,
        "A mug dropped 20 mm with a tilt of 5 degrees falls back on its foot: it would tip beyond 40 degrees.",
        lambda i: _landing(i, forms.mug(), 0.3, 0.02, 5.0, 1.0),
        2.0,
        (
            Measure("lowest vertex over the ground", "mm", lowest_vertex, nothing, 5e-4, scale=1e3),
            Measure("tilt at the end", "degrees", _upright, nothing, 1.0),
        ),
        most=10,
        needs=2.0,
        held_out=True,
    ),
    EverydayScene(
        "book begins 2 mm inside a table",
        LAND,
        "The shortest separating translation is up; a body that leaves an overlap gains no speed from it.",
        _sunken_book,
        2.0,
        (
            Measure("lowest vertex over the ground", "mm", lowest_vertex, nothing, 2e-4, scale=1e3),
            Measure(
                "largest height of its center", "mm", _jump, _half_book, 1e-3, scale=1e3, signed=1
            ),
        ),
        most=10,
        needs=2.0,
        held_out=True,
    ),
    EverydayScene(
        "three cups stand in each other",
        LAND,
        "Each one stands on the floor of the one below, 15 mm thick, with play at the walls; nothing moves.",
        _cups,
        1.5,
        (Measure("largest displacement", "mm", worst_way, nothing, 5e-4, scale=1e3),),
        most=5,
        held_out=True,
    ),
    EverydayScene(
        "ball comes to rest between two walls",
        LAND,
        "Between walls at 45 degrees a ball rests r / sin 45 deg over their line.",
        _between_walls,
        2.0,
        (Measure("height of its center", "mm", _height, _wedged_height, 3e-4, scale=1e3),),
        most=10,
        needs=2.0,
        held_out=True,
    ),
)
