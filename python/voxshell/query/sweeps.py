"""Time of impact of two moving bodies: swept queries."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell import _core
from voxshell.base.arguments import as_floats, as_length, as_threads, check_callable
from voxshell.base.calls import explain_calls
from voxshell.base.pose_forms import as_pose, as_pose_arrays, mend_poses
from voxshell.errors import PoseError, SettingsError
from voxshell.query.pairs import Collidable, Shell, as_margin, as_pair, as_scratch

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, Literal

    from numpy.typing import ArrayLike, NDArray

    from voxshell.query.scratch import QueryScratch


_FARTHEST_FRACTION = 1e4
"""Largest fraction that interpolate_pose accepts."""


@dataclass(frozen=True, eq=False, slots=True)
class Sweep:
    """How far two bodies move until they touch; from :func:`voxshell.sweep`.

    Attributes:
        fraction: Fraction of the motion, 0 to 1. Before it, the bodies do not touch. 1 if they
            never touch.
        touches: True if they touch at that fraction, or come within the tolerance of it.
        distance: Distance at that fraction, meters. Infinite if they never touch; then the three
            arrays that follow hold NaN.
        point_a: Contact point on a at that fraction, (3,) float64, meters, world frame.
        point_b: Contact point on b, likewise.
        normal: Unit normal, (3,) float64, world frame: from b toward a.
        shell: The body whose shell one of the points belongs to; None if they never touch.
        a_pose: ``world_from_a`` at that fraction, (4, 4) float64.
        b_pose: ``world_from_b``, likewise.
    """

    fraction: float
    touches: bool
    distance: float
    point_a: NDArray[np.float64]
    point_b: NDArray[np.float64]
    normal: NDArray[np.float64]
    shell: Literal["a", "b"] | None
    a_pose: NDArray[np.float64]
    b_pose: NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class SweepBatch:
    """How far two bodies move until they touch, in k motions; from :func:`voxshell.sweep_batch`.

    Attributes:
        fractions: (k,) float64; see :attr:`Sweep.fraction`.
        touches: (k,) bool.
        distances: (k,) float64, meters.
        points_a: (k, 3) float64, meters, world frame.
        points_b: (k, 3) float64, likewise.
        normals: (k, 3) float64.
        shells: (k,) str: "a", "b", or "" if they never touch.
        a_poses: (k, 4, 4) float64, ``world_from_a`` at these fractions.
        b_poses: (k, 4, 4) float64, likewise.
    """

    fractions: NDArray[np.float64]
    touches: NDArray[np.bool_]
    distances: NDArray[np.float64]
    points_a: NDArray[np.float64]
    points_b: NDArray[np.float64]
    normals: NDArray[np.float64]
    shells: NDArray[np.str_]
    a_poses: NDArray[np.float64]
    b_poses: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.fractions)

    def __repr__(self) -> str:
        return f"SweepBatch({len(self)} motions, {np.count_nonzero(self.touches)} of them touch)"


@explain_calls
def sweep(
    a: Collidable,
    b: Collidable,
    a_pose: ArrayLike | None = None,
    b_pose: ArrayLike | None = None,
    *,
    a_end: ArrayLike | None = None,
    b_end: ArrayLike | None = None,
    shell: Shell = "auto",
    margin: float = 0.0,
    tolerance: float | None = None,
    scratch: QueryScratch | None = None,
) -> Sweep:
    """Find how far two bodies can move until they touch: continuous collision detection.

    Each body moves from its pose to its end. The origin of its frame has a constant velocity. The
    body turns about it with a constant angular velocity, the shorter way, by up to half a turn
    (:func:`interpolate_pose`). Both bodies may move.

    Bodies touch if :func:`contacts` finds a contact. Before the returned fraction it finds none,
    however thin the bodies are and however far they move: the query skips an interval of the motion
    only if the lower bounds of the fields exclude a contact there (conservative advancement:
    Mirtich 1996). :func:`contact_bounds` states what contacts may miss of the meshes themselves.

    The longer bodies move near each other, the longer the query takes. If the clearance of a motion
    is its own length, it takes as long as a few queries; along a wall, as long as some hundred.

    Args:
        a: A :class:`Model`, or an analytic shape such as :class:`Plane` or :class:`Capsule`.
        b: Likewise. At least one of the two must be a model.
        a_pose: ``world_from_a`` at the start of the motion, in any form that :func:`pose` lists.
            None: the identity.
        b_pose: ``world_from_b``, likewise.
        a_end: ``world_from_a`` at the end of the motion, likewise. None: a does not move.
        b_end: ``world_from_b``, likewise. None: b does not move.
        shell: As for :func:`contacts`.
        margin: As for :func:`contacts`. Above 0, bodies that come this near touch; below 0, they
            may overlap by this much. If the margin reaches beyond the grid of a model's field (by
            default 16 voxels around it), bodies stop too early, by up to the width of the grid
            around the body: build models with a ``padding`` of at least the margin.
        tolerance: Meters, above 0. Bodies within this distance of touching may count as touching.
            So may those within the tolerance of the models where fields are discontinuous. Smaller
            tolerances take longer. The default is the sum of both models' tolerances; for uniform
            models, a tenth of their voxels or, if that is larger, a thousandth of the shortest side
            of the smaller body.
        scratch: Lets a series of queries reuse memory; see :class:`QueryScratch`.

    Returns:
        The fraction, the poses there, and the place where the bodies are nearest.

    Raises:
        PoseError: A pose is in no form that :func:`pose` lists, is not rigid, or is not finite.
        SettingsError: Neither body is a model, or ``shell`` names one that is not; ``margin`` is
            not finite; ``tolerance`` is not above 0.
        InputTypeError: ``a`` or ``b`` is not a body, or ``scratch`` is not a :class:`QueryScratch`.

    Example:
        A ball of radius 0.1 m falls by 2 m, from 1 m above the ground:

        >>> import numpy as np
        >>> import trimesh
        >>> import voxshell as vx
        >>> ball = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.1), voxel_size=0.01)
        >>> start, end = np.eye(4), np.eye(4)
        >>> start[2, 3], end[2, 3] = 1.0, -1.0
        >>> fall = vx.sweep(ball, vx.Plane(), start, a_end=end, tolerance=1e-4)
        >>> fall.touches, round(fall.fraction, 3), round(float(fall.a_pose[2, 3]), 3)
        (True, 0.45, 0.1)
        >>> fall.normal
        array([0., 0., 1.])

        A plate of 1 mm, turned by a quarter and moved by a meter, hits the ball that it began beside:

        >>> plate = vx.Model.from_mesh(trimesh.creation.box((0.2, 0.2, 0.001)))
        >>> start = trimesh.transformations.translation_matrix((-0.5, 0, 0))
        >>> end = trimesh.transformations.rotation_matrix(np.pi / 2, (0, 1, 0))
        >>> end[0, 3] = 0.5
        >>> vx.collide(plate, ball, start), vx.collide(plate, ball, end)
        (False, False)
        >>> vx.sweep(plate, ball, start, a_end=end).touches
        True
    """
    bodies, shells = as_pair(a, b, shell)
    try:
        found = _core.sweep(
            *bodies,
            as_pose(a_pose, "a_pose"),
            as_pose(a_end, "a_end"),
            as_pose(b_pose, "b_pose"),
            as_pose(b_end, "b_end"),
            shells,
            as_margin(margin),
            _as_tolerance(tolerance),
            as_scratch(scratch),
        )
    except PoseError as error:
        return sweep(
            a,
            b,
            **mend_poses(error, a_pose=a_pose, a_end=a_end, b_pose=b_pose, b_end=b_end),
            shell=shell,
            margin=margin,
            tolerance=tolerance,
            scratch=scratch,
        )
    fractions, distances, points_a, points_b, normals, of_shells, a_poses, b_poses = found
    whose: Literal["a", "b"] | None = None
    if of_shells[0] >= 0:
        whose = "a" if of_shells[0] == 0 else "b"
    return Sweep(
        fraction=float(fractions[0]),
        touches=whose is not None,
        distance=float(distances[0]),
        point_a=points_a[0],
        point_b=points_b[0],
        normal=normals[0],
        shell=whose,
        a_pose=a_poses[0],
        b_pose=b_poses[0],
    )


@explain_calls
def sweep_batch(
    a: Collidable,
    b: Collidable,
    a_poses: ArrayLike | None = None,
    b_poses: ArrayLike | None = None,
    *,
    a_ends: ArrayLike | None = None,
    b_ends: ArrayLike | None = None,
    shell: Shell = "auto",
    margin: float = 0.0,
    tolerance: float | None = None,
    threads: int | None = None,
    progress: Callable[[str, float], object] | None = None,
) -> SweepBatch:
    """Find how far two bodies can move in each of many motions, as :func:`sweep` does.

    For a path of k + 1 poses, its k parts are ``sweep_batch(a, b, path[:-1], a_ends=path[1:])``.
    Other Python threads continue to run. Ctrl-C stops the query.

    Args:
        a: A :class:`Model`, or an analytic shape such as :class:`Plane` or :class:`Capsule`.
        b: Likewise. At least one of the two must be a model.
        a_poses: ``world_from_a`` at the start of each motion: (k, 4, 4), (k, 3) or (k, 7) float64,
            or another form that :func:`pose` lists; a single pose applies to all. None: the
            identity.
        b_poses: ``world_from_b``, likewise.
        a_ends: ``world_from_a`` at the end of each motion, likewise. None: a does not move.
        b_ends: ``world_from_b``, likewise. None: b does not move.
        shell: As for :func:`contacts`.
        margin: As for :func:`sweep`.
        tolerance: As for :func:`sweep`.
        threads: Number of threads, up to 1024; one per CPU core by default. It does not affect the
            result.
        progress: As for :func:`contacts_batch`.

    Returns:
        The results of :func:`sweep` for each motion, in order.

    Raises:
        PoseError: A pose is in no form that :func:`pose` lists, is not rigid, or is not finite. The
            message says which.
        SettingsError: As for :func:`sweep`; or the numbers of poses differ.
        InputTypeError: ``a`` or ``b`` is not a body, or ``progress`` cannot be called.

    Example:
        >>> import numpy as np
        >>> import trimesh
        >>> import voxshell as vx
        >>> ball = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.1), voxel_size=0.01)
        >>> path = np.tile(np.eye(4), (4, 1, 1))
        >>> path[:, 2, 3] = (0.4, 0.3, 0.2, 0.0)
        >>> parts = vx.sweep_batch(ball, vx.Plane(), path[:-1], a_ends=path[1:])
        >>> parts
        SweepBatch(3 motions, 1 of them touch)
        >>> parts.fractions.round(2)
        array([1. , 1. , 0.5])
    """
    bodies, shells = as_pair(a, b, shell)
    count, (starts_a, ends_a, starts_b, ends_b) = as_pose_arrays(
        a_poses=a_poses, a_ends=a_ends, b_poses=b_poses, b_ends=b_ends
    )
    check_callable(progress, "progress")
    try:
        found = _core.sweep_batch(
            *bodies,
            count,
            starts_a,
            ends_a,
            starts_b,
            ends_b,
            shells,
            as_margin(margin),
            _as_tolerance(tolerance),
            as_threads(threads),
            progress,
        )
    except PoseError as error:
        return sweep_batch(
            a,
            b,
            **mend_poses(error, a_poses=a_poses, a_ends=a_ends, b_poses=b_poses, b_ends=b_ends),
            shell=shell,
            margin=margin,
            tolerance=tolerance,
            threads=threads,
            progress=progress,
        )
    fractions, distances, points_a, points_b, normals, of_shells, poses_a, poses_b = found
    return SweepBatch(
        fractions=fractions,
        touches=of_shells >= 0,
        distances=distances,
        points_a=points_a,
        points_b=points_b,
        normals=normals,
        shells=np.array(["a", "b", ""])[of_shells],
        a_poses=poses_a,
        b_poses=poses_b,
    )


def interpolate_pose(
    start: ArrayLike | None, end: ArrayLike | None, fractions: ArrayLike
) -> NDArray[np.float64]:
    """Return poses between two poses, on the motion that :func:`sweep` uses.

    The origin of the frame moves with a constant velocity. The body turns about it with a constant
    angular velocity, the shorter way. For exactly half a turn, the axis is the one whose first
    nonzero component is positive.

    Args:
        start: ``world_from_body`` at fraction 0, in any form that :func:`pose` lists. None: the
            identity.
        end: The pose at fraction 1, likewise.
        fractions: (k,) float64, or one number. The motion continues below 0 and above 1.

    Returns:
        (k, 4, 4) float64, or (4, 4) for one number.

    Raises:
        PoseError: A pose is in no form that :func:`pose` lists, is not rigid, or is not finite.
        SettingsError: A fraction is not finite, or farther than 10,000 from 0.

    Example:
        >>> import numpy as np
        >>> import trimesh
        >>> import voxshell as vx
        >>> end = trimesh.transformations.rotation_matrix(np.pi / 2, (0, 0, 1))
        >>> end[0, 3] = 2.0
        >>> vx.interpolate_pose(None, end, 0.5).round(3)
        array([[ 0.707, -0.707,  0.   ,  1.   ],
               [ 0.707,  0.707,  0.   ,  0.   ],
               [ 0.   ,  0.   ,  1.   ,  0.   ],
               [ 0.   ,  0.   ,  0.   ,  1.   ]])
    """
    try:
        is_one = np.ndim(fractions) == 0
    except ValueError as failure:  # rows of different lengths
        raise SettingsError(f"fractions must be (n,) numbers: {failure}") from None
    at = as_floats(np.atleast_1d(np.asarray(fractions)), "fractions", (None,))
    if not (np.abs(at) <= _FARTHEST_FRACTION).all():
        raise SettingsError(f"fractions must be within {_FARTHEST_FRACTION:g} of 0")
    try:
        poses = _core.interpolate(as_pose(start, "start"), as_pose(end, "end"), at)
    except PoseError as error:
        return interpolate_pose(**mend_poses(error, start=start, end=end), fractions=fractions)
    return poses[0] if is_one else poses


def _as_tolerance(value: Any) -> float | None:
    return None if value is None else as_length(value, "tolerance")
