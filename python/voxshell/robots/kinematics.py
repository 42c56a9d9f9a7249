"""Places of links at positions of joints, and motions of links at velocities of joints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell.base.poses import pose as make_pose

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    from voxshell.robots.description import JointDescription


@dataclass(frozen=True, eq=False)
class Twist:
    """The motion of a rigid body.

    Attributes:
        angular: (3,) float64, rad/s, world frame.
        linear: (3,) float64, m/s, world frame, of the body's material at the world's origin, so that
            the twists of bodies add up.
    """

    angular: NDArray[np.float64]
    linear: NDArray[np.float64]

    def __add__(self, other: Twist) -> Twist:
        return Twist(self.angular + other.angular, self.linear + other.linear)

    def __sub__(self, other: Twist) -> Twist:
        return Twist(self.angular - other.angular, self.linear - other.linear)

    def linear_at(self, point: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the velocity of the material at a point, (3,) meters, world frame."""
        return self.linear + np.cross(self.angular, point)


def find_twists(
    joints: Iterable[JointDescription],
    velocities: Mapping[str, float],
    poses: Mapping[str, NDArray[np.float64]],
    twists: Mapping[str, Twist],
) -> dict[str, Twist]:
    """Return the twists of the links that move differently if joints have given velocities.

    Other joints keep their velocities, and roots their twists.

    Args:
        joints: All joints, each before those of its child.
        velocities: Rad/s or m/s, by the names of joints that turn or slide.
        poses: Present ``world_from_link``, (4, 4), by the names of links.
        twists: Present twists, likewise.
    """
    changed: dict[str, Twist] = {}
    for joint in joints:
        if joint.type == "floating":
            continue
        if joint.name in velocities:
            place = poses[joint.child] @ joint.child_from_joint
            relative = _find_relative(joint, place, velocities[joint.name])
        elif joint.parent in changed:
            relative = twists[joint.child] - twists[joint.parent]
        else:
            continue
        parent = changed.get(joint.parent, twists[joint.parent])
        changed[joint.child] = parent + relative
    return changed


def _find_relative(
    joint: JointDescription, world_from_joint: NDArray[np.float64], velocity: float
) -> Twist:
    """Return the twist of a joint's child relative to its parent, at a velocity in rad/s or m/s."""
    along = world_from_joint[:3, :3] @ joint.axis
    motion = velocity * along / np.linalg.norm(along)
    if joint.type == "prismatic":
        return Twist(np.zeros(3), motion)
    return Twist(motion, np.cross(world_from_joint[:3, 3], motion))


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
