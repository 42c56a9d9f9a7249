"""Mass properties of solids: exact formulas, and sums of several parts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from voxshell.model.mass_properties import MassProperties

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from voxshell.robots.description import Primitive

_LEAST_MOMENT = 1e-8
"""Ratio of the smallest to the largest principal moment below which an inertia counts as singular.
A bar of 1 mm by 10 m has 1e-8."""


def weigh_primitive(primitive: Primitive, density: float) -> MassProperties:
    """Return a solid's mass properties about its center, along its axes; a plane has no mass."""
    match primitive.kind:
        case "plane":
            return MassProperties(0.0, np.zeros(3), np.zeros((3, 3)))
        case "box":
            mass = density * math.prod(primitive.sizes)
            squares = np.square(primitive.sizes) / 12.0
        case "sphere":
            (radius,) = primitive.sizes
            mass = density * 4.0 / 3.0 * math.pi * radius**3
            squares = np.full(3, radius**2 / 5.0)
        case "ellipsoid":
            mass = density * 4.0 / 3.0 * math.pi * math.prod(primitive.sizes)
            squares = np.square(primitive.sizes) / 5.0
        case "cylinder":
            radius, length = primitive.sizes
            mass = density * math.pi * radius**2 * length
            squares = np.array([radius**2 / 4.0, radius**2 / 4.0, length**2 / 12.0])
        case "capsule":
            radius, length = primitive.sizes
            return _weigh_capsule(radius, length, density)
    return MassProperties(mass, np.zeros(3), mass * np.diag(squares.sum() - squares))


def _weigh_capsule(radius: float, length: float, density: float) -> MassProperties:
    barrel = density * math.pi * radius**2 * length
    caps = density * 4.0 / 3.0 * math.pi * radius**3
    along = barrel * radius**2 / 2.0 + caps * 0.4 * radius**2
    across = barrel * (radius**2 / 4.0 + length**2 / 12.0)
    across += caps * (0.4 * radius**2 + length**2 / 4.0 + 0.375 * radius * length)
    return MassProperties(barrel + caps, np.zeros(3), np.diag([across, across, along]))


def is_sound(inertia: NDArray[np.float64]) -> bool:
    """Return whether a tensor is positive definite and safe to invert, as Bullet does."""
    moments = np.linalg.eigvalsh(inertia)
    return bool(moments[0] > _LEAST_MOMENT * moments[-1])


def bound_moments(inertia: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a tensor whose largest principal moment is at most the sum of the other two.

    A larger one is that of no body, and is reduced to the sum.
    """
    moments, axes = np.linalg.eigh(inertia)
    if moments[2] <= moments[0] + moments[1]:
        return inertia
    moments[2] = moments[0] + moments[1]
    return axes @ np.diag(moments) @ axes.T


def add_up(parts: Sequence[tuple[MassProperties, NDArray[np.float64]]]) -> MassProperties:
    """Return the sum of parts in their places; their total mass must be above 0."""
    mass = sum(matter.mass for matter, _ in parts)
    centers = [place[:3, :3] @ matter.center_of_mass + place[:3, 3] for matter, place in parts]
    masses = np.array([matter.mass for matter, _ in parts])
    center = masses @ np.array(centers) / mass
    inertia = np.zeros((3, 3))
    for (matter, place), own in zip(parts, centers, strict=True):
        lever = own - center
        inertia += place[:3, :3] @ matter.inertia @ place[:3, :3].T
        inertia += matter.mass * (lever @ lever * np.eye(3) - np.outer(lever, lever))
    return MassProperties(mass, center, inertia)
