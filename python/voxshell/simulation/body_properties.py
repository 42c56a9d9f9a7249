"""Properties of a body other than shape, mass and motion: material, damping, surface, groups."""

from __future__ import annotations

from dataclasses import asdict, fields
from typing import TYPE_CHECKING

import numpy as np

from voxshell import _bullet
from voxshell.base.arguments import as_fraction, as_integer, as_not_negative, as_vector
from voxshell.simulation.material import Material, as_material
from voxshell.simulation.motion import check_surface
from voxshell.simulation.world_part import WorldPart

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from voxshell.simulation.motion import Motion

ALL_GROUPS = 2**31 - 1
"""The mask with which a body collides with bodies of every group."""


class BodyProperties(WorldPart):
    """Properties that can change while a body is in its world."""

    __slots__ = ("_motion", "_moves_surfaces", "_number")

    def __init__(
        self,
        simulation: _bullet.Simulation,
        number: int,
        name: str,
        motion: Motion,
        moves_surfaces: bool,
    ) -> None:
        super().__init__(simulation, name)
        self._number = number
        self._motion: Motion = motion
        self._moves_surfaces = moves_surfaces

    @property
    def number(self) -> int:
        """The number that identifies the body in ``World.contacts()`` and other results.

        Numbers are never reused in a world. The number is the index in ``World.bodies`` until a
        body is removed.
        """
        return self._number

    @property
    def motion(self) -> Motion:
        """What moves the body: "dynamic" (forces), "static" (nothing), "kinematic" (the user)."""
        return self._motion

    @property
    def material(self) -> Material:
        """Friction and restitution as one value: the four properties below; settable.

        Raises:
            InputTypeError: The new value is not a :class:`Material`.

        Example:
            >>> import voxshell as vx
            >>> body = vx.World().add(vx.Sphere(0.1), friction=0.3)
            >>> body.material.friction
            0.3
            >>> body.material = vx.Material(friction=1.0, restitution=0.5)
            >>> body.restitution
            0.5
        """
        material = self._simulation.material(self.number)
        return Material(*(getattr(material, one.name) for one in fields(Material)))

    @material.setter
    def material(self, value: Material) -> None:
        self._set(**asdict(as_material(value)))

    @property
    def friction(self) -> float:
        """Coulomb's coefficient; Bullet multiplies those of both bodies."""
        return self._simulation.material(self.number).friction

    @friction.setter
    def friction(self, value: float) -> None:
        self._set(friction=as_not_negative(value, "friction"))

    @property
    def rolling_friction(self) -> float:
        """Lever arm of the torque that resists rolling on a body with friction 1, meters.

        The largest torque is the normal force times a sum: this times the other body's friction,
        plus the other body's rolling friction times this body's friction.

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
        """Lever arm of the torque that resists spinning about the contact's normal, meters.

        See :attr:`rolling_friction`. Bullet's solver applies it only together with rolling
        friction.
        """
        return self._simulation.material(self.number).spinning_friction

    @spinning_friction.setter
    def spinning_friction(self, value: float) -> None:
        self._set(spinning_friction=as_not_negative(value, "spinning_friction"))

    @property
    def restitution(self) -> float:
        """Restitution, 0 to 1; Bullet multiplies those of both bodies."""
        return self._simulation.material(self.number).restitution

    @restitution.setter
    def restitution(self, value: float) -> None:
        self._set(restitution=as_fraction(value, "restitution"))

    @property
    def linear_damping(self) -> float:
        """Fraction of the velocity that is lost in a second, 0 to 1."""
        return self._simulation.material(self.number).linear_damping

    @linear_damping.setter
    def linear_damping(self, value: float) -> None:
        self._set(linear_damping=as_fraction(value, "linear_damping"))

    @property
    def angular_damping(self) -> float:
        """Fraction of the angular velocity that is lost in a second, 0 to 1."""
        return self._simulation.material(self.number).angular_damping

    @angular_damping.setter
    def angular_damping(self, value: float) -> None:
        self._set(angular_damping=as_fraction(value, "angular_damping"))

    @property
    def surface_velocity(self) -> NDArray[np.float64]:
        """Velocity of a kinematic body's surface, as of a conveyor; (3,) float64, m/s, body frame.

        The body itself stays, and friction moves what touches it. The component along a contact's
        normal has no effect.

        Raises:
            SettingsError: The new value is not three finite numbers. Or it is not zero, and the
                body is not kinematic, the world's solver is not "coulomb", or the world has one
                friction direction.

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
        return read_only(np.array(self._simulation.material(self.number).surface_velocity))

    @surface_velocity.setter
    def surface_velocity(self, value: ArrayLike) -> None:
        velocity = as_vector(value, "surface_velocity", " in m/s")
        if any(velocity):
            check_surface(self.motion, repr(self.name), self._moves_surfaces)
        self._set(surface_velocity=velocity)

    @property
    def group(self) -> int:
        """Bit mask of the body's groups. Bodies collide if each is in a group of the other's mask.

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
        self._set_groups(group=as_groups(value, "group"))

    @property
    def mask(self) -> int:
        """Bit mask of the groups that the body collides with; all by default."""
        return self._simulation.material(self.number).mask

    @mask.setter
    def mask(self, value: int) -> None:
        self._set_groups(mask=as_groups(value, "mask"))

    def _set_groups(self, **changes: int) -> None:
        self._set(**changes)

    def _set(self, **changes: object) -> None:
        material = self._simulation.material(self.number)
        for name, value in changes.items():
            setattr(material, name, value)
        self._simulation.set_material(self.number, material)


def make_properties(
    material: Material,
    *,
    linear_damping: float,
    angular_damping: float,
    surface_velocity: ArrayLike,
    group: int,
    mask: int,
) -> _bullet.BodyMaterial:
    """Return the properties of a new body as the bindings take them.

    Raises:
        SettingsError: A number is out of range.
    """
    properties = _bullet.BodyMaterial()
    for name, value in asdict(material).items():
        setattr(properties, name, value)
    properties.linear_damping = as_fraction(linear_damping, "linear_damping")
    properties.angular_damping = as_fraction(angular_damping, "angular_damping")
    properties.surface_velocity = as_vector(surface_velocity, "surface_velocity", " in m/s")
    properties.group = as_groups(group, "group")
    properties.mask = as_groups(mask, "mask")
    return properties


def as_groups(value: int, name: str) -> int:
    """Return a mask of up to 31 bits; all of them together stand for every group."""
    return as_integer(value, name, 0, ALL_GROUPS)


def read_only(array: NDArray[np.float64]) -> NDArray[np.float64]:
    """Make an array read-only: assigning to its entries would not change the body."""
    array.setflags(write=False)
    return array
