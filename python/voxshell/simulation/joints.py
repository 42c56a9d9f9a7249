"""Joints: what holds two bodies of a world together, and what drives them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, TypeAlias

import numpy as np

from voxshell import _bullet
from voxshell.base.arguments import as_floats, as_not_negative, as_positive, as_real, as_vector
from voxshell.base.pose_forms import as_rigid_pose
from voxshell.errors import InputTypeError, SettingsError
from voxshell.simulation.part import WorldPart

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from voxshell.simulation.body import Body


@dataclass(frozen=True)
class FixedJoint:
    """Holds two bodies as if they were one.

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
    """Holds a point of two bodies together, about which they turn freely: a ball and its socket.

    Example:
        A lamp on a cord of half a metre:

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


@dataclass(frozen=True)
class HingeJoint:
    """Lets the child turn about an axis.

    Args:
        axis: (3,), joint frame; any length but 0.
        limits: Lowest and highest angle, radians, of any number of turns; None: none.
        friction: Torque that it withstands while no motor drives it, newton metres.
        damping: Torque against its motion, newton metres per rad/s.

    Raises:
        SettingsError: The axis is zero, the limits are in the wrong order, or a number is negative or
            not finite.

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

    _kind: ClassVar = _bullet.JointKind.HINGE

    def __post_init__(self) -> None:
        _check_axis(self)


@dataclass(frozen=True)
class SliderJoint:
    """Lets the child slide along an axis, without turning.

    Args:
        axis: (3,), joint frame; any length but 0.
        limits: Lowest and highest position, metres; None: none.
        friction: Force that it withstands while no motor drives it, newtons.
        damping: Force against its motion, newtons per m/s.

    Raises:
        SettingsError: The axis is zero, the limits are in the wrong order, or a number is negative or
            not finite.

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

    _kind: ClassVar = _bullet.JointKind.SLIDER

    def __post_init__(self) -> None:
        _check_axis(self)


JointKind: TypeAlias = FixedJoint | HingeJoint | SliderJoint | PointJoint
"""What a joint leaves free."""


@dataclass(frozen=True, eq=False)
class Reaction:
    """What a joint did to its child during the last step, motor, friction and limits included.

    Attributes:
        force: (3,) float64, newtons, world frame.
        torque: (3,) float64, newton metres, world frame, about the joint's origin.
    """

    force: NDArray[np.float64]
    torque: NDArray[np.float64]


class Joint(WorldPart):
    """A joint of a :class:`World`; made by :meth:`World.add_joint`.

    Position and velocity are of the child, seen from the parent, about or along the axis: radians and
    rad/s of a hinge, whole turns counted; metres and m/s of a slider. A motor exerts ``max_force`` at
    most: newtons, or newton metres of a hinge. A joint without one moves freely but for its friction.

    Attributes:
        name: For people.

    Raises:
        SettingsError: Anything is asked of a joint that has been removed, or a position, velocity or
            motor of one that has no axis.
    """

    __slots__ = ("_child", "_kind", "_number", "_parent")

    def __init__(
        self,
        simulation: _bullet.Simulation,
        number: int,
        name: str,
        kind: JointKind,
        parent: Body | None,
        child: Body,
    ) -> None:
        super().__init__(simulation, name)
        self._number = number
        self._kind: JointKind = kind
        self._parent = parent
        self._child = child

    @property
    def kind(self) -> JointKind:
        """What it leaves free, as it was given."""
        return self._kind

    @property
    def parent(self) -> Body | None:
        """A body, or None for the world."""
        return self._parent

    @property
    def child(self) -> Body:
        """The other body."""
        return self._child

    @property
    def position(self) -> float:
        """Radians, turns counted, or metres; 0 where the frames of the two bodies coincide."""
        return self._along_axis().read_joint(self._number).position

    @property
    def velocity(self) -> float:
        """Rad/s or m/s."""
        return self._along_axis().read_joint(self._number).velocity

    @property
    def reaction(self) -> Reaction:
        """Force and torque on the child during the last step.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> lamp = world.add(vx.Sphere(0.05), mass=2.0)
            >>> nail = world.add_joint(vx.FixedJoint(), None, lamp)
            >>> world.step(100)
            >>> round(float(nail.reaction.force[2]), 2)  # newtons
            19.62
        """
        force, torque = self._simulation.joint_reaction(self._number)
        return Reaction(np.array(force), np.array(torque))

    def set_target_velocity(self, velocity: float, *, max_force: float) -> None:
        """Drives the joint at a velocity.

        Args:
            velocity: Rad/s or m/s; 0 brakes.
            max_force: Newton metres or newtons, above 0.

        Raises:
            SettingsError: A number is out of range, or the joint has no axis.
        """
        self._drive(
            _bullet.Motor(
                _bullet.MotorMode.VELOCITY,
                as_real(velocity, "velocity"),
                as_positive(max_force, "max_force"),
                0.0,
            )
        )

    def set_target_position(
        self, position: float, *, max_force: float, max_speed: float = math.inf
    ) -> None:
        """Drives the joint to a position and holds it there.

        It closes a fifth of the distance in each step, no faster than ``max_speed``.

        Args:
            position: Radians, of any number of turns, or metres; must lie within the limits.
            max_force: Newton metres or newtons, above 0.
            max_speed: Rad/s or m/s, above 0.

        Raises:
            SettingsError: A number is out of range, or the joint has no axis.
        """
        target = as_real(position, "position")
        self._along_axis()
        limits = getattr(self.kind, "limits", None)
        if limits is not None and not limits[0] <= target <= limits[1]:
            raise SettingsError(
                f"position must be within the limits of joint {self.name!r}, {limits[0]:g} to "
                f"{limits[1]:g}, not {target:g}"
            )
        self._drive(
            _bullet.Motor(
                _bullet.MotorMode.POSITION,
                target,
                as_positive(max_force, "max_force"),
                _as_speed(max_speed),
            )
        )

    def follow(
        self,
        leader: Joint,
        *,
        multiplier: float = 1.0,
        offset: float = 0.0,
        max_force: float,
        max_speed: float = math.inf,
    ) -> None:
        """Drives the joint to ``multiplier * leader.position + offset``, wherever the leader is.

        The leader does not feel it: what blocks this joint does not stop the other.

        Args:
            leader: Of the same world.
            multiplier: Any number.
            offset: Radians or metres.
            max_force: Newton metres or newtons, above 0.
            max_speed: Rad/s or m/s, above 0.

        Raises:
            SettingsError: The leader is this joint, of another world or has no axis, or a number is out
                of range.

        Example:
            Two fingers that close together:

            >>> import voxshell as vx
            >>> world = vx.World(gravity=(0, 0, 0))
            >>> left, right = (world.add(vx.Box((0.01, 0.01, 0.05)), group=0) for _ in range(2))
            >>> slide = vx.SliderJoint(axis=(1, 0, 0))
            >>> first, second = (world.add_joint(slide, None, it) for it in (left, right))
            >>> second.follow(first, multiplier=-1.0, max_force=50.0)
            >>> first.set_target_position(0.03, max_force=50.0)
            >>> world.step(100)
            >>> round(first.position, 4), round(second.position, 4)
            (0.03, -0.03)
        """
        if leader is self:
            raise SettingsError(f"joint {self.name!r} cannot follow itself")
        if leader._along_axis() is not self._along_axis():
            raise SettingsError(f"joint {leader.name!r} is of another world")
        self._drive(
            _bullet.Motor(
                _bullet.MotorMode.FOLLOW,
                as_real(offset, "offset"),
                as_positive(max_force, "max_force"),
                _as_speed(max_speed),
                leader._number,
                as_real(multiplier, "multiplier"),
            )
        )

    def release(self) -> None:
        """Turns the motor off."""
        self._drive(_bullet.Motor(_bullet.MotorMode.NONE, 0.0, 0.0, 0.0))

    def _drive(self, motor: _bullet.Motor) -> None:
        self._along_axis().set_motor(self._number, motor)

    def _along_axis(self) -> _bullet.Simulation:
        if not isinstance(self.kind, (HingeJoint, SliderJoint)):
            raise SettingsError(
                f"joint {self.name!r}, a {type(self.kind).__name__}, has no axis: only hinges and "
                "sliders have positions, velocities and motors"
            )
        return self._simulation

    def __repr__(self) -> str:
        parent = "the world" if self.parent is None else repr(self.parent.name)
        return f"Joint({self.name!r}, {self.kind!r}, {parent} to {self.child.name!r})"


@dataclass(frozen=True)
class JointFrames:
    """Where a joint is, in three ways of which one is given; see :meth:`World.add_joint`."""

    parent_from_joint: ArrayLike | None
    child_from_joint: ArrayLike | None
    world_from_joint: ArrayLike | None

    def resolve(
        self, parent: Body | None, child: Body
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """``parent_from_joint`` and ``child_from_joint``, (4, 4) each.

        Raises:
            PoseError: One is no pose.
            SettingsError: Two ways are mixed.
        """
        world_from_parent = np.eye(4) if parent is None else parent.pose
        if self.world_from_joint is not None:
            if self.parent_from_joint is not None or self.child_from_joint is not None:
                raise SettingsError(
                    "give world_from_joint, or the frames in the bodies, but not both"
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
    """The joint as the bindings take it.

    Raises:
        InputTypeError: ``kind`` is no joint.
        PoseError: A frame is not a rigid transform.
        SettingsError: Two ways of giving frames are mixed.
    """
    if not isinstance(kind, (FixedJoint, HingeJoint, SliderJoint, PointJoint)):
        raise InputTypeError(
            "joint must be a FixedJoint, HingeJoint, SliderJoint or PointJoint, not "
            f"{type(kind).__name__}"
        )
    parent_from_joint, child_from_joint = frames.resolve(parent, child)
    lower, upper, friction, damping = 1.0, -1.0, 0.0, 0.0
    if isinstance(kind, (HingeJoint, SliderJoint)):
        # The bindings' axis is x.
        turn = np.eye(4)
        turn[:3, :3] = _frame_along(kind.axis)
        parent_from_joint, child_from_joint = parent_from_joint @ turn, child_from_joint @ turn
        friction, damping = float(kind.friction), float(kind.damping)
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
        collides=collide,
    )


def invert(pose: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of a rigid transform."""
    inverse = np.eye(4)
    inverse[:3, :3] = pose[:3, :3].T
    inverse[:3, 3] = -pose[:3, :3].T @ pose[:3, 3]
    return inverse


def _frame_along(axis: ArrayLike) -> NDArray[np.float64]:
    """A rotation whose first column is along the axis."""
    x: NDArray[np.float64] = np.array(as_vector(axis, "axis"))
    x /= np.abs(x).max()
    x /= np.linalg.norm(x)
    aside = np.eye(3)[np.abs(x).argmin()]
    y = np.cross(aside, x)
    y /= np.linalg.norm(y)
    return np.column_stack([x, y, np.cross(x, y)])


def _check_axis(joint: HingeJoint | SliderJoint) -> None:
    if not np.any(as_vector(joint.axis, "axis")):
        raise SettingsError("axis must not be zero")
    if joint.limits is not None:
        lower, upper = as_floats(joint.limits, "limits", (2,)).tolist()
        if not (math.isfinite(lower) and math.isfinite(upper) and lower <= upper):
            raise SettingsError(
                f"limits must be finite, the lower first, not {lower:g} and {upper:g}; "
                "pass None for none"
            )
    for name in ("friction", "damping"):
        as_not_negative(getattr(joint, name), name)


def _as_speed(value: float) -> float:
    return math.inf if value == math.inf else as_positive(value, "max_speed")
