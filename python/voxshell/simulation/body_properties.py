"""What a body has beside its shape and matter: material, damping, a moving surface, groups."""

from __future__ import annotations

from dataclasses import asdict, fields
from typing import TYPE_CHECKING

import numpy as np

from voxshell import _bullet
from voxshell.base.arguments import as_integer, as_not_negative, as_share, as_vector
from voxshell.simulation.material import Material, as_material
from voxshell.simulation.motion import check_surface
from voxshell.simulation.part import WorldPart

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from voxshell.simulation.motion import Motion

_ALL_GROUPS = 2**31 - 1


class BodyProperties(WorldPart):
    """Those properties of a body that can be changed while it is in its world, its motion apart."""

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
        """What ``World.contacts()`` and other results call it; no two bodies of a world have had the same.

        It is the body's place in ``World.bodies`` as long as none is removed.
        """
        return self._number

    @property
    def motion(self) -> Motion:
        """Who moves it: "dynamic" (forces), "static" (nobody), "kinematic" (the user)."""
        return self._motion

    @property
    def material(self) -> Material:
        """How it rubs and rebounds: the four properties below as one value; settable.

        Raises:
            InputTypeError: It is set to anything but a :class:`Material`.

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
        return read_only(np.array(self._simulation.material(self.number).surface_velocity))

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


def make_properties(
    material: Material,
    *,
    linear_damping: float,
    angular_damping: float,
    surface_velocity: ArrayLike,
    group: int,
    mask: int,
) -> _bullet.BodyMaterial:
    """The properties of a new body as the bindings take them.

    Raises:
        SettingsError: A number is out of range.
    """
    properties = _bullet.BodyMaterial()
    for name, value in asdict(material).items():
        setattr(properties, name, value)
    properties.linear_damping = as_share(linear_damping, "linear_damping")
    properties.angular_damping = as_share(angular_damping, "angular_damping")
    properties.surface_velocity = as_vector(surface_velocity, "surface_velocity")
    properties.group = as_groups(group, "group")
    properties.mask = as_groups(mask, "mask")
    return properties


def as_groups(value: int, name: str) -> int:
    """Up to 31 bits; all of them stand for every group."""
    return as_integer(value, name, 0, _ALL_GROUPS)


def read_only(array: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same array, which refuses assignments: they would not reach the body."""
    array.setflags(write=False)
    return array
