"""Settings of a scene file's joints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from voxshell.base.arguments import as_not_negative, as_positive, as_real
from voxshell.errors import SettingsError
from voxshell.scenes.scene_settings import check_vector
from voxshell.simulation.joint_kinds import FixedJoint, HingeJoint, PointJoint, SliderJoint

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.scenes.body_settings import BodySettings
    from voxshell.simulation.joint_kinds import JointKind

_OF_AN_AXIS = (
    "axis",
    "limits",
    "friction",
    "damping",
    "stiffness",
    "spring_position",
    "armature",
    "target_velocity",
    "target_position",
)


@dataclass(frozen=True)
class JointSettings:
    """A table ``[joints.NAME]``: a joint between a body and another, or the world.

    Attributes:
        kind: The kind of joint, by its degrees of freedom: none, rotation about an axis,
            translation along it, or rotation about a point.
        child: Name of a body.
        parent: Name of another body; the world by default.
        position: The joint's position at the start, three numbers, meters, world frame; the child's
            origin by default.
        axis: Of a hinge or slider, three numbers, world frame at the start.
        limits: Lowest and highest position of a hinge, radians, or slider, meters; 0 is the start.
        friction, damping, stiffness, spring_position, armature: As for
            :class:`voxshell.HingeJoint` and :class:`voxshell.SliderJoint`.
        target_velocity: Velocity of the motor, rad/s or m/s.
        target_position: Alternative to it: position that the motor holds, radians or meters.
        max_force: Largest torque or force of the motor, newton meters or newtons.
        collide: Let the two bodies collide with each other.
    """

    kind: Literal["fixed", "hinge", "slider", "point"]
    child: str
    parent: str | None = None
    position: tuple[float, ...] | None = None
    axis: tuple[float, ...] | None = None
    limits: tuple[float, ...] | None = None
    friction: float | None = None
    damping: float | None = None
    stiffness: float | None = None
    spring_position: float | None = None
    armature: float | None = None
    target_velocity: float | None = None
    target_position: float | None = None
    max_force: float | None = None
    collide: bool = False

    def __post_init__(self) -> None:
        if self.position is not None:
            check_vector(self.position, "position")
        for name in _OF_AN_AXIS:
            if getattr(self, name) is not None and self.kind not in ("hinge", "slider"):
                raise SettingsError(f"{name} is not a setting of a {self.kind} joint")
        if self.axis is not None:
            check_vector(self.axis, "axis")
            if not any(self.axis):
                raise SettingsError("axis must have a length above 0")
        if self.limits is not None:
            check_vector(self.limits, "limits", 2)
            if self.limits[0] > self.limits[1]:
                raise SettingsError(f"limits must be in order, not {list(self.limits)}")
        for name in ("friction", "damping", "stiffness", "armature"):
            value = getattr(self, name)
            if value is not None:
                as_not_negative(value, name)
        if self.spring_position is not None:
            as_real(self.spring_position, "spring_position")
            if self.stiffness is None:
                raise SettingsError("spring_position needs a stiffness")
        self._check_motor()

    def _check_motor(self) -> None:
        if self.target_velocity is not None and self.target_position is not None:
            raise SettingsError("target_position and target_velocity cannot both be given")
        driven = self.target_velocity is not None or self.target_position is not None
        if driven != (self.max_force is not None):
            raise SettingsError("max_force must be given with a target, and only then")
        if self.max_force is not None:
            as_positive(self.max_force, "max_force")
        target = self.target_position
        if self.target_velocity is not None:
            as_real(self.target_velocity, "target_velocity")
        if target is not None:
            as_real(target, "target_position")
            if self.limits is not None and not self.limits[0] <= target <= self.limits[1]:
                raise SettingsError(
                    f"target_position must be within the limits {list(self.limits)}, not {target:g}"
                )

    @property
    def has_axis(self) -> bool:
        """True if the joint has a position and can have a motor."""
        return self.kind in ("hinge", "slider")

    def make_kind(self) -> JointKind:
        """Return the kind of joint for :meth:`voxshell.World.add_joint`."""
        if self.kind == "fixed":
            return FixedJoint()
        if self.kind == "point":
            return PointJoint()
        limits = None if self.limits is None else (self.limits[0], self.limits[1])
        return (HingeJoint if self.kind == "hinge" else SliderJoint)(
            axis=(0.0, 0.0, 1.0) if self.axis is None else self.axis,
            limits=limits,
            friction=self.friction or 0.0,
            damping=self.damping or 0.0,
            stiffness=self.stiffness or 0.0,
            spring_position=self.spring_position or 0.0,
            armature=self.armature or 0.0,
        )

    def place(self, child: BodySettings) -> NDArray[np.float64]:
        """Return ``world_from_joint`` at the start, (4, 4), with the world's axes."""
        pose = np.eye(4)
        pose[:3, 3] = child.position if self.position is None else self.position
        return pose
