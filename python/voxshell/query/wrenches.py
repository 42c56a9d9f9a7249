"""Force and torque between two overlapping bodies, from springs at their contacts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell import _core
from voxshell.base.arguments import as_not_negative
from voxshell.base.calls import explain_calls
from voxshell.base.pose_forms import as_pose, mend_poses
from voxshell.errors import PoseError
from voxshell.query.pairs import Collidable, Shell, as_pair, as_scratch

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from voxshell.query.scratch import QueryScratch


@dataclass(frozen=True, eq=False, slots=True)
class Wrench:
    """Force and torque on a body; from :func:`voxshell.wrench`.

    Attributes:
        force: (3,) float64, newtons, world frame.
        torque: (3,) float64, newton meters, world frame, about body a's origin.
    """

    force: NDArray[np.float64]
    torque: NDArray[np.float64]


@explain_calls
def wrench(
    a: Collidable,
    b: Collidable,
    a_pose: ArrayLike | None = None,
    b_pose: ArrayLike | None = None,
    *,
    stiffness: float,
    shell: Shell = "auto",
    scratch: QueryScratch | None = None,
) -> Wrench:
    """Compute the force and torque with which b pushes a out, as if through a layer of springs.

    The force on each penetrating point of the shell is stiffness times the area that the point
    represents times its depth, along the gradient of the field. The result is continuous in the
    poses, as haptic rendering needs: it starts from zero at the first touch and has no jumps.
    Only ``shell="fewest"`` jumps: it changes roles when the body with more points moves wholly into
    the other.

    Args:
        a: A :class:`Model`, or an analytic shape such as :class:`Plane` or :class:`Capsule`.
        b: Likewise. At least one of the two must be a model.
        a_pose: ``world_from_a`` in any form that :func:`pose` lists. None: the identity.
        b_pose: ``world_from_b``, likewise.
        stiffness: Pressure per depth, newtons per cubic meter, at least 0: the force, divided by the area
            in contact and the depth. 1e8 presses with 10 N where 1 cm2 is 1 mm deep.
        shell: As for :func:`contacts`. For both shells the result is the mean, so that area counts
            once.
        scratch: Speeds up a series of queries; see :class:`QueryScratch`.

    Returns:
        Force and torque on a. The reverse force acts on b, and the reverse torque after it is moved
        to b's origin.

    Raises:
        PoseError: A pose is in no form that :func:`pose` lists, is not rigid, or is not finite.
        SettingsError: Neither body is a model, or ``shell`` names one that is not; ``stiffness`` is
            negative or not finite.
        InputTypeError: ``a`` or ``b`` is not a body, ``stiffness`` is missing, or ``scratch`` is not a
            :class:`QueryScratch`.

    Example:
        A cube of 1 m, 1 mm deep in the ground, on springs of 1e6 N/m3:

        >>> import numpy as np
        >>> import trimesh
        >>> import voxshell as vx
        >>> cube = vx.Model.from_mesh(trimesh.creation.box(), resolution=20)
        >>> world_from_cube = np.eye(4)
        >>> world_from_cube[2, 3] = 0.499
        >>> wrench = vx.wrench(cube, vx.Plane(), world_from_cube, stiffness=1e6)
        >>> bool(abs(wrench.force[2] - 1e6 * 1.0 * 0.001) < 100)
        True
        >>> bool(np.abs(wrench.torque).max() < 1e-3)
        True
    """
    bodies, shells = as_pair(a, b, shell)
    try:
        force, torque = _core.wrench(
            *bodies,
            as_pose(a_pose, "a_pose"),
            as_pose(b_pose, "b_pose"),
            shells,
            as_not_negative(stiffness, "stiffness"),
            as_scratch(scratch),
        )
    except PoseError as error:
        mended = mend_poses(error, a_pose=a_pose, b_pose=b_pose)
        return wrench(a, b, **mended, stiffness=stiffness, shell=shell, scratch=scratch)
    return Wrench(np.array(force), np.array(torque))
