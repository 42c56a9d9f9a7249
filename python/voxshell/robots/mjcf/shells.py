"""Mass and inertia of geoms that are shells of their shapes (``shellinertia``)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from voxshell.model.mass_properties import MassProperties

if TYPE_CHECKING:
    from voxshell.robots.description import Primitive

_THOMSEN = 1.6075
"""Exponent of Knud Thomsen's formula of an ellipsoid's area, which is off by at most 1.1 %."""


def weigh_shell(primitive: Primitive) -> MassProperties:
    """Return the matter of a shell of 1 kg/m2, about its center and along its axes.

    The mass in kilograms equals the area in square meters.

    As in MuJoCo, the shell of an ellipsoid is what it gains if its radii grow by the same small
    length.
    """
    match primitive.kind:
        case "sphere":
            (radius,) = primitive.sizes
            mass = 4.0 * math.pi * radius**2
            squares = np.full(3, mass * radius**2 / 3.0)
        case "box":
            sizes = np.array(primitive.sizes)
            areas = 2.0 * np.prod(sizes) / sizes  # of the two sides across each axis
            mass = float(areas.sum())
            inside = mass - areas  # of the sides that an axis lies in
            squares = sizes**2 * (areas / 4.0 + inside / 12.0)
        case "ellipsoid":
            mass, squares = _weigh_ellipsoid(np.array(primitive.sizes))
        case "cylinder":
            radius, length = primitive.sizes
            wall, lids = 2.0 * math.pi * radius * length, 2.0 * math.pi * radius**2
            mass = wall + lids
            across = radius**2 * (wall / 2.0 + lids / 4.0)
            along = length**2 * (wall / 12.0 + lids / 4.0)
            squares = np.array([across, across, along])
        case "capsule":
            radius, length = primitive.sizes
            wall, caps = 2.0 * math.pi * radius * length, 4.0 * math.pi * radius**2
            mass = wall + caps
            across = radius**2 * (wall / 2.0 + caps / 3.0)
            along = length**2 * (wall / 12.0 + caps / 4.0)
            along += caps * (radius * length / 2.0 + radius**2 / 3.0)
            squares = np.array([across, across, along])
        case _:
            mass, squares = 0.0, np.zeros(3)
    return MassProperties(mass, np.zeros(3), np.diag(squares.sum() - squares))


def _weigh_ellipsoid(radii: np.ndarray) -> tuple[float, np.ndarray]:
    """Return the area, and the integrals of x2, y2 and z2 over it."""
    faces = np.prod(radii) / radii
    mass = float(4.0 * math.pi * np.mean(faces**_THOMSEN) ** (1.0 / _THOMSEN))
    thickness = np.prod(radii) / faces.sum()  # volume over its growth
    return mass, mass * (radii**2 + 2.0 * radii * thickness) / 5.0
