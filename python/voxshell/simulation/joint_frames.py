"""Frames of a joint in its two bodies, and conversion of joints for the bindings."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell import _bullet
from voxshell.base.arguments import as_vector
from voxshell.base.pose_forms import as_rigid_pose
from voxshell.base.poses import invert
from voxshell.base.user_warnings import warn_user
from voxshell.errors import InputTypeError, SettingsError
from voxshell.model.accuracy import AccuracyWarning
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

# Joints of files are rounded. Bodies that begin farther off jump visibly.
_MOST_ANGLE = 0.02  # radians
_MOST_OFF = 0.02  # radii of gyration


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
        world_from_parent = _pose_of(parent)
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
) -> tuple[_bullet.JointSettings, tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Return a joint as the bindings take it, and its frames in parent and child; the axis is x.

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
    _doubt_start(kind, parent, child, parent_from_joint, child_from_joint)
    settings = _bullet.JointSettings(
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
    return settings, (parent_from_joint, child_from_joint)


def _pose_of(parent: Body | None) -> NDArray[np.float64]:
    """Return a parent's pose in the world, (4, 4). No parent is the world."""
    return np.eye(4) if parent is None else parent.pose


def _doubt_start(
    kind: JointKind,
    parent: Body | None,
    child: Body,
    parent_from_joint: NDArray[np.float64],
    child_from_joint: NDArray[np.float64],
) -> None:
    """Warn of bodies that begin where the joint does not let them be. The axis is x."""
    of_parent = _pose_of(parent) @ parent_from_joint
    of_child = child.pose @ child_from_joint
    axis = of_parent[:3, 0]
    off = of_child[:3, 3] - of_parent[:3, 3]
    if isinstance(kind, SliderJoint):
        off = off - (off @ axis) * axis
    turn = of_parent[:3, :3].T @ of_child[:3, :3]
    if isinstance(kind, HingeJoint):
        angle = math.atan2(math.hypot(turn[1, 0], turn[2, 0]), turn[0, 0])
    elif isinstance(kind, PointJoint):
        angle = 0.0
    else:
        sine = 0.5 * np.linalg.norm((turn - turn.T)[[0, 0, 1], [1, 2, 2]])
        angle = math.atan2(sine, 0.5 * (np.trace(turn) - 1.0))
    moved = child
    if parent is not None and child.motion != "dynamic":
        moved = parent
    gyration = math.sqrt(np.trace(moved.inertia) / (2.0 * moved.mass))
    distance = float(np.linalg.norm(off))
    if angle <= _MOST_ANGLE and distance <= _MOST_OFF * gyration:
        return
    warn_user(
        f"the frames of the joint in its two bodies begin {np.degrees(angle):.3g} degrees and "
        f"{distance:.3g} m apart where it cannot move, so the bodies will jump: move one of them, or "
        "pass child_from_joint, or world_from_joint alone",
        AccuracyWarning,
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
