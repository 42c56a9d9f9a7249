"""Conversion of the forms of poses that voxshell.pose() lists to 4x4 matrices."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.base.arguments import FARTHEST, as_floats, show_array, show_value, within_memory
from voxshell.base.rotations import (
    CORRECTED,
    EXACT,
    determinant,
    entries_of,
    nearest_rotation,
    orthonormal_errors,
    rotation_from_xyzw,
)
from voxshell.errors import PoseError, SettingsError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_FLOAT64 = np.dtype(np.float64)
_ARRAY = np.ndarray
_MATRIX, _POSITION, _SEVEN, _QUATERNION = (4, 4), (3,), (7,), (4,)
_LAST_ROW = (0.0, 0.0, 0.0, 1.0)
_FORMS = (
    "a (4, 4) matrix, a position (3,), a position and a quaternion x, y, z, w in one array (7,), or a pair "
    "(position, quaternion)"
)
_ANGLES = "; for a position and angles in radians, call voxshell.pose(position, euler=...)"
_MANY_FORMS = "(k, 4, 4), (k, 3) or (k, 7) numbers, a pair of (k, 3) and (k, 4), or one pose"


def as_pose(value: ArrayLike | None, name: str) -> NDArray[np.float64] | None:
    """Return a 4x4 array, or None. The core checks that it is a rigid transform."""
    # The most frequent case takes 1 us less this way. The core takes arrays of any memory order.
    if type(value) is _ARRAY and value.dtype is _FLOAT64 and value.shape == _MATRIX:
        return value
    return None if value is None else read_pose(value, name)


def as_rigid_pose(value: ArrayLike, name: str) -> NDArray[np.float64]:
    """Return a 4x4 array that the core accepts: finite, rigid, and not too far away.

    Raises:
        PoseError: The value is not a pose, or its rotation is not orthonormal to within 1e-3.
    """
    pose = as_pose(value, name)
    if pose is None:
        raise PoseError(f"{name} must be {_FORMS}, not None")
    return make_rigid(pose, name)


def as_pose_arrays(**values: Any) -> tuple[int, list[NDArray[np.float64] | None]]:
    """Return the number of poses and their (count, 4, 4) arrays, in the order of the arguments.

    An array of (1, 4, 4), made of a single pose, applies to all; so does None, which means the
    identity.
    """
    arrays: list[NDArray[np.float64] | None] = []
    counts: dict[str, int] = {}
    for name, value in values.items():
        if value is None:
            arrays.append(None)
            continue
        poses = read_poses(value, name)
        arrays.append(poses.reshape(-1, 4, 4))
        if poses.ndim == 3:
            counts[name] = len(poses)
    if len(set(counts.values())) > 1:
        raise SettingsError(
            f"{' and '.join(counts)} must have the same number of poses, or be single poses; they have "
            f"{' and '.join(map(str, counts.values()))}"
        )
    return next(iter(counts.values()), 1), arrays


def mend_poses(error: PoseError, **values: Any) -> dict[str, NDArray[np.float64] | None]:
    """Return the poses that the core has refused, with their rotations made orthonormal.

    Queries pass poses to the core unchecked, because a check in Python would take as long as a
    query.

    Args:
        error: The core's error.
        **values: The caller's poses by argument name, one or many each.

    Raises:
        PoseError: A pose is too far from rigid. If all poses are rigid, this is the core's error.
    """
    mended: dict[str, NDArray[np.float64] | None] = {}
    changed, is_batch = False, "a_poses" in values
    try:
        for name, value in values.items():
            if value is None:
                mended[name] = None
                continue
            given = read_poses(value, name) if is_batch else read_pose(value, name)
            exact = make_rigid(given, name) if given.ndim == 2 else make_all_rigid(given, name)
            changed |= exact is not given
            mended[name] = exact
    except PoseError as better:
        raise better from None  # it names the pose, and says all that the core's error does
    if not changed:
        raise error
    return mended


@within_memory
def read_pose(value: ArrayLike, name: str) -> NDArray[np.float64]:
    """Return the (4, 4) matrix of a single pose in any form; a matrix is returned unchecked."""
    pair = _as_pair(value)
    if pair is not None and pair[0].ndim == 1:
        return _make_pose(pair[0].tolist(), pair[1].tolist(), name)
    array = _as_array(value, name, _FORMS)
    if array.shape == _MATRIX:
        return array
    if array.shape == _POSITION:
        return _make_pose(array.tolist(), None, name)
    if array.shape == _SEVEN:
        numbers = array.tolist()
        return _make_pose(numbers[:3], numbers[3:], name)
    hint = {
        (3, 3): "; for a rotation alone, call voxshell.pose(rotation=...)",
        (3, 4): "; append the row 0, 0, 0, 1",
        (16,): "; reshape it to (4, 4)",
        (4,): "; for a rotation alone, call voxshell.pose(xyzw=...)",
        (6,): _ANGLES,
        (2, 3): _ANGLES,
        (1, 3): "; reshape it to (3,)",
        (3, 1): "; reshape it to (3,)",
    }.get(array.shape, "")
    if array.ndim == 3 and array.shape[1:] == _MATRIX:
        batches = "contacts_batch(), collide_batch() or distance_batch()"
        hint = f"; for many poses, call {batches}, or pass one after the other"
    raise PoseError(f"{name} must be {_FORMS}, not {show_array(array)}{hint}")


@within_memory
def read_poses(value: Any, name: str) -> NDArray[np.float64]:
    """Return (k, 4, 4) for many poses, (4, 4) for one, in any form; matrices are unchecked."""
    pair = _as_pair(value)
    if pair is not None:
        if pair[0].ndim == 1:
            return read_pose(value, name)
        return _make_poses(pair[0], pair[1], name)
    try:
        np.asarray(value)
    except (TypeError, ValueError):
        # The list mixes forms, or its items are not arrays.
        return np.array([read_pose(pose, f"{name}[{i}]") for i, pose in enumerate(value)])
    array = _as_array(value, name, _MANY_FORMS)
    if array.shape in (_MATRIX, _POSITION, _SEVEN):
        return read_pose(array, name)
    if array.ndim == 3 and array.shape[1:] == _MATRIX:
        return array
    if array.ndim == 2 and array.shape[1:] == _POSITION:
        return _make_poses(array, None, name)
    if array.ndim == 2 and array.shape[1:] == _SEVEN:
        return _make_poses(array[:, :3], array[:, 3:], name)
    raise PoseError(f"{name} must be {_MANY_FORMS}, not {show_array(array)}")


def make_rigid(pose: NDArray[np.float64], name: str) -> NDArray[np.float64]:
    """Return a pose with an orthonormal rotation: the same array if it is so to 1e-6, or a new one.

    Raises:
        PoseError: It is off by more than 1e-3, mirrors, is not finite, or is too far from the
            origin.
    """
    a, b, c, x, d, e, f, y, g, h, i, z, *last = pose.ravel().tolist()
    rotation = (a, b, c, d, e, f, g, h, i)
    if not all(map(math.isfinite, (*rotation, x, y, z, *last))):
        raise PoseError(f"{name}: an entry is not finite")
    row_error = max(abs(have - want) for have, want in zip(last, _LAST_ROW, strict=True))
    if row_error > EXACT:
        is_transposed = (x, y, z) == (0.0, 0.0, 0.0) and last[3] == 1.0
        advice = (
            "this matrix is transposed, so pass pose.T"
            if is_transposed
            else "pass a rigid, row-major world_from_body matrix"
        )
        raise PoseError(
            f"{name}: the last row must be 0, 0, 0, 1, and is off by {row_error:.3g}; {advice}"
        )
    off = max(orthonormal_errors(rotation))
    mirrors = determinant(rotation) < 0.0
    if off > CORRECTED:
        raise PoseError(
            f"{name}: the rotation is not orthonormal (error {off:.3g}, at most {CORRECTED:g})"
            f"{' and mirrors' if mirrors else ''}; scale the mesh, not the pose, or make the pose with "
            "voxshell.pose()"
        )
    if mirrors:
        raise PoseError(
            f"{name}: it mirrors (its rotation has determinant -1); mirror the mesh, not the pose"
        )
    farthest = max(abs(x), abs(y), abs(z))
    if farthest > FARTHEST:
        raise PoseError(f"{name}: it is {farthest:.3g} m from its origin, beyond {FARTHEST:.0e} m")
    if off <= EXACT:
        return pose
    return _assemble((x, y, z), nearest_rotation(rotation))


def make_all_rigid(poses: NDArray[np.float64], name: str) -> NDArray[np.float64]:
    """Apply :func:`make_rigid` to (k, 4, 4); return the same array if all are orthonormal already.

    Raises:
        PoseError: As for :func:`make_rigid`; the message says which pose.
    """
    rotations = entries_of(poses[:, :3, :3])
    with np.errstate(all="ignore"):
        off = np.max(orthonormal_errors(rotations), axis=0, initial=0.0)
        rows = np.abs(poses[:, 3] - _LAST_ROW).max(axis=1, initial=0.0)
        reach = np.abs(poses[:, :3, 3]).max(axis=1, initial=0.0)
        sound = (
            (off <= CORRECTED)
            & (determinant(rotations) > 0.0)
            & (rows <= EXACT)
            & (reach <= FARTHEST)
        )
    for index in np.flatnonzero(~sound):  # the first one that is too far off raises
        make_rigid(poses[index], f"{name}[{index}]")
    wrong = np.flatnonzero(off > EXACT)
    if not len(wrong):
        return poses
    exact = poses.copy()
    turns = nearest_rotation(entries_of(poses[wrong, :3, :3]))
    exact[wrong, :3, :3] = np.stack(turns, axis=-1).reshape(-1, 3, 3)
    return exact


def as_quaternion(numbers: list[float], name: str, order: str = "x, y, z, w") -> list[float]:
    """Return four finite numbers whose length is 1 to within 1e-3.

    Raises:
        PoseError: They are not finite or not of unit length.
    """
    if not all(map(math.isfinite, numbers)):
        raise PoseError(f"{name}: the quaternion has an entry that is not finite")
    length = math.hypot(*numbers)
    if abs(length - 1.0) > CORRECTED:
        raise PoseError(
            f"{name}: the quaternion ({order}) has the length {length:.6g} instead of 1; divide it by its "
            f"length (errors of up to {CORRECTED:g} are corrected)"
        )
    return numbers


def _make_pose(
    position: list[float], quaternion: list[float] | None, name: str
) -> NDArray[np.float64]:
    if not all(map(math.isfinite, position)):
        raise PoseError(f"{name}: the position has an entry that is not finite")
    if quaternion is None:
        return _assemble(position, (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0))
    return _assemble(position, rotation_from_xyzw(*as_quaternion(quaternion, name)))


def _make_poses(
    positions: NDArray[np.float64], quaternions: NDArray[np.float64] | None, name: str
) -> NDArray[np.float64]:
    poses = np.zeros((len(positions), 4, 4))
    poses[:] = np.eye(4)
    poses[:, :3, 3] = positions
    if quaternions is None:
        return poses
    lengths = np.sqrt(np.square(quaternions).sum(axis=1))
    for index in np.flatnonzero(~(np.abs(lengths - 1.0) <= CORRECTED)):
        as_quaternion(quaternions[index].tolist(), f"{name}[{index}]")
    turns = rotation_from_xyzw(*np.ascontiguousarray(quaternions.T))
    poses[:, :3, :3] = np.stack(turns, axis=-1).reshape(-1, 3, 3)
    return poses


def _assemble(position: Any, rotation: Any) -> NDArray[np.float64]:
    a, b, c, d, e, f, g, h, i = rotation
    x, y, z = position
    return np.array(((a, b, c, x), (d, e, f, y), (g, h, i, z), _LAST_ROW), np.float64)


def _as_pair(value: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Return position and quaternion of a pair, (3,) and (4,) or (k, 3) and (k, 4), else None."""
    if not isinstance(value, (tuple, list)) or len(value) != 2:
        return None
    try:
        first, second = np.asarray(value[0]), np.asarray(value[1])
    except (TypeError, ValueError):
        return None
    if first.dtype.kind not in "fiu" or second.dtype.kind not in "fiu":
        return None
    if first.shape[-1:] != _POSITION or second.shape[-1:] != _QUATERNION:
        return None
    if first.ndim not in (1, 2) or first.shape[:-1] != second.shape[:-1]:
        return None
    return first.astype(np.float64), second.astype(np.float64)


def _as_array(value: Any, name: str, forms: str) -> NDArray[np.float64]:
    """Return a float64 array of any shape."""
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):
        hint = _advise_on_transform(value)
        if isinstance(value, (tuple, list)) and len(value) == 2 and np.shape(value[1]) == (3, 3):
            hint = "; for a position and a matrix, call voxshell.pose(position, rotation=...)"
        raise PoseError(f"{name} must be {forms}, not {show_value(value)}{hint}") from None
    if array.dtype.kind not in "fiu" or array.ndim == 0:
        raise PoseError(
            f"{name} must be {forms}, not {show_array(array)}{_advise_on_transform(value)}"
        )
    return as_floats(array, name, (None,) * array.ndim, PoseError)


def _advise_on_transform(value: Any) -> str:
    """Return how to pass what scipy calls a rotation or a rigid transform; "" for anything else."""
    last = value[1] if isinstance(value, (tuple, list)) and len(value) == 2 else value
    if not hasattr(last, "as_matrix"):
        return ""
    if hasattr(last, "translation"):
        return "; pass the matrix that its as_matrix() returns"
    return "; call voxshell.pose(position, xyzw=rotation.as_quat())"
