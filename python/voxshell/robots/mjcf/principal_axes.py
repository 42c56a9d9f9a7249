"""Principal axes of inertia, in the order and with the signs that MuJoCo gives them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from voxshell.base.poses import pose as make_pose

if TYPE_CHECKING:
    from numpy.typing import NDArray

_MOST_TURNS = 500
_SMALL = 1e-12
"""Fraction of the trace below which a product of inertia, or a difference of moments, is zero."""


def find_principal_axes(
    inertia: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the principal moments, largest first, and their axes as columns of a rotation.

    Jacobi's method begins at the given axes, so that the result is near to them, as in MuJoCo. Links that
    are aligned with their axes depend on this choice.

    Args:
        inertia: (3, 3), symmetric.
    """
    least = _SMALL * float(np.trace(inertia))
    axes = np.eye(3)
    for _ in range(_MOST_TURNS):
        turned = axes.T @ inertia @ axes
        xy, xz, yz = abs(turned[0, 1]), abs(turned[0, 2]), abs(turned[1, 2])
        row, column, axis = (0, 1, 2) if xy > max(xz, yz) else (0, 2, 1) if xz > yz else (1, 2, 0)
        product = turned[row, column]
        if abs(product) <= least:
            break
        ratio = (turned[column, column] - turned[row, row]) / (2.0 * product)
        tangent = math.copysign(1.0 / (abs(ratio) + math.hypot(1.0, ratio)), ratio)
        if ratio == 0.0:
            tangent = 1.0
        angle = math.atan(tangent)
        axes = axes @ _turn_about(axis, angle if axis == 1 else -angle)
    moments = np.diag(axes.T @ inertia @ axes).copy()
    for index in (0, 1, 0):
        if moments[index] + least < moments[index + 1]:
            moments[[index, index + 1]] = moments[[index + 1, index]]
            axes = axes @ _turn_about((index + 2) % 3, math.pi / 2.0)
    return moments, axes


def _turn_about(axis: int, angle: float) -> NDArray[np.float64]:
    return make_pose(axis_angle=(np.eye(3)[axis], angle))[:3, :3]
