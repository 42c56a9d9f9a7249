"""Analytic shapes: exact fields that need no mesh. They have no point shell."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from voxshell._core import (
    box_field,
    capsule_field,
    cone_field,
    convex_field,
    cylinder_field,
    plane_field,
    sphere_field,
)
from voxshell.base.arguments import FARTHEST, as_length, as_real, as_vector
from voxshell.base.calls import explain_calls
from voxshell.errors import SettingsError
from voxshell.model.field import Field
from voxshell.model.meshes import Mesh, naming_file, read_mesh

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from voxshell.model.meshes import MeshLike


_HALF_EXTENTS = " in meters, half of the edge lengths along x, y and z"


@explain_calls
class Plane(Field):
    """The half-space below a plane: an infinite solid ground.

    The points p on its surface satisfy ``normal . p == offset``.

    Args:
        normal: (3,), pointing out of the solid, body frame. It may have any nonzero length; it is
            normalized.
        offset: Signed distance of the surface from the origin along the unit normal, meters.

    Raises:
        SettingsError: ``normal`` is zero, or a number is not finite.

    Example:
        >>> import voxshell as vx
        >>> vx.Plane(normal=(0, 0, 1), offset=0.5).sample([[3, 4, 2]])
        array([1.5])
    """

    __slots__ = ("_given", "_normal", "_offset")

    def __init__(self, normal: ArrayLike = (0.0, 0.0, 1.0), offset: float = 0.0) -> None:
        # A copy is made from the vector that was given, because normalizing twice may change bits.
        self._given = x, y, z = as_vector(normal, "normal")
        largest = max(abs(x), abs(y), abs(z))
        if largest == 0.0:
            raise SettingsError("normal must not be zero: it says which side of the plane is solid")
        # Normalize in two steps, so that no square overflows or underflows.
        x, y, z = x / largest, y / largest, z / largest
        length = math.sqrt(x * x + y * y + z * z)
        self._normal = (x / length, y / length, z / length)
        self._offset = as_real(offset, "offset")
        if abs(self._offset) > FARTHEST:
            raise SettingsError(f"offset must be within {FARTHEST:g} m, not {self._offset:g}")
        super().__init__(plane_field(self._normal, self._offset))

    @property
    def normal(self) -> NDArray[np.float64]:
        """Unit normal, pointing out of the solid, (3,) float64, body frame."""
        return np.array(self._normal)

    @property
    def offset(self) -> float:
        """Signed distance of the surface from the origin along the normal, meters."""
        return self._offset

    def __reduce__(self) -> tuple[type[Plane], tuple[tuple[float, float, float], float]]:
        return type(self), (self._given, self._offset)

    def __repr__(self) -> str:
        return f"Plane(normal={_round(self._normal)}, offset={self._offset:g})"


@explain_calls
class Box(Field):
    """A solid box of given half extents, centered at its origin and aligned with its axes.

    A box takes half of its edge lengths, whereas a cylinder takes its whole length.

    Args:
        half_extents: (3,), half of the edge lengths along x, y and z, meters.

    Raises:
        SettingsError: A half extent is not above 0.

    Example:
        >>> import voxshell as vx
        >>> vx.Box(half_extents=(1, 2, 3)).sample([[0, 0, 4], [0, 0, 0]])
        array([ 1., -1.])
    """

    __slots__ = ("_half_extents",)

    def __init__(self, half_extents: ArrayLike) -> None:
        x, y, z = as_vector(half_extents, "half_extents", _HALF_EXTENTS)
        self._half_extents = (
            as_length(x, "half_extents[0]"),
            as_length(y, "half_extents[1]"),
            as_length(z, "half_extents[2]"),
        )
        super().__init__(box_field(self._half_extents))

    @property
    def half_extents(self) -> NDArray[np.float64]:
        """Half of the edge lengths along x, y and z, (3,) float64, meters."""
        return np.array(self._half_extents)

    def __reduce__(self) -> tuple[type[Box], tuple[tuple[float, float, float]]]:
        return type(self), (self._half_extents,)

    def __repr__(self) -> str:
        return f"Box(half_extents={_round(self._half_extents)})"


@explain_calls
class Sphere(Field):
    """A solid sphere, centered at its origin.

    Args:
        radius: Meters.

    Raises:
        SettingsError: ``radius`` is not above 0.

    Example:
        >>> import voxshell as vx
        >>> vx.Sphere(radius=0.5).gradient([[0, -2, 0]])
        array([[ 0., -1.,  0.]])
    """

    __slots__ = ("_radius",)

    def __init__(self, radius: float) -> None:
        self._radius = as_length(radius, "radius")
        super().__init__(sphere_field(self._radius))

    @property
    def radius(self) -> float:
        """Meters."""
        return self._radius

    def __reduce__(self) -> tuple[type[Sphere], tuple[float]]:
        return type(self), (self._radius,)

    def __repr__(self) -> str:
        return f"Sphere(radius={self._radius:g})"


@explain_calls
class Capsule(Field):
    """A solid cylinder along z with a hemisphere on each end, centered at its origin.

    ``length`` is the whole length between the hemispheres, unlike the half extents of a box. With
    its caps, the capsule is ``length + 2 * radius`` long.

    Args:
        radius: Meters.
        length: Distance between the centers of the hemispheres, meters. It does not include the
            caps.

    Raises:
        SettingsError: ``radius`` or ``length`` is not above 0.

    Example:
        >>> import voxshell as vx
        >>> vx.Capsule(radius=1, length=4).sample([[0, 0, 5], [3, 0, 1]])
        array([2., 2.])
    """

    __slots__ = ("_length", "_radius")

    def __init__(self, radius: float, length: float) -> None:
        self._radius = as_length(radius, "radius")
        self._length = as_length(length, "length")
        super().__init__(capsule_field(self._radius, self._length))

    @property
    def radius(self) -> float:
        """Meters."""
        return self._radius

    @property
    def length(self) -> float:
        """Distance between the centers of the hemispheres, meters."""
        return self._length

    def __reduce__(self) -> tuple[type[Capsule], tuple[float, float]]:
        return type(self), (self._radius, self._length)

    def __repr__(self) -> str:
        return f"Capsule(radius={self._radius:g}, length={self._length:g})"


@explain_calls
class Cylinder(Field):
    """A solid cylinder of a given whole length along z, centered at its origin.

    It reaches from ``z = -length / 2`` to ``z = length / 2``. A box, in contrast, takes half of its
    edge lengths.

    Args:
        radius: Meters.
        length: Whole length along z, meters.

    Raises:
        SettingsError: ``radius`` or ``length`` is not above 0.

    Example:
        >>> import voxshell as vx
        >>> vx.Cylinder(radius=1, length=4).sample([[0, 0, 5], [4, 0, 6]])
        array([3., 5.])
    """

    __slots__ = ("_length", "_radius")

    def __init__(self, radius: float, length: float) -> None:
        self._radius = as_length(radius, "radius")
        self._length = as_length(length, "length")
        super().__init__(cylinder_field(self._radius, self._length))

    @property
    def radius(self) -> float:
        """Meters."""
        return self._radius

    @property
    def length(self) -> float:
        """Length along z, meters."""
        return self._length

    def __reduce__(self) -> tuple[type[Cylinder], tuple[float, float]]:
        return type(self), (self._radius, self._length)

    def __repr__(self) -> str:
        return f"Cylinder(radius={self._radius:g}, length={self._length:g})"


@explain_calls
class Cone(Field):
    """A solid cone along z: its base is at ``z = -height / 2``, its apex at ``z = height / 2``.

    Args:
        radius: Radius of the base, meters.
        height: Height along z, meters.

    Raises:
        SettingsError: ``radius`` or ``height`` is not above 0.

    Example:
        >>> import voxshell as vx
        >>> vx.Cone(radius=3, height=4).sample([[0, 0, 5], [0, 0, -4]])
        array([3., 2.])
    """

    __slots__ = ("_height", "_radius")

    def __init__(self, radius: float, height: float) -> None:
        self._radius = as_length(radius, "radius")
        self._height = as_length(height, "height")
        super().__init__(cone_field(self._radius, self._height))

    @property
    def radius(self) -> float:
        """Radius of the base, meters."""
        return self._radius

    @property
    def height(self) -> float:
        """Height along z, meters."""
        return self._height

    def __reduce__(self) -> tuple[type[Cone], tuple[float, float]]:
        return type(self), (self._radius, self._height)

    def __repr__(self) -> str:
        return f"Cone(radius={self._radius:g}, height={self._height:g})"


@explain_calls
class ConvexPolyhedron(Field):
    """A solid convex polyhedron: the largest of the signed distances to the planes of its faces.

    The distance is exact inside, and outside where the nearest point of the surface is on a face.
    Beyond edges and corners it is less than the true distance, so a margin does not round them.

    Args:
        mesh: Any mesh that :meth:`voxshell.Model.from_mesh` accepts, if it is closed, convex to
            within 1e-5 of its longest side, and has at most 4096 faces. To get the hull of points,
            use ``voxshell.ConvexHull(points).mesh``, which is accurate to 2e-4 of its size, or
            ``trimesh.convex.convex_hull(points)``.

    Raises:
        MissingFileError: A file does not exist.
        MeshError: The mesh cannot be read, is not closed, or is not convex. The message says by how
            much.
        MemoryLimitError: It has too many faces.
        InputTypeError: ``mesh`` is not a mesh.

    Example:
        >>> import trimesh
        >>> import voxshell as vx
        >>> box = vx.ConvexPolyhedron(trimesh.creation.box(extents=(2, 4, 6)))
        >>> box
        ConvexPolyhedron(6 faces)
        >>> box.sample([[0, 0, 5], [0, 0, 0]])
        array([ 2., -1.])
    """

    __slots__ = ("_face_count", "_mesh")

    def __init__(self, mesh: MeshLike) -> None:
        with naming_file(mesh):
            vertices, faces = read_mesh(mesh)
            core, self._face_count = convex_field(vertices, faces)
        vertices, faces = vertices.copy(), faces.copy()
        vertices.flags.writeable = faces.flags.writeable = False
        self._mesh = Mesh(vertices, faces)
        super().__init__(core)

    @property
    def mesh(self) -> Mesh:
        """The triangles as given: (n, 3) float64, meters, and (m, 3) uint32; read-only."""
        return self._mesh

    def __reduce__(self) -> tuple[type[ConvexPolyhedron], tuple[Mesh]]:
        return type(self), (self._mesh,)

    def __repr__(self) -> str:
        return f"ConvexPolyhedron({self._face_count} faces)"


def _round(numbers: tuple[float, ...]) -> tuple[float, ...]:
    """Return numbers for people, with six digits."""
    return tuple(float(f"{number:.6g}") for number in numbers)
