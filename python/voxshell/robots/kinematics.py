"""Places of links at positions of joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from voxshell.base.poses import pose as make_pose

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.robots.description import JointDescription


def find_child(joint: JointDescription, position: float) -> NDArray[np.float64]:
    """Return ``parent_from_child``, (4, 4), with a joint at a position, radians or meters."""
    if position == joint.position:
        return joint.parent_from_child
    frame = joint.child_from_joint
    moved = joint.parent_from_child @ frame @ move_along(joint, position - joint.position)
    return moved @ np.linalg.inv(frame)


def move_along(joint: JointDescription, distance: float) -> NDArray[np.float64]:
    """Return the motion of a joint in its frame, (4, 4), if its position grows by a distance."""
    if joint.type != "prismatic":
        return make_pose(axis_angle=(joint.axis, distance))
    return make_pose(distance * np.array(joint.axis) / np.linalg.norm(joint.axis))
