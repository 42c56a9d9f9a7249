"""Bodies that only scenes of limits have: closed meshes."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from voxshell_studies.scenes.everyday.scene import Form
from voxshell_studies.scenes.solids import as_mesh, import_manifold

if TYPE_CHECKING:
    from collections.abc import Iterable

Point = tuple[float, float]

_X_Y_Z_FROM_PROFILE = ((0.0, 0.0, 1.0, 0.0), (1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0))
"""A profile's plane becomes that of y and z, and the extrusion goes along x."""


def extrude(points: Iterable[Point], length: float) -> Any:
    """Return the solid whose section across x is a polygon of (y, z), its middle at x = 0.

    The polygon goes counterclockwise, seen along -x.
    """
    solids = import_manifold()
    section = solids.CrossSection([np.array(list(points))])
    solid = solids.Manifold.extrude(section, length).translate((0.0, 0.0, -0.5 * length))
    return solid.transform(_X_Y_Z_FROM_PROFILE)


@cache
def profile(name: str, points: tuple[Point, ...], length: float) -> Form:
    """A body with the section of :func:`extrude`."""
    return Form(f"{name} {length:g}", as_mesh(extrude(points, length)))


@cache
def half_pipe(radius: float, length: float, facets: float, phase: float = 0.0) -> Form:
    """A block with a half-round groove along x whose axis goes through the origin.

    Args:
        radius: Of the circle on which the edges are, meters.
        length: Meters.
        facets: Number of facets of a full turn.
        phase: Angle by which the facets are turned, as a fraction of a facet.
    """
    step = 2.0 * math.pi / facets
    first = -math.pi + step * (phase % 1.0)
    angles = [first + step * i for i in range(round(0.5 * facets)) if first + step * i < 0.0]
    inner = [(radius * math.cos(a), radius * math.sin(a)) for a in (-math.pi, *angles, 0.0)]
    wide = 1.5 * radius
    points = (*dict.fromkeys(inner), (wide, 0.0), (wide, -wide), (-wide, -wide), (-wide, 0.0))
    return profile(f"half-pipe {radius:g} {facets:g} {phase:.4f}", points[::-1], length)


@cache
def waves(height: float, wave_length: float, length: float, facet: float) -> Form:
    """Ground along x from x = 0 whose upper face is height * sin(2 pi x / wave_length).

    Args:
        height: Meters.
        wave_length: Meters.
        length: Of the ground, meters; it begins 0.3 m before x = 0.
        facet: Length of a facet along x, meters.
    """
    x = np.linspace(-0.3, length, round((length + 0.3) / facet) + 1)
    top = height * np.sin(2.0 * np.pi * x / wave_length)
    points = [(-0.3, -0.1), (length, -0.1), *zip(x[::-1].tolist(), top[::-1].tolist(), strict=True)]
    # The extrusion's y becomes x here.
    body = extrude(points, 0.3).transform(
        ((0.0, 1.0, 0.0, 0.0), (-1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0))
    )
    return Form(f"waves {height:g} {wave_length:g} {length:g} {facet:g}", as_mesh(body))


@cache
def faceted_bowl(radius: float, segments: int) -> Form:
    """Half a hollow ball, open above, with facets that bend by 360 degrees / segments."""
    solids = import_manifold()
    ball = solids.Manifold.sphere(1.1 * radius, segments)
    hole = solids.Manifold.sphere(radius, segments)
    lid = solids.Manifold.cube((3 * radius, 3 * radius, 3 * radius), True)
    return Form(
        f"bowl {radius:g} {segments}", as_mesh(ball - hole - lid.translate((0, 0, 1.5 * radius)))
    )


@cache
def round_channel(radius: float, half_width: float, segments: int) -> Form:
    """A ring with a U-shaped channel, open above, that leads in a level circle about z.

    Args:
        radius: Of the channel's middle, meters.
        half_width: Of the channel, meters; its floor is at z = 0.
        segments: Of a full turn.
    """
    wall, high, low = 0.005, 2.5 * half_width, -0.005
    inner, outer = radius - half_width, radius + half_width
    section = [
        *((inner - wall, low), (outer + wall, low), (outer + wall, high), (outer, high)),
        *((outer, 0.0), (inner, 0.0), (inner, high), (inner - wall, high)),
    ]
    solids = import_manifold()
    ring = solids.Manifold.revolve(solids.CrossSection([np.array(section)]), segments)
    return Form(f"channel {radius:g} {half_width:g} {segments}", as_mesh(ring))
