"""Frames of a joint in its two bodies, and conversion of joints for the bindings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell import _bullet
from voxshell.base.arguments import as_vector
from voxshell.base.pose_forms import as_rigid_pose
from voxshell.base.poses import invert
from voxshell.errors import InputTypeError, SettingsError
from voxshell.simulation.joint_kinds import (
    FixedJoint,
    HingeJoint,
    JointKind,
    PointJoint,
    SliderJoint,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from voxshell.simulation.body import Body


@dataclass(frozen=True)
class JointFrames:
    """The frame of a joint, in one of three ways; see :meth:`World.add_joint`."""

    parent_from_joint: ArrayLike | None
    child_from_joint: ArrayLike | None
    world_from_joint: ArrayLike | None

    def resolve(
        self, parent: Body | None, child: Body
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return ``parent_from_joint`` and ``child_from_joint``, (4, 4) each.

        Raises:
            PoseError: A frame is not a pose.
            SettingsError: The frame is given in two ways.
        """
        world_from_parent = np.eye(4) if parent is None else parent.pose
        if self.world_from_joint is not None:
            if self.parent_from_joint is not None or self.child_from_joint is not None:
                raise SettingsError(
                    "give either world_from_joint, or parent_from_joint and child_from_joint, not both"
                )
            world_from_joint = as_rigid_pose(self.world_from_joint, "world_from_joint")
            return invert(world_from_parent) @ world_from_joint, invert(
                child.pose
            ) @ world_from_joint
        child_from_joint = np.eye(4)
        if self.child_from_joint is not None:
            child_from_joint = as_rigid_pose(self.child_from_joint, "child_from_joint")
        if self.parent_from_joint is None:
            return invert(world_from_parent) @ child.pose @ child_from_joint, child_from_joint
        parent_from_joint = as_rigid_pose(self.parent_from_joint, "parent_from_joint")
        return parent_from_joint, child_from_joint


def make_settings(
    kind: JointKind, parent: Body | None, child: Body, frames: JointFrames, collide: bool
) -> _bullet.JointSettings:
    """Return a joint as the bindings take it.

    Raises:
        InputTypeError: ``kind`` is not a joint.
        PoseError: A frame is not a rigid transform.
        SettingsError: The frame is given in two ways.
    """
    if not isinstance(kind, (FixedJoint, HingeJoint, SliderJoint, PointJoint)):
        raise InputTypeError(
            "joint must be a FixedJoint, HingeJoint, SliderJoint or PointJoint, not "
            f"{type(kind).__name__}"
        )
    parent_from_joint, child_from_joint = frames.resolve(parent, child)
    lower, upper = 1.0, -1.0
    friction = damping = stiffness = spring_position = armature = 0.0
    if isinstance(kind, (HingeJoint, SliderJoint)):
        # In the bindings, the axis is x.
        turn = np.eye(4)
        turn[:3, :3] = _frame_along(kind.axis)
        parent_from_joint, child_from_joint = parent_from_joint @ turn, child_from_joint @ turn
        friction, damping = float(kind.friction), float(kind.damping)
        stiffness, spring_position = float(kind.stiffness), float(kind.spring_position)
        armature = float(kind.armature)
        if kind.limits is not None:
            lower, upper = (float(limit) for limit in kind.limits)
    return _bullet.JointSettings(
        kind=kind._kind,
        parent=-1 if parent is None else parent.number,
        child=child.number,
        parent_from_joint=np.ascontiguousarray(parent_from_joint),
        child_from_joint=np.ascontiguousarray(child_from_joint),
        lower=lower,
        upper=upper,
        friction=friction,
        damping=damping,
        stiffness=stiffness,
        spring_position=spring_position,
        armature=armature,
        collides=collide,
    )


def _frame_along(axis: ArrayLike) -> NDArray[np.float64]:
    """Return a rotation whose first column is along the axis."""
    x: NDArray[np.float64] = np.array(as_vector(axis, "axis"))
    x /= np.abs(x).max()
    x /= np.linalg.norm(x)
    aside = np.eye(3)[np.abs(x).argmin()]
    y = np.cross(aside, x)
    y /= np.linalg.norm(y)
    return np.column_stack([x, y, np.cross(x, y)])
