"""Settings of a scene file's bodies."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from voxshell.base.arguments import as_fraction, as_not_negative, as_positive, as_real
from voxshell.errors import SettingsError
from voxshell.scenes.scene_settings import check_vector
from voxshell.simulation.body_properties import ALL_GROUPS, as_groups
from voxshell.simulation.material import Material
from voxshell.simulation.motion import Motion, as_mass_and_motion

if TYPE_CHECKING:
    from numpy.typing import NDArray

SHAPES = {
    "plane": ("normal", "offset"),
    "box": ("half_extents",),
    "sphere": ("radius",),
    "capsule": ("radius", "length"),
    "cylinder": ("radius", "length"),
    "cone": ("radius", "height"),
}
"""Settings of each shape; for a plane they are optional."""

_UNIT_TOLERANCE = 1e-3


@dataclass(frozen=True)
class PartSettings:
    """A mesh or a shape with its place: a body, or a table of its ``parts``.

    Attributes:
        mesh: Name of a table of ``[meshes]``. Alternative to ``shape``.
        shape: A shape, with these settings:
        normal, offset: Of a plane; offset in meters.
        half_extents: Of a box, three numbers, meters.
        radius: Of a sphere, capsule, cylinder or cone, meters.
        length: Of a capsule, without its caps, or of a cylinder, meters.
        height: Of a cone, meters.
        position: Of its origin, three numbers, meters; of a body in the world, of a part in its
            body.
        quaternion_xyzw: Orientation as a unit quaternion.
        rotation_vector: Alternative to it: axis times angle, radians.
    """

    mesh: str | None = None
    shape: Literal["plane", "box", "sphere", "capsule", "cylinder", "cone"] | None = None
    normal: tuple[float, ...] | None = None
    offset: float | None = None
    half_extents: tuple[float, ...] | None = None
    radius: float | None = None
    length: float | None = None
    height: float | None = None
    position: tuple[float, ...] = (0.0, 0.0, 0.0)
    quaternion_xyzw: tuple[float, ...] | None = None
    rotation_vector: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        self._check_kind()
        self._check_shape()
        check_vector(self.position, "position")
        if self.rotation_vector is not None:
            if self.quaternion_xyzw is not None:
                raise SettingsError("rotation_vector and quaternion_xyzw cannot both be given")
            check_vector(self.rotation_vector, "rotation_vector")
        if self.quaternion_xyzw is not None:
            check_vector(self.quaternion_xyzw, "quaternion_xyzw", 4)
            length = math.hypot(*self.quaternion_xyzw)
            if abs(length - 1.0) > _UNIT_TOLERANCE:
                raise SettingsError(f"quaternion_xyzw must have length 1, not {length:.6g}")

    @property
    def pose(self) -> NDArray[np.float64]:
        """``world_from_body`` at the start, or ``body_from_part``, (4, 4)."""
        from trimesh.transformations import quaternion_matrix, rotation_matrix

        pose: NDArray[np.float64] = np.eye(4)
        if self.quaternion_xyzw is not None:
            x, y, z, w = self.quaternion_xyzw
            pose = quaternion_matrix([w, x, y, z])
        elif self.rotation_vector is not None and any(self.rotation_vector):
            pose = rotation_matrix(math.hypot(*self.rotation_vector), self.rotation_vector)
        pose[:3, 3] = self.position
        return pose

    def _check_kind(self) -> None:
        if (self.mesh is None) == (self.shape is None):
            raise SettingsError("shape or mesh must be given, but not both")

    def _check_shape(self) -> None:
        """Check that the given numbers belong to the shape, and are in range."""
        takes = () if self.shape is None else SHAPES[self.shape]
        kind = "mesh" if self.mesh is not None else "body of parts"
        what = f"a {kind if self.shape is None else self.shape}"
        for name in ("normal", "offset", "half_extents", "radius", "length", "height"):
            value = getattr(self, name)
            if value is not None and name not in takes:
                raise SettingsError(f"{name} is not a setting of {what}")
            if value is None and name in takes and self.shape != "plane":
                raise SettingsError(f"{name} must be given for {what}")
        if self.normal is not None:
            check_vector(self.normal, "normal")
            if not any(self.normal):
                raise SettingsError("normal must have a length above 0")
        if self.half_extents is not None:
            check_vector(self.half_extents, "half_extents")
            if min(self.half_extents) <= 0.0:
                raise SettingsError(f"half_extents must be above 0, not {list(self.half_extents)}")
        if self.offset is not None:
            as_real(self.offset, "offset")
        for name in ("radius", "height"):
            if getattr(self, name) is not None:
                as_positive(getattr(self, name), name)
        if self.length is not None:
            as_not_negative(self.length, "length")


@dataclass(frozen=True)
class BodySettings(PartSettings):
    """A table ``[bodies.NAME]``: a body with a mesh, a shape, or parts.

    Attributes:
        parts: Tables ``[[bodies.NAME.parts]]``: several meshes and shapes that are one body.
            Alternative to ``mesh`` and ``shape``.
        mass: Kilograms; 0 makes the body static. Planes have no mass.
        motion: What moves the body, as for :meth:`voxshell.World.add`; decided by the mass by
            default. A kinematic body keeps its velocities, whatever it meets.
        inertia: Of the solid, or of a thin skin on the surface.
        friction, rolling_friction, spinning_friction, restitution: As for
            :meth:`voxshell.World.add`; spinning friction has an effect only together with rolling
            friction.
        linear_velocity, angular_velocity: Of a dynamic body at the start, of a kinematic body
            throughout; m/s and rad/s, world frame. The linear one is that of the center of mass,
            and of a kinematic body's origin.
        surface_velocity: Of a kinematic body, such as a conveyor, m/s, body frame.
        linear_damping, angular_damping: Fractions of the velocities that are lost in a second.
        group, mask: Bits of the groups that the body is in, and of those that it collides with, as
            for :meth:`voxshell.World.add`.
        color: Red, green and blue, 0 to 255, in the replay.
    """

    parts: tuple[PartSettings, ...] = ()
    mass: float | None = None
    motion: Motion | None = None
    inertia: Literal["solid", "surface"] = "solid"
    friction: float = 0.5
    rolling_friction: float = 0.0
    spinning_friction: float = 0.0
    restitution: float = 0.0
    linear_velocity: tuple[float, ...] = (0.0, 0.0, 0.0)
    angular_velocity: tuple[float, ...] = (0.0, 0.0, 0.0)
    surface_velocity: tuple[float, ...] = (0.0, 0.0, 0.0)
    linear_damping: float = 0.0
    angular_damping: float = 0.0
    group: int = 1
    mask: int = ALL_GROUPS
    color: tuple[int, ...] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.mass is not None and not as_real(self.mass, "mass") >= 0.0:
            raise SettingsError(f"mass must be at least 0 kg (0: static), not {self.mass:g}")
        if self.shape == "plane" and self.mass:
            raise SettingsError("mass of a plane must be 0: it is unbounded and cannot move")
        if self.shape == "plane" and self.motion not in (None, "static"):
            raise SettingsError(
                "motion of a plane must be 'static': it is unbounded and cannot move"
            )
        if self.motion == "dynamic" and self.mass == 0.0:
            raise SettingsError("mass of a dynamic body must be above 0 kg")
        _ = self.material  # checks its numbers
        for name in ("linear_velocity", "angular_velocity"):
            check_vector(getattr(self, name), name)
            is_still = self.kilograms == 0.0 and self.motion != "kinematic"
            if is_still and any(getattr(self, name)):
                raise SettingsError(
                    f"{name} is for dynamic and kinematic bodies, and this body is static"
                )
        check_vector(self.surface_velocity, "surface_velocity")
        if any(self.surface_velocity) and self.motion != "kinematic":
            raise SettingsError("surface_velocity is for bodies with motion = 'kinematic'")
        for name in ("linear_damping", "angular_damping"):
            as_fraction(getattr(self, name), name)
        for name in ("group", "mask"):
            as_groups(getattr(self, name), name)
        if self.color is not None and not (
            len(self.color) == 3 and all(0 <= channel <= 255 for channel in self.color)
        ):
            raise SettingsError(f"color must be three integers from 0 to 255, not {self.color}")

    @property
    def kilograms(self) -> float:
        """The body's mass: 1 kg by default; 0 for planes and all others that forces do not move."""
        mass = self.mass
        if mass is None:
            mass = 0.0 if self.shape == "plane" else 1.0
        return as_mass_and_motion(mass, self.motion)[0]

    @property
    def moves_by_itself(self) -> bool:
        """True if the body has a velocity at the start."""
        return any(self.linear_velocity) or any(self.angular_velocity)

    @property
    def material(self) -> Material:
        """The body's friction and restitution."""
        return Material(
            self.friction, self.restitution, self.rolling_friction, self.spinning_friction
        )

    def _check_kind(self) -> None:
        given = [name for name in ("shape", "mesh", "parts") if getattr(self, name)]
        if len(given) != 1:
            raise SettingsError("shape must be given, or mesh or parts, but only one of them")
        for index, part in enumerate(self.parts):
            if part.shape == "plane":
                raise SettingsError(f"parts[{index}].shape must not be a plane, which is unbounded")
