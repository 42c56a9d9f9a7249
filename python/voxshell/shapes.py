"""Analytic shapes: exact fields that need no mesh. They have no point shell of their own."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from voxshell._arguments import FARTHEST, as_length, as_real, as_vector
from voxshell._core import box_field, plane_field, sphere_field
from voxshell.errors import SettingsError
from voxshell.field import Field

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class Plane(Field):
    """The half-space below a plane: a solid ground without an end.

    The points p on its surface satisfy ``normal . p == offset``.

    Args:
        normal: (3,), out of the solid, body frame; any length but 0, it is brought to 1.
        offset: Distance of the surface from the origin along the unit normal, metres.

    Raises:
        SettingsError: ``normal`` is zero, or a number is not finite.

    Example:
        >>> import voxshell as vx
        >>> vx.Plane(normal=(0, 0, 1), offset=0.5).sample([[3, 4, 2]])
        array([1.5])
    """

    __slots__ = ("_normal", "_offset")

    def __init__(self, normal: ArrayLike = (0.0, 0.0, 1.0), offset: float = 0.0) -> None:
        x, y, z = as_vector(normal, "normal")
        largest = max(abs(x), abs(y), abs(z))
        if largest == 0.0:
            raise SettingsError("normal must not be zero: it says which side of the plane is solid")
        # Divided twice, so that no square over- or underflows.
        x, y, z = x / largest, y / largest, z / largest
        length = math.sqrt(x * x + y * y + z * z)
        self._normal = (x / length, y / length, z / length)
        self._offset = as_real(offset, "offset")
        if abs(self._offset) > FARTHEST:
            raise SettingsError(f"offset must be within {FARTHEST:g} m, not {self._offset:g}")
        super().__init__(plane_field(self._normal, self._offset))

    @property
    def normal(self) -> NDArray[np.float64]:
        """Unit normal, out of the solid, (3,) float64, body frame."""
        return np.array(self._normal)

    @property
    def offset(self) -> float:
        """Distance of the surface from the origin along the normal, metres."""
        return self._offset

    def __repr__(self) -> str:
        return f"Plane(normal={self._normal}, offset={self._offset:g})"


class Box(Field):
    """A solid box, centred at its origin, along its axes.

    Args:
        half_extents: (3,), half of the lengths of its edges along x, y and z, metres.

    Raises:
        SettingsError: A half extent is not above 0.

    Example:
        >>> import voxshell as vx
        >>> vx.Box(half_extents=(1, 2, 3)).sample([[0, 0, 4], [0, 0, 0]])
        array([ 1., -1.])
    """

    __slots__ = ("_half_extents",)

    def __init__(self, half_extents: ArrayLike) -> None:
        x, y, z = as_vector(half_extents, "half_extents")
        self._half_extents = (
            as_length(x, "half_extents[0]"),
            as_length(y, "half_extents[1]"),
            as_length(z, "half_extents[2]"),
        )
        super().__init__(box_field(self._half_extents))

    @property
    def half_extents(self) -> NDArray[np.float64]:
        """Half of the edges along x, y and z, (3,) float64, metres."""
        return np.array(self._half_extents)

    def __repr__(self) -> str:
        return f"Box(half_extents={self._half_extents})"


class Sphere(Field):
    """A solid sphere, centred at its origin.

    Args:
        radius: Metres.

    Raises:
        SettingsError: ``radius`` is not above 0.

    Example:
        >>> import voxshell as vx
        >>> vx.Sphere(radius=0.5).gradient([[0, -2, 0]])
        array([[ 0., -1.,  0.]])
    """

    __slots__ = ("_radius",)

    def __init__(self, radius: float) -> None:
        self._radius = as_length(radius, "radius")
        super().__init__(sphere_field(self._radius))

    @property
    def radius(self) -> float:
        """Metres."""
        return self._radius

    def __repr__(self) -> str:
        return f"Sphere(radius={self._radius:g})"
