"""Bodies of a world: where they are, what they weigh, what pushes them."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np

from voxshell import _bullet
from voxshell._arguments import as_integer, as_not_negative, as_real, as_vector
from voxshell._poses import as_pose, as_rigid_pose
from voxshell._rotations import xyzw_from_rotation
from voxshell.errors import PoseError, SettingsError
from voxshell.poses import pose as make_pose
from voxshell.world_part import WorldPart

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from voxshell.body_shapes import Shape
    from voxshell.mass_properties import MassProperties

Motion: TypeAlias = Literal["dynamic", "static", "kinematic"]
"""Who moves a body: forces, nobody, or the user, pose by pose."""

MOTIONS: dict[Motion, _bullet.Motion] = {
    "dynamic": _bullet.Motion.DYNAMIC,
    "static": _bullet.Motion.STATIC,
    "kinematic": _bullet.Motion.KINEMATIC,
}

_ALL_GROUPS = 2**31 - 1


class Body(WorldPart):
    """A body of a :class:`World`; made by :meth:`World.add`.

    Its origin and axes are those of its mesh or shape: where the centre of mass lies is the world's
    business. Vectors are in the world frame. All that is set wakes the body. Arrays that a body returns are
    read-only copies: set the property, or change a copy of it.

    Attributes:
        name: For people.

    Raises:
        SettingsError: Anything is asked of a body that has been removed from its world.

    Example:
        >>> import voxshell as vx
        >>> world = vx.World(gravity=(0, 0, 0))
        >>> ball = world.add(vx.Sphere(0.1), mass=2.0)
        >>> ball.apply_impulse((1.0, 0.0, 0.0))
        >>> ball.linear_velocity
        array([0.5, 0. , 0. ])
    """

    __slots__ = ("_center", "_inertia", "_mass", "_motion", "_moves_surfaces", "_number", "_shape")

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
    ) -> None:
        super().__init__(simulation, name)
        self._center = matter.center_of_mass
        self._inertia = matter.inertia
        self._moves_surfaces = moves_surfaces
        self._number = number
        self._shape: Shape = shape
        self._mass = mass
        self._motion: Motion = motion

    @property
    def number(self) -> int:
        """What ``World.contacts()`` and other results call it; no two bodies of a world have had the same.

        It is the body's place in ``World.bodies`` as long as none is removed.
        """
        return self._number

    @property
    def shape(self) -> Shape:
        """What it is made of; may be shared with other bodies."""
        return self._shape

    @property
    def mass(self) -> float:
        """Kilograms; 0 for static and kinematic bodies."""
        return self._mass

    @property
    def motion(self) -> Motion:
        """Who moves it: "dynamic" (forces), "static" (nobody), "kinematic" (the user)."""
        return self._motion

    @property
    def pose(self) -> NDArray[np.float64]:
        """``world_from_body``, (4, 4) float64, metres, read-only; settable to any form that :func:`pose` lists.

        A dynamic body that is given a pose is there at once, whatever lies between. A kinematic one
        moves there within the next step, and takes along what lies on it.

        Raises:
            PoseError: It is set to what is in no form that :func:`pose` lists, is not rigid, or is not
                finite.

        Example:
            >>> import voxshell as vx
            >>> body = vx.World().add(vx.Sphere(0.1))
            >>> body.pose = (0, 0, 1)
            >>> body.pose[2, 3] = 2.0
            Traceback (most recent call last):
            ValueError: assignment destination is read-only
        """
        return _read_only(self._simulation.pose(self.number))

    @pose.setter
    def pose(self, value: ArrayLike) -> None:
        pose = as_pose(value, "pose")
        if pose is not None:
            # Bullet's side checks what most callers hand over, 5 us sooner.
            with suppress(PoseError):
                self._simulation.set_pose(self.number, pose)
                return
        self._simulation.set_pose(self.number, as_rigid_pose(value, "pose"))

    @property
    def position(self) -> NDArray[np.float64]:
        """The origin of the body, (3,) float64, metres, world frame, read-only; setting it keeps the orientation.

        Setting it moves the body as setting :attr:`pose` does. The center of mass may lie elsewhere.

        Raises:
            SettingsError: It is set to anything but three finite numbers.
            PoseError: It is set to a place too far from the world's origin.

        Example:
            >>> import voxshell as vx
            >>> body = vx.World().add(vx.Sphere(0.1))
            >>> body.position = (0, 0, 1)
            >>> body.position
            array([0., 0., 1.])
        """
        return _read_only(self._simulation.pose(self.number)[:3, 3].copy())

    @position.setter
    def position(self, value: ArrayLike) -> None:
        pose = self._simulation.pose(self.number).copy()
        pose[:3, 3] = as_vector(value, "position")
        self.pose = pose

    @property
    def orientation_xyzw(self) -> NDArray[np.float64]:
        """The unit quaternion x, y, z, w of ``world_from_body``, (4,) float64, read-only; w is at least 0.

        Setting it turns the body about its origin, as setting :attr:`pose` does.

        Raises:
            PoseError: It is set to anything but four finite numbers, or its length is off 1 by more than
                1e-3.

        Example:
            >>> import math
            >>> import voxshell as vx
            >>> body = vx.World().add(vx.Box((1, 1, 1)))
            >>> body.orientation_xyzw = (0, 0, math.sqrt(0.5), math.sqrt(0.5))
            >>> body.orientation_xyzw.round(6)
            array([0.      , 0.      , 0.707107, 0.707107])
        """
        return _read_only(xyzw_from_rotation(self._simulation.pose(self.number)[:3, :3]))

    @orientation_xyzw.setter
    def orientation_xyzw(self, value: ArrayLike) -> None:
        position = self._simulation.pose(self.number)[:3, 3]
        self.pose = make_pose(position, xyzw=value)

    @property
    def linear_velocity(self) -> NDArray[np.float64]:
        """Velocity of the center of mass, (3,) float64, m/s, world frame, read-only; settable.

        Of kinematic bodies, whose origin takes the place of a centre of mass, that of the last step.

        Raises:
            SettingsError: It is set of a body that is not dynamic, or to what is not three numbers.
        """
        return _read_only(np.array(self._simulation.linear_velocity(self.number)))

    @linear_velocity.setter
    def linear_velocity(self, value: ArrayLike) -> None:
        velocity = as_vector(value, "linear_velocity")
        self._moved_by_forces("linear_velocity").set_linear_velocity(self.number, velocity)

    @property
    def angular_velocity(self) -> NDArray[np.float64]:
        """Angular velocity, (3,) float64, rad/s, world frame, read-only; settable.

        Raises:
            SettingsError: It is set of a body that is not dynamic, or to what is not three numbers.
        """
        return _read_only(np.array(self._simulation.angular_velocity(self.number)))

    @angular_velocity.setter
    def angular_velocity(self, value: ArrayLike) -> None:
        velocity = as_vector(value, "angular_velocity")
        self._moved_by_forces("angular_velocity").set_angular_velocity(self.number, velocity)

    def velocity_at(self, point: ArrayLike) -> NDArray[np.float64]:
        """Returns the velocity of the place of the body that is at a point now.

        Args:
            point: (3,), metres, world frame; it may lie outside the body.

        Returns:
            (3,) float64, m/s, world frame, read-only. A kinematic body has the velocity of its last step.

        Raises:
            SettingsError: ``point`` is not three finite numbers.

        Example:
            >>> import voxshell as vx
            >>> wheel = vx.World().add(vx.Cylinder(0.5, 0.1))
            >>> wheel.angular_velocity = (0, 0, 2.0)
            >>> wheel.velocity_at((0.5, 0, 0)).round(9) + 0.0
            array([0., 1., 0.])
        """
        place = as_vector(point, "point")
        pose = self._simulation.pose(self.number)
        center = pose[:3, :3] @ self._center + pose[:3, 3]
        turning = np.cross(self._simulation.angular_velocity(self.number), place - center)
        return _read_only(np.array(self._simulation.linear_velocity(self.number)) + turning)

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Lowest and highest corner of a box along the world's axes that holds it, (2, 3), metres.

        Up to some millimetres larger than the body. Those of a plane have no end: 1e18.

        Example:
            >>> import voxshell as vx
            >>> body = vx.World().add(vx.Sphere(0.25), pose=np.diag([1.0, 1.0, 1.0, 1.0]))
            >>> body.bounds.tolist()
            [[-0.25, -0.25, -0.25], [0.25, 0.25, 0.25]]
        """
        return _read_only(np.array(self._simulation.bounds(self.number)))

    @property
    def sleeping(self) -> bool:
        """Whether Bullet has put the body to sleep."""
        return self._simulation.is_asleep(self.number)

    def wake(self) -> None:
        """Wakes a sleeping body, as what touches it does."""
        self._simulation.wake(self.number)

    def apply_force(self, force: ArrayLike, *, at: ArrayLike | None = None) -> None:
        """Pushes the body during the next step; call it before every step for a lasting force.

        Args:
            force: (3,), newtons, world frame.
            at: (3,), metres, world frame: the point that it acts on; the centre of mass by default.

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
            self.number, as_vector(force, "force"), _as_place(at)
        )

    def apply_torque(self, torque: ArrayLike) -> None:
        """Turns the body during the next step.

        Args:
            torque: (3,), newton metres, world frame.

        Raises:
            SettingsError: The body is not dynamic, or ``torque`` is not three finite numbers.
        """
        self._moved_by_forces("a torque").apply_torque(self.number, as_vector(torque, "torque"))

    def apply_impulse(
        self,
        impulse: ArrayLike,
        *,
        at: ArrayLike | None = None,
    ) -> None:
        """Changes the velocities at once, as a blow does.

        Args:
            impulse: (3,), newton seconds, world frame.
            at: (3,), meters, world frame: the point that is hit; the center of mass by default.

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
            self.number, as_vector(impulse, "impulse"), _as_place(at)
        )

    def apply_torque_impulse(self, impulse: ArrayLike) -> None:
        """Changes the angular velocity at once.

        Args:
            impulse: (3,), newton metre seconds, world frame.

        Raises:
            SettingsError: The body is not dynamic, or ``impulse`` is not three finite numbers.
        """
        self._moved_by_forces("an impulse").apply_torque_impulse(
            self.number, as_vector(impulse, "impulse")
        )

    @property
    def friction(self) -> float:
        """Coulomb coefficient; Bullet multiplies those of the two bodies."""
        return self._simulation.material(self.number).friction

    @friction.setter
    def friction(self, value: float) -> None:
        self._set(friction=as_not_negative(value, "friction"))

    @property
    def rolling_friction(self) -> float:
        """Lever of the torque that withstands rolling on a body of friction 1, metres.

        That torque is at most the normal force times the sum of this times the other's friction and
        the other's rolling friction times this body's friction.

        Example:
            A ball rolls on for ever, but with 2 mm it stops:

            >>> import numpy as np
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> ground = world.add(vx.Plane(), mass=0)
            >>> on_top = np.eye(4)
            >>> on_top[2, 3] = 0.1
            >>> ball = world.add(vx.Sphere(0.1), pose=on_top)
            >>> ball.linear_velocity, ball.angular_velocity = (0.1, 0, 0), (0, 1, 0)
            >>> world.step(400)
            >>> bool(ball.linear_velocity[0] > 0.099)
            True
            >>> ball.rolling_friction = 0.002
            >>> world.step(400)
            >>> bool(abs(ball.linear_velocity[0]) < 1e-4)
            True
        """
        return self._simulation.material(self.number).rolling_friction

    @rolling_friction.setter
    def rolling_friction(self, value: float) -> None:
        self._set(rolling_friction=as_not_negative(value, "rolling_friction"))

    @property
    def spinning_friction(self) -> float:
        """Lever of the torque that withstands spinning about the contact's normal, metres.

        As :attr:`rolling_friction`; Bullet's solver heeds it only where there is that, too.
        """
        return self._simulation.material(self.number).spinning_friction

    @spinning_friction.setter
    def spinning_friction(self, value: float) -> None:
        self._set(spinning_friction=as_not_negative(value, "spinning_friction"))

    @property
    def restitution(self) -> float:
        """0 to 1; Bullet multiplies those of the two bodies."""
        return self._simulation.material(self.number).restitution

    @restitution.setter
    def restitution(self, value: float) -> None:
        self._set(restitution=as_share(value, "restitution"))

    @property
    def linear_damping(self) -> float:
        """Share of the velocity that is lost in a second, 0 to 1."""
        return self._simulation.material(self.number).linear_damping

    @linear_damping.setter
    def linear_damping(self, value: float) -> None:
        self._set(linear_damping=as_share(value, "linear_damping"))

    @property
    def angular_damping(self) -> float:
        """Share of the angular velocity that is lost in a second, 0 to 1."""
        return self._simulation.material(self.number).angular_damping

    @angular_damping.setter
    def angular_damping(self, value: float) -> None:
        self._set(angular_damping=as_share(value, "angular_damping"))

    @property
    def surface_velocity(self) -> NDArray[np.float64]:
        """Of a kinematic body's surface while the body stays, (3,) float64, m/s, body frame.

        Friction takes along what touches the body, as a conveyor's belt does. The part along a
        contact's normal does not count.

        Raises:
            SettingsError: It is set to what is not three finite numbers, or to other than 0 of a body that
                is not kinematic or in a world with another solver than "coulomb" or with one friction
                direction.

        Example:
            A belt takes a parcel along at 0.5 m/s:

            >>> import numpy as np
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> box = vx.Box((1.0, 0.2, 0.05))
            >>> belt = world.add(box, motion="kinematic", surface_velocity=(0.5, 0, 0))
            >>> on_it = np.eye(4)
            >>> on_it[:3, 3] = -0.5, 0.0, 0.1
            >>> parcel = world.add(vx.Box((0.05, 0.05, 0.05)), pose=on_it)
            >>> world.step(200)
            >>> bool(abs(parcel.linear_velocity[0] - 0.5) < 0.01)
            True
            >>> float(belt.pose[0, 3])
            0.0
        """
        return _read_only(np.array(self._simulation.material(self.number).surface_velocity))

    @surface_velocity.setter
    def surface_velocity(self, value: ArrayLike) -> None:
        velocity = as_vector(value, "surface_velocity")
        if any(velocity):
            check_surface(self.motion, repr(self.name), self._moves_surfaces)
        self._set(surface_velocity=velocity)

    @property
    def group(self) -> int:
        """Bits of the groups that it is in; bodies meet if each is in a group of the other's mask.

        Example:
            Ghosts fall through each other, but not through the ground:

            >>> import voxshell as vx
            >>> world = vx.World()
            >>> ground = world.add(vx.Plane(), mass=0)
            >>> ghosts = [world.add(vx.Sphere(0.1), group=2, mask=1) for _ in range(2)]
            >>> world.overlaps(*ghosts)
            True
            >>> world.step(300)
            >>> sorted({(int(c["body_a"]), int(c["body_b"])) for c in world.contacts()})
            [(1, 0), (2, 0)]
        """
        return self._simulation.material(self.number).group

    @group.setter
    def group(self, value: int) -> None:
        self._set(group=as_groups(value, "group"))

    @property
    def mask(self) -> int:
        """Bits of the groups that it meets; all by default."""
        return self._simulation.material(self.number).mask

    @mask.setter
    def mask(self, value: int) -> None:
        self._set(mask=as_groups(value, "mask"))

    def _set(self, **changes: object) -> None:
        material = self._simulation.material(self.number)
        for name, value in changes.items():
            setattr(material, name, value)
        self._simulation.set_material(self.number, material)

    def _moved_by_forces(self, what: str) -> _bullet.Simulation:
        if self.motion == "static":
            raise SettingsError(f"body {self.name!r} is static: {what} cannot move it")
        if self.motion == "kinematic":
            raise SettingsError(
                f"body {self.name!r} is kinematic: set its pose before each step, not {what}"
            )
        return self._simulation

    def __repr__(self) -> str:
        what = f"Body({self.number}, {self.name!r}, {self.shape!r}, "
        matter = f"mass={self.mass:g} kg" if self.motion == "dynamic" else self.motion
        if self.removed:
            return f"{what}{matter}, removed)"
        x, y, z = (self._simulation.pose(self.number)[:3, 3] + 0.0).tolist()
        return f"{what}{matter}, position=({x:.4g}, {y:.4g}, {z:.4g}) m)"


def as_mass_and_motion(mass: float, motion: Motion | None) -> tuple[float, Motion]:
    """Kilograms, 0 of what forces do not move, and who moves a body; by its mass, if nobody says."""
    kilograms = as_not_negative(mass, "mass")
    if motion is None:
        motion = "dynamic" if kilograms > 0.0 else "static"
    elif motion not in MOTIONS:
        raise SettingsError(
            f"motion must be one of {', '.join(map(repr, MOTIONS))}, not {motion!r}"
        )
    elif motion == "dynamic" and kilograms == 0.0:
        raise SettingsError("mass must be above 0 for a body that forces move")
    return (kilograms if motion == "dynamic" else 0.0), motion


def make_material(
    *,
    friction: float,
    rolling_friction: float,
    spinning_friction: float,
    restitution: float,
    linear_damping: float,
    angular_damping: float,
    group: int,
    mask: int,
    surface_velocity: ArrayLike,
) -> _bullet.BodyMaterial:
    """What a body has beside its matter, checked."""
    material = _bullet.BodyMaterial()
    material.friction = as_not_negative(friction, "friction")
    material.rolling_friction = as_not_negative(rolling_friction, "rolling_friction")
    material.spinning_friction = as_not_negative(spinning_friction, "spinning_friction")
    material.restitution = as_share(restitution, "restitution")
    material.linear_damping = as_share(linear_damping, "linear_damping")
    material.angular_damping = as_share(angular_damping, "angular_damping")
    material.group = as_groups(group, "group")
    material.mask = as_groups(mask, "mask")
    material.surface_velocity = as_vector(surface_velocity, "surface_velocity")
    return material


def check_surface(motion: Motion, name: str, moves_surfaces: bool) -> None:
    """Whether a body's surface can move while the body stays.

    Raises:
        SettingsError: It cannot.
    """
    if motion != "kinematic":
        raise SettingsError(
            f"surface_velocity is for kinematic bodies and {name} is {motion}: pass motion='kinematic'"
        )
    if not moves_surfaces:
        raise SettingsError(
            "surface_velocity needs a world with solver='coulomb' and friction_directions=2"
        )


def as_share(value: float, name: str) -> float:
    """A number from 0 to 1."""
    share = as_real(value, name)
    if not 0.0 <= share <= 1.0:
        raise SettingsError(f"{name} must be from 0 to 1, not {share:g}")
    return share


def as_groups(value: int, name: str) -> int:
    """Up to 31 bits; all of them stand for every group."""
    return as_integer(value, name, 0, _ALL_GROUPS)


def _as_place(at: ArrayLike | None) -> tuple[float, float, float] | None:
    return None if at is None else as_vector(at, "at")


def _read_only(array: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same array, which refuses assignments: they would not reach the body."""
    array.setflags(write=False)
    return array
