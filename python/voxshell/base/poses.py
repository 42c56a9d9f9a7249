"""Poses from positions, quaternions, angles and axes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.base.arguments import as_floats
from voxshell.base.calls import explain_calls
from voxshell.base.pose_forms import as_quaternion, make_rigid
from voxshell.base.rotations import rotation_from_xyzw
from voxshell.base.user_warnings import doubt_degrees
from voxshell.errors import PoseError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@explain_calls
def pose(
    position: ArrayLike = (0.0, 0.0, 0.0),
    *,
    xyzw: ArrayLike | None = None,
    wxyz: ArrayLike | None = None,
    rotation: ArrayLike | None = None,
    euler: ArrayLike | None = None,
    axis_angle: tuple[ArrayLike, float] | None = None,
) -> NDArray[np.float64]:
    """Make a pose from a position and at most one rotation.

    Every function that takes a pose accepts these forms. Lengths are in meters:

    - a (4, 4) matrix, such as this function returns;
    - a position, (3,), without a rotation;
    - a position and a unit quaternion in the order x, y, z, w, (7,), as in Bullet and pybullet;
    - a pair ``(position, quaternion)`` of these, as pybullet returns.

    Functions that take many poses accept (k, 4, 4), (k, 3), (k, 7), a pair of (k, 3) and (k, 4), or
    a list of poses in any of the forms above. A single pose applies to all.

    A matrix whose rotation is orthonormal to 1e-6 stays unchanged, bit for bit. If the error is up
    to 1e-3, as after rounding to four decimals, the nearest rotation replaces it. Likewise,
    quaternions whose length is off by up to 1e-3 are normalized. Larger errors and reflections
    raise a :class:`PoseError`.

    Args:
        position: (3,), meters: the origin of the frame.
        xyzw: (4,), unit quaternion, real part last, as in Bullet, SciPy and ROS.
        wxyz: (4,), unit quaternion, real part first, as in MuJoCo and trimesh.
        rotation: (3, 3), a rotation matrix.
        euler: (3,), radians: roll, pitch and yaw, like ``rpy`` in URDF. The frame turns about the
            fixed x axis, then the fixed y axis, then the fixed z axis.
        axis_angle: An axis, (3,), of any nonzero length, and an angle about it in radians,
            counterclockwise.

    Returns:
        (4, 4) float64, ``world_from_body``, a new array.

    Raises:
        PoseError: More than one rotation is given, a number is not finite, an array has another
            shape, a quaternion is not of unit length, a matrix is no rotation, or an axis is zero.

    Warns:
        UnitWarning: An angle of ``euler`` is probably in degrees: 15, 20, 25 and so on.

    Example:
        A quarter turn about z, half a meter up:

        >>> import math
        >>> import voxshell as vx
        >>> vx.pose((0, 0, 0.5), axis_angle=((0, 0, 1), math.pi / 2)).round(6) + 0.0
        array([[ 0. , -1. ,  0. ,  0. ],
               [ 1. ,  0. ,  0. ,  0. ],
               [ 0. ,  0. ,  1. ,  0.5],
               [ 0. ,  0. ,  0. ,  1. ]])
        >>> half = math.sqrt(0.5)
        >>> bool((vx.pose(rotation=np.diag([1, -1, -1])) == np.diag([1, -1, -1, 1])).all())
        True
        >>> turned = vx.pose(euler=(0, 0, math.pi / 2))
        >>> bool(abs(turned - vx.pose(xyzw=(0, 0, half, half))).max() < 1e-15)
        True
        >>> vx.pose(xyzw=(0, 0, 0, 1), wxyz=(1, 0, 0, 0))
        Traceback (most recent call last):
        voxshell.errors.PoseError: give at most one rotation, not xyzw and wxyz
    """
    rotations = {
        "xyzw": xyzw,
        "wxyz": wxyz,
        "rotation": rotation,
        "euler": euler,
        "axis_angle": axis_angle,
    }
    given = [name for name, value in rotations.items() if value is not None]
    if len(given) > 1:
        raise PoseError(f"give at most one rotation, not {' and '.join(given)}")
    matrix = np.eye(4)
    matrix[:3, 3] = _as_finite(position, "position", 3)
    if xyzw is not None:
        x, y, z, w = as_quaternion(_as_finite(xyzw, "xyzw", 4), "xyzw")
        matrix[:3, :3] = np.reshape(rotation_from_xyzw(x, y, z, w), (3, 3))
    elif wxyz is not None:
        w, x, y, z = as_quaternion(_as_finite(wxyz, "wxyz", 4), "wxyz", "w, x, y, z")
        matrix[:3, :3] = np.reshape(rotation_from_xyzw(x, y, z, w), (3, 3))
    elif rotation is not None:
        matrix[:3, :3] = as_floats(rotation, "rotation", (3, 3), PoseError)
        matrix = make_rigid(matrix, "rotation")
    elif euler is not None:
        angles = _as_finite(euler, "euler", 3)
        doubt_degrees(angles, "euler")
        matrix[:3, :3] = _turn_by_euler(*angles)
    elif axis_angle is not None:
        matrix[:3, :3] = _turn_about(axis_angle)
    return matrix


def invert(pose: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the inverse of a rigid pose, (4, 4)."""
    inverse = np.eye(4)
    inverse[:3, :3] = pose[:3, :3].T
    inverse[:3, 3] = -pose[:3, :3].T @ pose[:3, 3]
    return inverse


def _as_finite(value: Any, name: str, count: int) -> list[float]:
    numbers: list[float] = as_floats(value, name, (count,), PoseError).tolist()
    if not all(map(math.isfinite, numbers)):
        raise PoseError(f"{name} must be finite, not {tuple(numbers)}")
    return numbers


def _turn_by_euler(roll: float, pitch: float, yaw: float) -> tuple[tuple[float, ...], ...]:
    cr, cp, cy = math.cos(roll), math.cos(pitch), math.cos(yaw)
    sr, sp, sy = math.sin(roll), math.sin(pitch), math.sin(yaw)
    return (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )


def _turn_about(axis_angle: Any) -> tuple[tuple[float, ...], ...]:
    if not isinstance(axis_angle, (tuple, list)) or len(axis_angle) != 2:
        raise PoseError(
            "axis_angle must be a pair ((x, y, z), radians); for a rotation vector v, pass (v, its length)"
        )
    x, y, z = _as_finite(axis_angle[0], "the axis of axis_angle", 3)
    [angle] = _as_finite([axis_angle[1]], "the angle of axis_angle", 1)
    largest = max(abs(x), abs(y), abs(z))
    if largest == 0.0:
        if angle == 0.0:
            return (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
        raise PoseError("the axis of axis_angle must not be zero")
    x, y, z = x / largest, y / largest, z / largest  # now squares neither underflow nor overflow
    length = math.sqrt(x * x + y * y + z * z)
    x, y, z = x / length, y / length, z / length
    c, s = math.cos(angle), math.sin(angle)
    t = 1.0 - c
    return (
        (c + t * x * x, t * x * y - s * z, t * x * z + s * y),
        (t * x * y + s * z, c + t * y * y, t * y * z - s * x),
        (t * x * z - s * y, t * y * z + s * x, c + t * z * z),
    )
