"""Arithmetic on rotations, entry by entry.

The functions take numbers, or arrays with one number per rotation. The results have the same bits
on every processor, because the functions only add, multiply and divide.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

Entries: TypeAlias = "tuple[Any, Any, Any, Any, Any, Any, Any, Any, Any]"
"""The entries of a 3x3 matrix, row by row: numbers, or arrays of equal shape."""

EXACT = 1e-6
"""Largest error of a rotation that stays unchanged: the core accepts it."""

CORRECTED = 1e-3
"""Largest error of a rotation or of a quaternion's length that is corrected."""

_NEWTON_STEPS = 4
"""Enough to get from CORRECTED to rounding error: each step squares the error."""


def entries_of(rotation: NDArray[np.float64]) -> Entries:
    """Return the entries of a (..., 3, 3) array."""
    rows = [rotation[..., i, j] for i in range(3) for j in range(3)]
    return tuple(rows)  # pyright: ignore[reportReturnType]


def rotation_from_xyzw(x: Any, y: Any, z: Any, w: Any) -> Entries:
    """Return the rotation of a quaternion of any nonzero length."""
    s = 2.0 / (x * x + y * y + z * z + w * w)
    xx, yy, zz = s * (x * x), s * (y * y), s * (z * z)
    xy, xz, yz = s * (x * y), s * (x * z), s * (y * z)
    wx, wy, wz = s * (w * x), s * (w * y), s * (w * z)
    return (
        1.0 - (yy + zz),
        xy - wz,
        xz + wy,
        xy + wz,
        1.0 - (xx + zz),
        yz - wx,
        xz - wy,
        yz + wx,
        1.0 - (xx + yy),
    )


def xyzw_from_rotation(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the unit quaternion, (4,), of a (3, 3) rotation, with w not negative.

    This divides by the largest of the four components (Shepperd 1978), so that no rotation loses
    precision.
    """
    a, b, c, d, e, f, g, h, i = rotation.ravel().tolist()
    squares = (1.0 + a - e - i, 1.0 - a + e - i, 1.0 - a - e + i, 1.0 + a + e + i)
    largest = squares.index(max(squares))
    x, y, z, w = (
        (squares[0], b + d, c + g, h - f),
        (b + d, squares[1], f + h, c - g),
        (c + g, f + h, squares[2], d - b),
        (h - f, c - g, d - b, squares[3]),
    )[largest]
    length = math.copysign(math.sqrt(x * x + y * y + z * z + w * w), w)
    return np.array((x, y, z, w)) / length + 0.0


def orthonormal_errors(r: Entries) -> tuple[Any, Any, Any, Any, Any, Any]:
    """Return how far the products of rows are from 1 and 0; the core uses the same measure."""
    a, b, c, d, e, f, g, h, i = r
    return (
        abs(a * a + b * b + c * c - 1.0),
        abs(d * d + e * e + f * f - 1.0),
        abs(g * g + h * h + i * i - 1.0),
        abs(a * d + b * e + c * f),
        abs(d * g + e * h + f * i),
        abs(g * a + h * b + i * c),
    )


def determinant(r: Entries) -> Any:
    """Return the determinant of a matrix."""
    a, b, c, d, e, f, g, h, i = r
    return a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g)


def nearest_rotation(r: Entries) -> Entries:
    """Return the orthogonal polar factor of a matrix whose error is at most CORRECTED.

    This is Newton's iteration (Higham 1986): average the matrix and the transpose of its inverse.
    """
    for _ in range(_NEWTON_STEPS):
        a, b, c, d, e, f, g, h, i = r
        half = 0.5 / determinant(r)
        r = (
            0.5 * a + half * (e * i - f * h),
            0.5 * b + half * (f * g - d * i),
            0.5 * c + half * (d * h - e * g),
            0.5 * d + half * (h * c - i * b),
            0.5 * e + half * (i * a - g * c),
            0.5 * f + half * (g * b - h * a),
            0.5 * g + half * (b * f - c * e),
            0.5 * h + half * (c * d - a * f),
            0.5 * i + half * (a * e - b * d),
        )
    return r
