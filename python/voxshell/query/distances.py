"""Distance between two bodies, or depth of their overlap, in one pose or many."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell import _core
from voxshell.base.arguments import as_threads, check_callable
from voxshell.base.calls import explain_calls
from voxshell.base.pose_forms import as_pose, as_pose_arrays, mend_poses
from voxshell.errors import PoseError
from voxshell.query.pairs import Collidable, Shell, as_margin, as_pair, as_scratch

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, Literal

    from numpy.typing import ArrayLike, NDArray

    from voxshell.query.scratch import QueryScratch


@dataclass(frozen=True, eq=False, slots=True)
class Distance:
    """Distance between two bodies, or depth of their overlap; from :func:`voxshell.distance`.

    ``point_a - point_b == distance * normal`` up to rounding.

    Attributes:
        distance: Meters. If bodies overlap, minus the largest depth. Infinite if the bodies are not
            nearer than ``max_distance``; then the arrays hold NaN.
        point_a: Witness point on a, (3,) float64, meters, world frame.
        point_b: Witness point on b, likewise.
        normal: Unit normal, (3,) float64, world frame: from b toward a.
        shell: The body whose shell one witness point belongs to; the other witness point lies on
            the other body's surface. None if the bodies are not nearer than ``max_distance``.
    """

    distance: float
    point_a: NDArray[np.float64]
    point_b: NDArray[np.float64]
    normal: NDArray[np.float64]
    shell: Literal["a", "b"] | None


@explain_calls
def distance(
    a: Collidable,
    b: Collidable,
    a_pose: ArrayLike | None = None,
    b_pose: ArrayLike | None = None,
    *,
    shell: Shell = "auto",
    max_distance: float = math.inf,
    scratch: QueryScratch | None = None,
) -> Distance:
    """Find the distance between two bodies, and where they are nearest to each other.

    This is the smallest distance of any shell element from the other body's surface. Apart from the
    error of a model's field, it is never less than the true distance of the meshes, and exceeds it
    by at most sqrt(3) spacings of the shell. If bodies overlap, the distance is minus the depth of
    the deepest of the :func:`contacts`, bit for bit.

    Outside the grid of a model's field (by default 16 voxels around the model), distances are
    estimates. Take a shell point, the place of the grid nearest to it, their distance r, and the
    distance D of that place from the surface, which :meth:`DistanceField.sample` returns. The true
    distance of the shell point and the estimate both lie between sqrt(r² + D²) and r + D, apart from
    the error of D. Therefore the error of the estimate is less than r and less than D. It does not
    grow with the distance of the bodies. Analytic shapes have no grid and are exact everywhere.

    Args:
        a: A :class:`Model`, or an analytic shape such as :class:`Plane` or :class:`Capsule`.
        b: Likewise. At least one of the two must be a model.
        a_pose: ``world_from_a`` in any form that :func:`pose` lists. None: the identity.
        b_pose: ``world_from_b``, likewise.
        shell: As for :func:`contacts`; for both shells, the smaller distance counts.
        max_distance: Meters, or infinity. The query saves time by ignoring everything that is
            farther away.
        scratch: Speeds up a series of queries; see :class:`QueryScratch`.

    Returns:
        The distance and its witness points. If nothing is nearer than ``max_distance``, the
        distance is infinite, and points and normal are NaN. Among equally near points, the one with
        the smaller id counts.

    Raises:
        PoseError: A pose is in no form that :func:`pose` lists, is not rigid, or is not finite.
        SettingsError: Neither body is a model, or ``shell`` names one that is not; ``max_distance``
            is NaN or minus infinity.
        InputTypeError: ``a`` or ``b`` is not a body, or ``scratch`` is not a :class:`QueryScratch`.

    Example:
        >>> import numpy as np
        >>> import trimesh
        >>> import voxshell as vx
        >>> ball = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.1), voxel_size=0.01)
        >>> world_from_ball = np.eye(4)
        >>> world_from_ball[2, 3] = 0.35
        >>> nearest = vx.distance(ball, vx.Plane(), world_from_ball)
        >>> round(nearest.distance, 6)
        0.25
        >>> nearest.point_b.round(6) + 0.0  # the point on the ground below the ball
        array([0., 0., 0.])
        >>> vx.distance(ball, vx.Plane(), world_from_ball, max_distance=0.2).distance
        inf
        >>> round(vx.distance(ball, vx.Plane()).distance, 6)  # half of the ball is in the ground
        -0.1
    """
    bodies, shells = as_pair(a, b, shell)
    try:
        found = _core.distance(
            *bodies,
            as_pose(a_pose, "a_pose"),
            as_pose(b_pose, "b_pose"),
            shells,
            _as_max_distance(max_distance),
            as_scratch(scratch),
        )
    except PoseError as error:
        mended = mend_poses(error, a_pose=a_pose, b_pose=b_pose)
        return distance(a, b, **mended, shell=shell, max_distance=max_distance, scratch=scratch)
    if found is None:
        return Distance(math.inf, *(np.full(3, math.nan) for _ in range(3)), shell=None)
    value, point_a, point_b, normal, shell_is_a = found
    return Distance(
        value,
        np.array(point_a),
        np.array(point_b),
        np.array(normal),
        shell="a" if shell_is_a else "b",
    )


@explain_calls
def distance_batch(
    a: Collidable,
    b: Collidable,
    a_poses: ArrayLike | None = None,
    b_poses: ArrayLike | None = None,
    *,
    shell: Shell = "auto",
    max_distance: float = math.inf,
    threads: int | None = None,
    progress: Callable[[str, float], object] | None = None,
) -> NDArray[np.float64]:
    """Find the distance between two bodies in each of many poses, as :func:`distance` does.

    Other Python threads continue to run. Ctrl-C stops the query.

    Args:
        a: A :class:`Model`, or an analytic shape such as :class:`Plane` or :class:`Capsule`.
        b: Likewise. At least one of the two must be a model.
        a_poses: As for :func:`contacts_batch`.
        b_poses: As for :func:`contacts_batch`.
        shell: As for :func:`contacts`.
        max_distance: As for :func:`distance`.
        threads: Number of threads, up to 1024; one per CPU core by default. It does not affect the
            result.
        progress: As for :func:`contacts_batch`.

    Returns:
        (k,) float64, meters: the distances, with the same bits that :func:`distance` returns. Minus
        the largest depth where bodies overlap, infinite where they are not nearer than
        ``max_distance``.

    Raises:
        PoseError: A pose is in no form that :func:`pose` lists, is not rigid, or is not finite. The
            message says which.
        SettingsError: As for :func:`distance`; or the numbers of poses differ.
        InputTypeError: ``a`` or ``b`` is not a body.

    Example:
        >>> import numpy as np
        >>> import trimesh
        >>> import voxshell as vx
        >>> ball = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.1), voxel_size=0.01)
        >>> world_from_ball = np.tile(np.eye(4), (3, 1, 1))
        >>> world_from_ball[:, 2, 3] = (0.35, 0.15, 0.05)
        >>> vx.distance_batch(ball, vx.Plane(), world_from_ball).round(4)
        array([ 0.25,  0.05, -0.05])
    """
    count, (of_a, of_b) = as_pose_arrays(a_poses=a_poses, b_poses=b_poses)
    bodies, shells = as_pair(a, b, shell)
    check_callable(progress, "progress")
    try:
        return _core.distance_batch(
            *bodies,
            count,
            of_a,
            of_b,
            shells,
            _as_max_distance(max_distance),
            as_threads(threads),
            progress,
        )
    except PoseError as error:
        return distance_batch(
            a,
            b,
            **mend_poses(error, a_poses=a_poses, b_poses=b_poses),
            shell=shell,
            max_distance=max_distance,
            threads=threads,
            progress=progress,
        )


def _as_max_distance(value: Any) -> float:
    if isinstance(value, (float, np.floating)) and value == math.inf:
        return math.inf
    return as_margin(value, "max_distance")
