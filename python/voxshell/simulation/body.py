"""Bodies of a world: pose, mass, velocities and forces."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from voxshell.base.arguments import as_vector
from voxshell.base.calls import explain_calls
from voxshell.base.near_names import know_near_names
from voxshell.base.pose_forms import as_pose, as_rigid_pose
from voxshell.base.poses import pose as make_pose
from voxshell.base.rotations import xyzw_from_rotation
from voxshell.errors import PoseError, SettingsError
from voxshell.simulation.body_properties import BodyProperties, read_only
from voxshell.simulation.body_table import make_body_table

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from voxshell import _bullet
    from voxshell.model.mass_properties import MassProperties
    from voxshell.simulation.body_shapes import Shape
    from voxshell.simulation.motion import Motion


@explain_calls
@know_near_names
class Body(BodyProperties):
    """A body of a :class:`World`; made by :meth:`World.add`.

    Its frame is that of its mesh or shape. The world accounts for a center of mass elsewhere.
    Vectors are in the world frame. Setting any property wakes the body. Arrays that a body returns
    are read-only copies: set the property, or change a copy.

    Raises:
        SettingsError: The body has been removed from its world.

    Example:
        >>> import voxshell as vx
        >>> world = vx.World(gravity=(0, 0, 0))
        >>> ball = world.add(vx.Sphere(0.1), mass=2.0)
        >>> ball.apply_impulse((1.0, 0.0, 0.0))
        >>> ball.linear_velocity
        array([0.5, 0. , 0. ])
    """

    __slots__ = ("_center", "_inertia", "_mass", "_regrouped", "_shape")
    _repr_html_ = make_body_table

    def __init__(
        self,
        simulation: _bullet.Simulation,
        number: int,
        name: str,
        shape: Shape,
        mass: float,
        motion: Motion,
        moves_surfaces: bool,
        matter: MassProperties,
        regrouped: Callable[[Body], None] | None,
    ) -> None:
        super().__init__(simulation, number, name, motion, moves_surfaces)
        self._regrouped = regrouped  # called when it may meet others than before
        self._center = matter.center_of_mass
        self._inertia = matter.inertia
        self._shape: Shape = shape
        self._mass = mass

    @property
    def shape(self) -> Shape:
        """The body's shape, which other bodies may share."""
        return self._shape

    @property
    def mass(self) -> float:
        """Kilograms; 0 for static and kinematic bodies."""
        return self._mass

    @property
    def center_of_mass(self) -> NDArray[np.float64]:
        """The center of mass, (3,) float64, meters, world frame, read-only.

        Static and kinematic bodies have no mass; theirs is their origin.

        Example:
            >>> import voxshell as vx
            >>> parts = [(vx.Sphere(0.1), (0, 0, 0)), (vx.Sphere(0.1), (1, 0, 0))]
            >>> body = vx.World().add(vx.Compound(parts), pose=(0, 0, 2))
            >>> body.center_of_mass.round(9)
            array([0.5, 0. , 2. ])
        """
        pose = self._simulation.pose(self.number)
        return read_only(pose[:3, :3] @ self._center + pose[:3, 3])

    @property
    def inertia(self) -> NDArray[np.float64]:
        """The inertia tensor about the center of mass, (3, 3) float64, kg m2, read-only.

        It is along the axes of the world, so it changes as the body turns. Static and kinematic
        bodies have no mass; theirs is zero.

        Example:
            >>> import voxshell as vx
            >>> body = vx.World().add(vx.Box((1, 1, 2)), mass=3.0)  # edges of 2, 2 and 4 m
            >>> body.inertia.diagonal().round(9)
            array([5., 5., 2.])
        """
        turn = self._simulation.pose(self.number)[:3, :3]
        return read_only(turn @ self._inertia @ turn.T)

    @property
    def kinetic_energy(self) -> float:
        """Energy of the motion of the center of mass and of the rotation about it, joules.

        It is 0 for static and kinematic bodies, which have no mass.

        Example:
            A solid ball that rolls has 7/5 of the energy of one that slides:

            >>> import voxshell as vx
            >>> ball = vx.World().add(vx.Sphere(0.1), mass=2.0)
            >>> ball.linear_velocity = (3.0, 0, 0)
            >>> round(ball.kinetic_energy, 9)
            9.0
            >>> ball.angular_velocity = (0, 30.0, 0)
            >>> round(ball.kinetic_energy, 9)
            12.6
        """
        velocity, spin = self.linear_velocity, self.angular_velocity
        return float(0.5 * (self._mass * (velocity @ velocity) + spin @ self.inertia @ spin))

    @property
    def pose(self) -> NDArray[np.float64]:
        """``world_from_body``, (4, 4) float64, meters, read-only; settable, see :func:`pose`.

        Setting it moves a dynamic body at once, whatever is in between. A kinematic body moves
        there during the next step, takes along what lies on it, and hits what is in between;
        :meth:`place` moves it without.

        Raises:
            PoseError: The new pose is in no form that :func:`pose` lists, is not rigid, or is not
                finite.

        Example:
            >>> import voxshell as vx
            >>> body = vx.World().add(vx.Sphere(0.1))
            >>> body.pose = (0, 0, 1)
            >>> body.pose[2, 3] = 2.0
            Traceback (most recent call last):
            ValueError: assignment destination is read-only
        """
        return read_only(self._simulation.pose(self.number))

    @pose.setter
    def pose(self, value: ArrayLike) -> None:
        pose = as_pose(value, "pose")
        if pose is not None:
            # Bullet's side checks the most frequent case, which saves 5 us.
            try:
                self._simulation.set_pose(self.number, pose)
            except PoseError:
                pass
            else:
                return
        self._simulation.set_pose(self.number, as_rigid_pose(value, "pose"))

    def place(self, pose: ArrayLike) -> None:
        """Put the body at a pose at once and at rest, as for a new episode; nothing is hit.

        Args:
            pose: ``world_from_body``, meters, in a form that :func:`pose` lists.

        Raises:
            PoseError: It is in no such form, is not rigid, or is not finite.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> finger = world.add(vx.Box((0.1, 0.1, 0.1)), motion="kinematic")
            >>> finger.place((5, 0, 0))
            >>> world.step()
            >>> finger.position[0], finger.linear_velocity[0]
            (np.float64(5.0), np.float64(0.0))
        """
        self._simulation.place(self.number, as_rigid_pose(pose, "pose"))

    @property
    def position(self) -> NDArray[np.float64]:
        """The origin of the body, (3,) float64, meters, world frame, read-only; settable.

        Setting it keeps the orientation and otherwise acts like setting :attr:`pose`. The center of
        mass may be elsewhere. To move the body by a vector, write ``body.position = body.position +
        vector``: NumPy refuses ``+=`` and entries, because the array is a copy.

        Raises:
            SettingsError: The new position is not three finite numbers.
            PoseError: The new position is too far from the world's origin.

        Example:
            >>> import voxshell as vx
            >>> body = vx.World().add(vx.Sphere(0.1))
            >>> body.position = (0, 0, 1)
            >>> body.position = body.position + (0, 0, 0.5)
            >>> body.position
            array([0. , 0. , 1.5])
        """
        return read_only(self._simulation.pose(self.number)[:3, 3].copy())

    @position.setter
    def position(self, value: ArrayLike) -> None:
        pose = self._simulation.pose(self.number).copy()
        pose[:3, 3] = as_vector(value, "position", " in meters")
        self.pose = pose

    @property
    def orientation_xyzw(self) -> NDArray[np.float64]:
        """Unit quaternion x, y, z, w of ``world_from_body``, (4,) float64, read-only; settable.

        Its w is at least 0. Setting it turns the body about its origin and otherwise acts like
        setting :attr:`pose`.

        Raises:
            PoseError: The new quaternion is not four finite numbers, or its length is off 1 by more
                than 1e-3.

        Example:
            >>> import math
            >>> import voxshell as vx
            >>> body = vx.World().add(vx.Box((1, 1, 1)))
            >>> body.orientation_xyzw = (0, 0, math.sqrt(0.5), math.sqrt(0.5))
            >>> body.orientation_xyzw.round(6)
            array([0.      , 0.      , 0.707107, 0.707107])
        """
        return read_only(xyzw_from_rotation(self._simulation.pose(self.number)[:3, :3]))

    @orientation_xyzw.setter
    def orientation_xyzw(self, value: ArrayLike) -> None:
        position = self._simulation.pose(self.number)[:3, 3]
        self.pose = make_pose(position, xyzw=value)

    @property
    def linear_velocity(self) -> NDArray[np.float64]:
        """Velocity of the center of mass, (3,) float64, m/s, world frame, read-only; settable.

        For a kinematic body, this is the velocity of its origin in the last step.

        Raises:
            SettingsError: It is set for a body that is not dynamic, or not to three finite numbers.
        """
        return read_only(np.array(self._simulation.linear_velocity(self.number)))

    @linear_velocity.setter
    def linear_velocity(self, value: ArrayLike) -> None:
        velocity = as_vector(value, "linear_velocity", " in m/s")
        self._moved_by_forces("linear_velocity").set_linear_velocity(self.number, velocity)

    @property
    def angular_velocity(self) -> NDArray[np.float64]:
        """Angular velocity, (3,) float64, rad/s, world frame, read-only; settable.

        Raises:
            SettingsError: It is set for a body that is not dynamic, or not to three finite numbers.
        """
        return read_only(np.array(self._simulation.angular_velocity(self.number)))

    @angular_velocity.setter
    def angular_velocity(self, value: ArrayLike) -> None:
        velocity = as_vector(value, "angular_velocity", " in rad/s")
        self._moved_by_forces("angular_velocity").set_angular_velocity(self.number, velocity)

    def velocity_at(self, point: ArrayLike) -> NDArray[np.float64]:
        """Return the velocity of the body's material at a point.

        Args:
            point: (3,), meters, world frame; it may be outside the body.

        Returns:
            (3,) float64, m/s, world frame, read-only. For a kinematic body, the velocity of its
            last step.

        Raises:
            SettingsError: ``point`` is not three finite numbers.

        Example:
            >>> import voxshell as vx
            >>> wheel = vx.World().add(vx.Cylinder(0.5, 0.1))
            >>> wheel.angular_velocity = (0, 0, 2.0)
            >>> wheel.velocity_at((0.5, 0, 0)).round(9) + 0.0
            array([0., 1., 0.])
        """
        place = as_vector(point, "point", " in meters")
        lever = place - self.center_of_mass
        turning = np.cross(self._simulation.angular_velocity(self.number), lever)
        return read_only(np.array(self._simulation.linear_velocity(self.number)) + turning)

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Corners of an axis-aligned box around the body in the world frame, (2, 3), meters.

        The box may be some millimeters larger than the body. Planes are unbounded: their value is
        1e18.

        Example:
            >>> import voxshell as vx
            >>> body = vx.World().add(vx.Sphere(0.25), pose=np.diag([1.0, 1.0, 1.0, 1.0]))
            >>> body.bounds.tolist()
            [[-0.25, -0.25, -0.25], [0.25, 0.25, 0.25]]
        """
        return read_only(np.array(self._simulation.bounds(self.number)))

    @property
    def sleeping(self) -> bool:
        """True if Bullet has put the body to sleep."""
        return self._simulation.is_asleep(self.number)

    def wake(self) -> None:
        """Wake a sleeping body."""
        self._simulation.wake(self.number)

    def apply_force(self, force: ArrayLike, at: ArrayLike | None = None) -> None:
        """Apply a force during the next step; for a lasting force, call this before every step.

        Args:
            force: (3,), newtons, world frame.
            at: (3,), meters, world frame: where the force acts; the center of mass by default.

        Raises:
            SettingsError: The body is not dynamic, or an argument is not three finite numbers.

        Example:
            A force that carries the weight:

            >>> import voxshell as vx
            >>> world = vx.World()
            >>> ball = world.add(vx.Sphere(0.1), mass=2.0)
            >>> lift = lambda world: ball.apply_force((0, 0, 2.0 * 9.81))
            >>> world.step(100, before=lift)
            >>> bool(abs(ball.pose[2, 3]) < 1e-9)
            True
        """
        self._moved_by_forces("a force").apply_force(
            self.number, as_vector(force, "force", " in newtons"), _as_place(at)
        )

    def apply_torque(self, torque: ArrayLike) -> None:
        """Apply a torque during the next step.

        Args:
            torque: (3,), newton meters, world frame.

        Raises:
            SettingsError: The body is not dynamic, or ``torque`` is not three finite numbers.
        """
        self._moved_by_forces("a torque").apply_torque(
            self.number, as_vector(torque, "torque", " in newton meters")
        )

    def apply_impulse(self, impulse: ArrayLike, at: ArrayLike | None = None) -> None:
        """Change the velocities at once by an impulse.

        Args:
            impulse: (3,), newton seconds, world frame.
            at: (3,), meters, world frame: where the impulse acts; the center of mass by default.

        Raises:
            SettingsError: The body is not dynamic, or an argument is not three finite numbers.

        Example:
            >>> import voxshell as vx
            >>> ball = vx.World(gravity=(0, 0, 0)).add(vx.Sphere(0.1), mass=2.0)
            >>> ball.apply_impulse((1.0, 0, 0), at=(0, 0, 0.1))
            >>> ball.linear_velocity, ball.angular_velocity.round(6)
            (array([0.5, 0. , 0. ]), array([ 0. , 12.5,  0. ]))
        """
        self._moved_by_forces("an impulse").apply_impulse(
            self.number, as_vector(impulse, "impulse", " in newton seconds"), _as_place(at)
        )

    def apply_torque_impulse(self, impulse: ArrayLike) -> None:
        """Change the angular velocity at once by an angular impulse.

        Args:
            impulse: (3,), newton meter seconds, world frame.

        Raises:
            SettingsError: The body is not dynamic, or ``impulse`` is not three finite numbers.
        """
        self._moved_by_forces("an impulse").apply_torque_impulse(
            self.number, as_vector(impulse, "impulse", " in newton meter seconds")
        )

    def _set_groups(self, **changes: int) -> None:
        super()._set_groups(**changes)
        if self._regrouped is not None:
            self._regrouped(self)

    def _moved_by_forces(self, what: str) -> _bullet.Simulation:
        if self.motion == "static":
            raise SettingsError(f"body {self.name!r} is static: {what} cannot move it")
        if self.motion == "kinematic":
            raise SettingsError(
                f"body {self.name!r} is kinematic: set its pose before each step instead of {what}"
            )
        return self._simulation

    def __repr__(self) -> str:
        what = f"Body({self.number}, {self.name!r}, {self.shape!r}, "
        matter = f"mass={self.mass:g} kg" if self.motion == "dynamic" else self.motion
        if self.removed:
            return f"{what}{matter}, removed)"
        x, y, z = (self._simulation.pose(self.number)[:3, 3] + 0.0).tolist()
        return f"{what}{matter}, position=({x:.4g}, {y:.4g}, {z:.4g}) m)"


def _as_place(at: ArrayLike | None) -> tuple[float, float, float] | None:
    return None if at is None else as_vector(at, "at", " in meters")
