"""Joints between bodies of a world, and their motors."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell import _bullet
from voxshell.base.arguments import as_positive, as_real, is_infinite, show_apart
from voxshell.base.calls import explain_calls
from voxshell.base.near_names import know_near_names
from voxshell.errors import InputTypeError, SettingsError
from voxshell.simulation.joint_kinds import HingeJoint, JointKind, SliderJoint
from voxshell.simulation.world_part import WorldPart

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.simulation.body import Body

_ROUNDING = 1e-9
"""How far beyond a limit a target may be by rounding, radians or meters, or as a fraction of it."""


@dataclass(frozen=True, eq=False)
class Reaction:
    """Force and torque of a joint on its child in the last step, with motor, friction and limits.

    Attributes:
        force: (3,) float64, newtons, world frame.
        torque: (3,) float64, newton meters, world frame, about the joint's origin.
    """

    force: NDArray[np.float64]
    torque: NDArray[np.float64]


@explain_calls
@know_near_names
class Joint(WorldPart):
    """A joint of a :class:`World`; made by :meth:`World.add_joint`.

    Position and velocity are the child's relative to the parent, about or along the axis. They are
    in radians and rad/s for a hinge, where whole turns count, and in meters and m/s for a slider. A
    motor exerts at most ``max_force``, in newtons, or in newton meters for a hinge. A joint without
    a motor moves freely except for its friction.

    Raises:
        SettingsError: The joint has been removed; or it has no axis, and thus no position, velocity
            or motor.
    """

    __slots__ = ("_child", "_collides", "_frames", "_kind", "_number", "_parent")

    def __init__(
        self,
        simulation: _bullet.Simulation,
        number: int,
        name: str,
        kind: JointKind,
        parent: Body | None,
        child: Body,
        frames: tuple[NDArray[np.float64], NDArray[np.float64]],
        collides: bool,
    ) -> None:
        super().__init__(simulation, name)
        self._collides = collides
        self._frames = frames  # in parent and child
        self._number = number
        self._kind: JointKind = kind
        self._parent = parent
        self._child = child

    @property
    def kind(self) -> JointKind:
        """The joint's kind, as given to :meth:`World.add_joint`."""
        return self._kind

    @property
    def parent(self) -> Body | None:
        """The parent body, or None for the world."""
        return self._parent

    @property
    def child(self) -> Body:
        """The child body."""
        return self._child

    @property
    def position(self) -> float:
        """Radians over any number of turns, or meters; 0 where the frames coincide."""
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
        """Drive the joint with a velocity.

        Args:
            velocity: Rad/s or m/s; 0 acts as a brake.
            max_force: Newton meters or newtons, above 0.

        Raises:
            SettingsError: A number is out of range, or the joint has no axis.
        """
        self._drive(self._make_velocity_motor(velocity, max_force=max_force))

    def set_target_position(
        self,
        position: float,
        *,
        max_force: float,
        max_speed: float = math.inf,
        velocity: float = 0.0,
    ) -> None:
        """Drive the joint to a position and hold it there, or along a motion.

        Each step closes a fifth of the distance, at most at ``max_speed``. A joint therefore lags
        behind a target that moves, by five steps, unless you pass its velocity, too: before each
        step, set where the target is now, and how fast it moves. If its velocity changes, pass that
        of the middle of the step.

        Args:
            position: Radians over any number of turns, or meters; within the limits. Rounding of
                1e-9 beyond a limit means the limit.
            max_force: Newton meters or newtons, above 0.
            max_speed: Rad/s or m/s, above 0; the largest speed that the motor asks for, with
                ``velocity``.
            velocity: Velocity of the target, rad/s or m/s. It stays set: a target that stands still
                needs 0.

        Raises:
            SettingsError: A number is out of range, or the joint has no axis.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> arm = world.add(vx.Box((0.3, 0.02, 0.02)), mass=1.0)
            >>> hinge = world.add_joint(vx.HingeJoint(axis=(0, 0, 1)), None, arm)
            >>> hinge.set_target_position(0.5, max_force=20.0, max_speed=2.0)
            >>> world.step(200)
            >>> round(hinge.position, 3)
            0.5

            A turn of 1 rad/s:

            >>> def turn(world):
            ...     target = 0.5 + (world.time - 1.0)
            ...     hinge.set_target_position(target, max_force=20.0, velocity=1.0)
            >>> world.step(200, before=turn)
            >>> round(hinge.position, 3)
            1.5
        """
        motor = self._make_position_motor(
            position, max_force=max_force, max_speed=max_speed, velocity=velocity
        )
        self._drive(motor)

    def follow(
        self,
        leader: Joint,
        *,
        multiplier: float = 1.0,
        offset: float = 0.0,
        max_force: float,
        max_speed: float = math.inf,
    ) -> None:
        """Drive the joint to ``multiplier * leader.position + offset`` continuously.

        There is no force on the leader: an obstacle that blocks this joint does not stop the
        leader.

        Args:
            leader: A joint of the same world.
            multiplier: Any number.
            offset: Radians or meters.
            max_force: Newton meters or newtons, above 0.
            max_speed: Rad/s or m/s, above 0.

        Raises:
            InputTypeError: ``leader`` is not a joint.
            SettingsError: The leader is this joint, belongs to another world or has no axis, or a
                number is out of range.

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
        if not isinstance(leader, Joint):
            raise InputTypeError(f"leader must be a Joint, not {type(leader).__name__}")
        if leader is self:
            raise SettingsError(f"joint {self.name!r} cannot follow itself")
        if leader._along_axis() is not self._along_axis():
            raise SettingsError(f"joint {leader.name!r} belongs to another world")
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
        """Turn the motor off."""
        self._drive(_bullet.Motor(_bullet.MotorMode.NONE, 0.0, 0.0, 0.0))

    def _count_turns_from(self, position: float) -> None:
        """Count turns such that the present position is the nearest to this one, in radians."""
        self._along_axis().count_joint_turns_from(self._number, position)

    def _make_velocity_motor(self, velocity: float, *, max_force: float) -> _bullet.Motor:
        """Return the motor of :meth:`set_target_velocity`, and change nothing."""
        self._along_axis()
        return _bullet.Motor(
            _bullet.MotorMode.VELOCITY,
            as_real(velocity, "velocity"),
            as_positive(max_force, "max_force"),
            0.0,
        )

    def _make_position_motor(
        self, position: float, *, max_force: float, max_speed: float, velocity: float
    ) -> _bullet.Motor:
        """Return the motor of :meth:`set_target_position`, and change nothing."""
        target = as_real(position, "position")
        self._along_axis()
        limits = getattr(self.kind, "limits", None)
        if limits is not None:
            held = min(max(target, limits[0]), limits[1])
            if not math.isclose(target, held, rel_tol=_ROUNDING, abs_tol=_ROUNDING):
                given, lower, upper = show_apart(target, *limits)
                raise SettingsError(
                    f"position must be within the limits of joint {self.name!r}, {lower} to {upper}, "
                    f"not {given}"
                )
            target = held
        return _bullet.Motor(
            _bullet.MotorMode.POSITION,
            target,
            as_positive(max_force, "max_force"),
            _as_speed(max_speed),
            velocity=as_real(velocity, "velocity"),
        )

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


def _as_speed(value: float) -> float:
    return math.inf if is_infinite(value) else as_positive(value, "max_speed")
