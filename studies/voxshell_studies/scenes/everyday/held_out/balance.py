"""Bodies that lean, stand, tip and balance."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from voxshell_studies.scenes.everyday import forms
from voxshell_studies.scenes.everyday.held_out import bodies
from voxshell_studies.scenes.everyday.scene import (
    EverydayScene,
    Item,
    Joint,
    Measure,
    Stage,
    Y,
    Z,
    heading,
    shift,
    turn,
)
from voxshell_studies.scenes.everyday.sliding import as_vector, farthest, nothing, one
from voxshell_studies.scenes.everyday.stacks import worst_way

if TYPE_CHECKING:
    from collections.abc import Sequence

    from voxshell_studies.scenes.everyday.scene import Track

LEAN, EDGE = "Ladders and tables", "Over an edge"

# ---- ladders -------------------------------------------------------------------------------------

_LADDER = (0.04, 0.4, 2.0)


def _ladder(placement: int, degrees: float) -> Stage:
    """A ladder of 2 m and 10 kg that leans on a wall at an angle over the floor, friction 0.5 at both."""
    way = turn(Z, heading(placement))
    form = forms.box(*_LADDER)
    lean = turn(Y, math.radians(degrees) - 0.5 * math.pi)
    corners = form.vertices @ lean[:3, :3].T
    low = corners.min(axis=0)
    pose = way @ shift(-float(low[0]), 0.0, -float(low[2])) @ lean
    return Stage(
        (
            Item("ground", forms.PLANE, mass=0.0),
            Item("wall", forms.box(0.1, 2.0, 3.0), way @ shift(-0.05, 0.0, 1.5), mass=0.0),
            Item("body", form, pose, 10.0),
        ),
        friction=0.5,
    )


def _sunk(track: Track) -> float:
    """How far the body's origin has come down, meters."""
    return float(-track.path("body")[-1, 2])


def _has_sunk(track: Track) -> float:
    return float(_sunk(track) > 0.1)


# ---- pushed and loaded ---------------------------------------------------------------------------


def _tilted(track: Track) -> float:
    """The largest tilt of the body's z axis from where it began, degrees."""
    axes = track.poses["body"][:, :3, 2]
    return float(np.degrees(np.arccos(np.clip(axes @ axes[0], -1.0, 1.0))).max())


def _has_tipped(track: Track) -> float:
    return float(_tilted(track) > 20.0)


def _loaded_table(placement: int, load: float) -> Stage:
    """A table of 10 kg with a cube of 0.1 m on its overhang, 0.1 m beyond its feet."""
    way = turn(Z, heading(placement))
    on_it = way @ shift(0.4, 0.0, 0.55)
    return Stage(
        (
            Item("ground", forms.slab(3.0), turn(Z, heading(5 * placement)), mass=0.0),
            Item("body", bodies.table(), way, 10.0),
            Item("load", forms.box(0.1, 0.1, 0.1), on_it, load),
        ),
        friction=0.8,
    )


def _scale(placement: int) -> Stage:
    """A plank hung on a hinge 0.3 m over it, with 1 kg at 0.4 m and 2 kg at 0.2 m on the other side."""
    way = turn(Z, heading(placement))
    cube = forms.box(0.08, 0.08, 0.08)
    return Stage(
        (
            Item(
                *("body", forms.box(1.0, 0.2, 0.03), way, 5.0),
                joint=Joint("hinge", (0.0, 0.0, 0.3), as_vector(way[:3, 1])),
            ),
            Item("light", cube, way @ shift(0.4, 0.0, 0.055), 1.0),
            Item("heavy", cube, way @ shift(-0.2, 0.0, 0.055), 2.0),
        ),
        friction=0.8,
    )


# ---- edges ---------------------------------------------------------------------------------------

BOOK = (0.2, 0.15, 0.03)


def _books(placement: int, overhangs: Sequence[float]) -> Stage:
    """Books on a table: each reaches over what is below by a fraction of its length; the lowest comes first."""
    way = turn(Z, heading(placement))
    length, _, thickness = BOOK
    items = [Item("table", forms.slab(1.0), way, mass=0.0)]
    edge = 0.5
    for i, overhang in enumerate(overhangs):
        edge += overhang * length
        pose = way @ shift(edge - 0.5 * length, 0.0, (i + 0.5) * thickness)
        name = "body" if i == len(overhangs) - 1 else f"book {i + 1}"
        items.append(Item(name, forms.box(*BOOK), pose, 0.5))
    return Stage(tuple(items))


_HARMONIC = tuple(0.9 / (2.0 * n) for n in (4, 3, 2, 1))


SCENES = (
    EverydayScene(
        "ladder holds at 45 degrees",
        LEAN,
        "With friction mu at floor and wall a ladder slips below atan((1 - mu2) / (2 mu)), 36.9 degrees at mu 0.5.",
        lambda i: _ladder(i, 45.0),
        2.0,
        (Measure("creep", "mm", farthest, nothing, 5e-4, scale=1e3),),
        most=5,
        held_out=True,
    ),
    EverydayScene(
        "ladder slips at 30 degrees",
        LEAN,
        "With friction mu at floor and wall a ladder slips below atan((1 - mu2) / (2 mu)), 36.9 degrees at mu 0.5.",
        lambda i: _ladder(i, 30.0),
        2.0,
        (Measure("slips", "", _has_sunk, one, 0.0),),
        most=5,
        needs=2.0,
        held_out=True,
    ),
    EverydayScene(
        "table stands below 20 kg on its overhang",
        LEAN,
        "10 kg with a lever of 0.3 m to the feet holds up to 30 kg with one of 0.1 m (Archimedes).",
        lambda i: _loaded_table(i, 20.0),
        2.0,
        (Measure("largest displacement", "mm", worst_way, nothing, 5e-4, scale=1e3),),
        most=5,
        held_out=True,
    ),
    EverydayScene(
        "table tips below 45 kg on its overhang",
        LEAN,
        "10 kg with a lever of 0.3 m to the feet holds up to 30 kg with one of 0.1 m (Archimedes).",
        lambda i: _loaded_table(i, 45.0),
        1.5,
        (Measure("tips", "", _has_tipped, one, 0.0),),
        most=5,
        needs=1.5,
        held_out=True,
    ),
    EverydayScene(
        "hung plank stays level between 1 kg and 2 kg",
        LEAN,
        "1 kg at 0.4 m balances 2 kg at 0.2 m (Archimedes), and a plank below its hinge is stable.",
        _scale,
        2.0,
        (Measure("largest tilt", "degrees", _tilted, nothing, 1.0),),
        most=5,
        held_out=True,
    ),
    EverydayScene(
        "book holds over a table's edge",
        EDGE,
        "A body stands if its center of mass is over the table: here 45 % of it is outside.",
        lambda i: _books(i, (0.45,)),
        2.0,
        (Measure("creep", "mm", farthest, nothing, 1e-4, scale=1e3),),
        most=5,
        held_out=True,
    ),
    EverydayScene(
        "book falls off a table's edge",
        EDGE,
        "A body falls if its center of mass is not over the table: here 55 % of it is outside.",
        lambda i: _books(i, (0.55,)),
        1.5,
        (Measure("falls", "", _has_sunk, one, 0.0),),
        most=5,
        needs=1.5,
        held_out=True,
    ),
    EverydayScene(
        "four books reach over a table's edge",
        EDGE,
        "Overhangs of 1/8, 1/6, 1/4 and 1/2 of the length from below are the limit (the harmonic stack); here 0.9 of "
        "each.",
        lambda i: _books(i, _HARMONIC),
        2.0,
        (Measure("largest displacement", "mm", worst_way, nothing, 5e-4, scale=1e3),),
        most=5,
        held_out=True,
    ),
)
