"""Kinds of joints: their degrees of freedom and limits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, TypeAlias

import numpy as np

from voxshell import _bullet
from voxshell.base.arguments import as_floats, as_not_negative, as_real, as_vector
from voxshell.base.calls import explain_calls
from voxshell.base.user_warnings import doubt_degrees
from voxshell.errors import SettingsError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True)
class FixedJoint:
    """A joint that holds two bodies together rigidly.

    Example:
        >>> import numpy as np
        >>> import voxshell as vx
        >>> world = vx.World()
        >>> shelf = world.add(vx.Box((0.2, 0.1, 0.01)))
        >>> nails = world.add_joint(vx.FixedJoint(), None, shelf)
        >>> world.step(100)
        >>> bool(np.abs(shelf.pose - np.eye(4)).max() < 1e-3)
        True
    """

    _kind: ClassVar = _bullet.JointKind.FIXED


@dataclass(frozen=True)
class PointJoint:
    """A joint that holds one point of two bodies together, like a ball and its socket.

    Example:
        A lamp on a cord of half a meter:

        >>> import numpy as np
        >>> import voxshell as vx
        >>> world = vx.World()
        >>> lamp = world.add(vx.Sphere(0.05))
        >>> hook = np.eye(4)
        >>> hook[0, 3] = 0.5
        >>> cord = world.add_joint(vx.PointJoint(), None, lamp, world_from_joint=hook)
        >>> world.step(100)
        >>> bool(abs(np.linalg.norm(lamp.pose[:3, 3] - hook[:3, 3]) - 0.5) < 1e-3)
        True
    """

    _kind: ClassVar = _bullet.JointKind.POINT


@explain_calls
@dataclass(frozen=True)
class HingeJoint:
    """A joint that lets the child turn about an axis.

    Args:
        axis: (3,), joint frame; any nonzero length.
        limits: Lowest and highest angle, radians, over any number of turns; None for no limits. A
            joint that begins outside turns back at up to 1 rad/s.
        friction: Friction torque while no motor drives the joint, newton meters.
        damping: Torque against the motion, newton meters per rad/s.
        stiffness: Of a spring that turns the joint to ``spring_position``, newton meters per
            radian; 0 for no spring. Motors, friction and limits act beside it.
        spring_position: Angle at which the spring is relaxed, radians.
        armature: Moment of inertia of what turns with the joint, as a motor's rotor behind a gear
            does: that of the rotor times the squared gear ratio, kg m2.

    Raises:
        SettingsError: The axis is zero, the limits are in the wrong order, or a number is negative
            or not finite.

    Warns:
        UnitWarning: A limit is probably in degrees: 15, 20, 25 and so on.

    Example:
        >>> import math
        >>> import voxshell as vx
        >>> world = vx.World(gravity=(0, 0, 0))
        >>> wheel = world.add(vx.Cylinder(radius=0.2, length=0.05))
        >>> axle = world.add_joint(vx.HingeJoint(axis=(0, 0, 1)), None, wheel)
        >>> axle.set_target_position(6 * math.pi, max_force=10.0, max_speed=20.0)
        >>> world.step(400)
        >>> round(axle.position / math.pi, 3)
        6.0
    """

    axis: ArrayLike = (0.0, 0.0, 1.0)
    limits: tuple[float, float] | None = None
    friction: float = 0.0
    damping: float = 0.0
    stiffness: float = 0.0
    spring_position: float = 0.0
    armature: float = 0.0

    _kind: ClassVar = _bullet.JointKind.HINGE

    def __post_init__(self) -> None:
        _check_axis(self)


@explain_calls
@dataclass(frozen=True)
class SliderJoint:
    """A joint that lets the child slide along an axis, without turning.

    Args:
        axis: (3,), joint frame; any nonzero length.
        limits: Lowest and highest position, meters; None for no limits. A joint that begins outside
            slides back at up to 0.1 m/s.
        friction: Friction force while no motor drives the joint, newtons.
        damping: Force against the motion, newtons per m/s.
        stiffness: Of a spring that moves the joint to ``spring_position``, newtons per meter; 0 for
            no spring. Motors, friction and limits act beside it.
        spring_position: Position at which the spring is relaxed, meters.
        armature: Inertia of what moves with the joint, as a motor's rotor does, kg.

    Raises:
        SettingsError: The axis is zero, the limits are in the wrong order, or a number is negative
            or not finite.

    Example:
        >>> import voxshell as vx
        >>> world = vx.World()
        >>> lift = world.add(vx.Box((0.2, 0.2, 0.02)))
        >>> rail = world.add_joint(vx.SliderJoint(axis=(0, 0, 1), limits=(0, 0.5)), None, lift)
        >>> rail.set_target_velocity(1.0, max_force=100.0)
        >>> world.step(200)
        >>> round(rail.position, 2)
        0.5
    """

    axis: ArrayLike = (0.0, 0.0, 1.0)
    limits: tuple[float, float] | None = None
    friction: float = 0.0
    damping: float = 0.0
    stiffness: float = 0.0
    spring_position: float = 0.0
    armature: float = 0.0

    _kind: ClassVar = _bullet.JointKind.SLIDER

    def __post_init__(self) -> None:
        _check_axis(self)


JointKind: TypeAlias = FixedJoint | HingeJoint | SliderJoint | PointJoint
"""Any kind of joint."""


def _check_axis(joint: HingeJoint | SliderJoint) -> None:
    if not np.any(as_vector(joint.axis, "axis")):
        raise SettingsError("axis must not be zero")
    if joint.limits is not None:
        unit = "radians" if isinstance(joint, HingeJoint) else "meters"
        lower, upper = as_floats(
            joint.limits, "limits", (2,), meaning=f", the lowest and highest position in {unit}"
        ).tolist()
        if not (math.isfinite(lower) and math.isfinite(upper) and lower <= upper):
            raise SettingsError(
                f"limits must be finite, the lower first, not {lower:g} and {upper:g}; "
                "pass None for no limits"
            )
        if unit == "radians":
            doubt_degrees((lower, upper), "limits")
    for name in ("friction", "damping", "stiffness", "armature"):
        as_not_negative(getattr(joint, name), name)
    as_real(joint.spring_position, "spring_position")
