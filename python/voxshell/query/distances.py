"""How near two bodies are, or how deep in one another."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell import _core
from voxshell.base.pose_forms import as_pose, mend_poses
from voxshell.errors import PoseError
from voxshell.query.pairs import Collidable, Shell, as_margin, as_pair, as_scratch

if TYPE_CHECKING:
    from typing import Any, Literal

    from numpy.typing import ArrayLike, NDArray

    from voxshell.query.scratch import QueryScratch


@dataclass(frozen=True, eq=False, slots=True)
class Distance:
    """How near two bodies are, or how deep in one another; from :func:`voxshell.distance`.

    ``point_a - point_b == distance * normal``, but for rounding.

    Attributes:
        distance: Metres; negative: minus the deepest penetration. Infinite where nothing is nearer
            than was asked for: then the arrays hold NaN.
        point_a: Where it is measured on a, (3,) float64, metres, world frame.
        point_b: On b, likewise.
        normal: Unit normal, (3,) float64, world frame: on b, pointing towards a.
        shell: Whose shell one of the points is of; the other lies on the other's surface. None
            where nothing is that near.
    """

    distance: float
    point_a: NDArray[np.float64]
    point_b: NDArray[np.float64]
    normal: NDArray[np.float64]
    shell: Literal["a", "b"] | None


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
    """Finds how near two bodies are, and where.

    That is the smallest distance of any point of the shell from the other body's surface, so
    apart it is never less than the meshes' true distance (but for the error of a model's field),
    and more by at most sqrt(3) spacings of the shell. Where the nearest point lies beyond the grid of
    the other model's field (by default 16 voxels around it), the field is off by up to as much as the
    rim of the grid is away from the surface. Where bodies overlap the distance is negative: the deepest of the
    :func:`contacts`, bit for bit.

    Args:
        a: A :class:`Model`, or an analytic shape such as :class:`Plane` or :class:`Capsule`.
        b: Likewise. At least one of the two must be a model.
        a_pose: ``world_from_a``, (4, 4) or as :func:`pose` lists. None: the identity.
        b_pose: ``world_from_b``, likewise.
        shell: As for :func:`contacts`; of both shells the nearer, or the deeper.
        max_distance: Metres, or infinity: what is not nearer than this is not looked for, which
            saves time.
        scratch: Makes a series of queries faster; see :class:`QueryScratch`.

    Returns:
        The distance and where it is measured. Where nothing is nearer than ``max_distance``, the
        distance is infinite, and the points and the normal are NaN. Of equally near points, the
        one with the smaller id.

    Raises:
        PoseError: A pose is in no form that :func:`pose` lists, is not rigid, or is not finite.
        SettingsError: Neither body is a model, or the one that ``shell`` names is not;
            ``max_distance`` is NaN or minus infinity.
        InputTypeError: ``a`` or ``b`` is not a body, or ``scratch`` no :class:`QueryScratch`.

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
        >>> nearest.point_b.round(6) + 0.0  # the place on the ground below the ball
        array([0., 0., 0.])
        >>> vx.distance(ball, vx.Plane(), world_from_ball, max_distance=0.2).distance
        inf
        >>> round(vx.distance(ball, vx.Plane()).distance, 6)  # half of it in the ground
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


def _as_max_distance(value: Any) -> float:
    if isinstance(value, (float, np.floating)) and value == math.inf:
        return math.inf
    return as_margin(value, "max_distance")
