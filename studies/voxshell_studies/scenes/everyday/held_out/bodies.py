"""Bodies that only held-out scenes have: closed meshes, and the convex parts that represent them elsewhere."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
from voxshell_studies.scenes.everyday import forms
from voxshell_studies.scenes.everyday.scene import Form, Piece, Vector, X, shift, turn
from voxshell_studies.scenes.solids import as_mesh, import_manifold


@cache
def groove(length: float, width: float) -> Form:
    """A V-groove of 90 degrees along x, its lowest line through the origin: two boards, 20 mm thick.

    Args:
        length: Meters.
        width: Of each wall, meters.
    """
    thick = 0.02
    solids = import_manifold()
    size = (length, width + thick, thick)
    # Each board's upper face goes through the x axis and reaches below the other one's.
    poses = [
        turn(X, side * 0.25 * math.pi) @ shift(0.0, side * 0.5 * (width - thick), -0.5 * thick)
        for side in (-1.0, 1.0)
    ]
    boards = [solids.Manifold.cube(size, True).transform(pose[:3].tolist()) for pose in poses]
    pieces = tuple(Piece("box", (size[0] / 2, size[1] / 2, size[2] / 2), pose) for pose in poses)
    return Form(f"groove {length:g} {width:g}", as_mesh(boards[0] + boards[1]), pieces)


@cache
def pencil() -> Form:
    """A regular hexagonal prism, 4 mm from axis to edges, 175 mm long along y, on one of its faces."""
    angles = (np.arange(6) + 0.5) * math.pi / 3.0 + 0.5 * math.pi
    points = tuple(
        (0.004 * math.cos(a), y, 0.004 * math.sin(a))
        for a in angles.tolist()
        for y in (-0.0875, 0.0875)
    )
    return forms.solid("hexagonal pencil", points)


@cache
def cone(radius: float, height: float) -> Form:
    """A cone, its apex at the origin and its axis along z."""
    rim = [
        (radius * math.cos(a), radius * math.sin(a), height)
        for a in (2.0 * math.pi / forms.FINE * np.arange(forms.FINE)).tolist()
    ]
    return forms.solid(f"cone {radius:g} {height:g}", ((0.0, 0.0, 0.0), *rim))


@cache
def half_cylinder(radius: float, length: float) -> Form:
    """The lower half of a cylinder about y; its axis goes through the origin."""
    parts = 384
    angles = (math.pi / parts * np.arange(parts + 1)).tolist()
    points = tuple(
        (-radius * math.cos(a), y, -radius * math.sin(a))
        for a in angles
        for y in (-0.5 * length, 0.5 * length)
    )
    return forms.solid(f"half cylinder {radius:g} {length:g}", points)


@cache
def closed_can(radius: float, height: float, wall: float) -> Form:
    """A hollow cylinder about z with two lids; size of its outside."""
    solids = import_manifold()
    outside = solids.Manifold.cylinder(height, radius, radius, 96, True)
    inner = radius - wall
    mesh = as_mesh(outside - solids.Manifold.cylinder(height - 2.0 * wall, inner, inner, 96, True))
    lids = tuple(
        Piece("cylinder", (radius, wall), shift(0.0, 0.0, side * 0.5 * (height - wall)))
        for side in (-1.0, 1.0)
    )
    staves = forms.tube(radius, inner, height, 96).pieces
    return Form(f"closed can {radius:g} {height:g} {wall:g}", mesh, (*staves, *lids))


@cache
def cup() -> Form:
    """A conical cup, 0.1 m high, open above; its floor, 15 mm thick, begins at z = 0.

    Its outside widens from 25 to 45 mm, and its wall is 2 mm thick along the radius: a cup in it stands on
    its floor with a play of 1 mm at the wall.
    """
    solids = import_manifold()
    floor, height, low, high, wall = 0.015, 0.1, 0.025, 0.045, 0.002

    def outside(z: float) -> float:
        return low + (high - low) * z / height

    body = solids.Manifold.cylinder(height, low, high, 48)
    # The hollow goes on above the rim, so that no faces coincide.
    top = height + 0.01
    hollow = solids.Manifold.cylinder(
        top - floor, outside(floor) - wall, outside(top) - wall, 48
    ).translate((0.0, 0.0, floor))
    sector = 2.0 * math.pi / 24

    def ring(z: float, inset: float, angles: list[float]) -> list[Vector]:
        radius = outside(z) - inset
        return [(radius * math.cos(a), radius * math.sin(a), z) for a in angles]

    turns = [sector * i for i in range(25)]
    pieces = [
        Piece("hull", points=np.array(ring(0.0, 0.0, turns[:-1]) + ring(floor, 0.0, turns[:-1])))
    ]
    for i in range(24):
        pair = turns[i : i + 2]
        points = [*ring(floor, 0.0, pair), *ring(floor, wall, pair)]
        points += [*ring(height, 0.0, pair), *ring(height, wall, pair)]
        pieces.append(Piece("hull", points=np.array(points)))
    return Form("conical cup", as_mesh(body - hollow), tuple(pieces))


@cache
def table() -> Form:
    """A table of 1 x 0.6 m, 0.5 m high, from z = 0; the outsides of its feet are 0.3 m from its middle."""
    legs = tuple(
        ((0.28 * x, 0.23 * y, 0.235), (0.04, 0.04, 0.47)) for x in (-1.0, 1.0) for y in (-1.0, 1.0)
    )
    return forms.boxes("overhanging table", (((0.0, 0.0, 0.485), (1.0, 0.6, 0.03)), *legs))


@cache
def square_hole(hole: float, thickness: float) -> Form:
    """A plate of 60 mm with a square hole about z, its middle at z = 0."""
    wide = 0.5 * (0.06 - hole)
    at = 0.5 * (hole + wide)
    return forms.boxes(
        f"square hole {hole:g} {thickness:g}",
        (
            ((at, 0.0, 0.0), (wide, 0.06, thickness)),
            ((-at, 0.0, 0.0), (wide, 0.06, thickness)),
            ((0.0, at, 0.0), (0.06, wide, thickness)),
            ((0.0, -at, 0.0), (0.06, wide, thickness)),
        ),
    )


RACK = (20, 0.02, 0.008)
"""Teeth of the rack, their pitch and height, meters."""


@cache
def rack() -> Form:
    """A rack along x, 20 mm wide: teeth rise along x from z = 0 and drop straight; a tooth ends at x = 0."""
    teeth, pitch, height = RACK
    solids = import_manifold()
    parts: list[Any] = []
    for i in range(-teeth // 2, teeth // 2):
        outline = ((0.0, -0.01), (pitch, -0.01), (pitch, height), (0.0, 0.0))
        points = [(pitch * i + x, y, z) for x, z in outline for y in (-0.01, 0.01)]
        parts.append(solids.Manifold.hull_points(np.array(points)))
    pieces = tuple(Piece("hull", points=as_mesh(part).vertices) for part in parts)
    return Form("rack", as_mesh(solids.Manifold.batch_boolean(parts, solids.OpType.Add)), pieces)


@cache
def gentle_wedge(slope: float) -> Form:
    """A wedge of 0.4 m whose upper face falls along x to z = 0 at x = 0.2 m; radians."""
    height = 0.4 * math.tan(slope)
    points = tuple(
        (x, y, z) for y in (-0.1, 0.1) for x, z in ((-0.2, 0.0), (0.2, 0.0), (-0.2, height))
    )
    return forms.solid(f"gentle wedge {slope:g}", points)


def lying(axis_height: float) -> np.ndarray:
    """The pose in which a body about z lies along y, its axis at a height, (4, 4)."""
    return shift(0.0, 0.0, axis_height) @ turn(X, 0.5 * math.pi)
