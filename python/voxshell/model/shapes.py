"""Analytic shapes: exact fields that need no mesh. They have no point shell of their own."""

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
from voxshell.errors import SettingsError
from voxshell.model.field import Field
from voxshell.model.meshes import Mesh, naming_file, read_mesh

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from voxshell.model.meshes import MeshLike


class Plane(Field):
    """The half-space below a plane: a solid ground without an end.

    The points p on its surface satisfy ``normal . p == offset``.

    Args:
        normal: (3,), out of the solid, body frame; any length but 0, it is brought to 1.
        offset: Distance of the surface from the origin along the unit normal, metres.

    Raises:
        SettingsError: ``normal`` is zero, or a number is not finite.

    Example:
        >>> import voxshell as vx
        >>> vx.Plane(normal=(0, 0, 1), offset=0.5).sample([[3, 4, 2]])
        array([1.5])
    """

    __slots__ = ("_normal", "_offset")

    def __init__(self, normal: ArrayLike = (0.0, 0.0, 1.0), offset: float = 0.0) -> None:
        x, y, z = as_vector(normal, "normal")
        largest = max(abs(x), abs(y), abs(z))
        if largest == 0.0:
            raise SettingsError("normal must not be zero: it says which side of the plane is solid")
        # Divided twice, so that no square over- or underflows.
        x, y, z = x / largest, y / largest, z / largest
        length = math.sqrt(x * x + y * y + z * z)
        self._normal = (x / length, y / length, z / length)
        self._offset = as_real(offset, "offset")
        if abs(self._offset) > FARTHEST:
            raise SettingsError(f"offset must be within {FARTHEST:g} m, not {self._offset:g}")
        super().__init__(plane_field(self._normal, self._offset))

    @property
    def normal(self) -> NDArray[np.float64]:
        """Unit normal, out of the solid, (3,) float64, body frame."""
        return np.array(self._normal)

    @property
    def offset(self) -> float:
        """Distance of the surface from the origin along the normal, metres."""
        return self._offset

    def __repr__(self) -> str:
        return f"Plane(normal={self._normal}, offset={self._offset:g})"


class Box(Field):
    """A solid box, centred at its origin, along its axes.

    Args:
        half_extents: (3,), half of the lengths of its edges along x, y and z, metres.

    Raises:
        SettingsError: A half extent is not above 0.

    Example:
        >>> import voxshell as vx
        >>> vx.Box(half_extents=(1, 2, 3)).sample([[0, 0, 4], [0, 0, 0]])
        array([ 1., -1.])
    """

    __slots__ = ("_half_extents",)

    def __init__(self, half_extents: ArrayLike) -> None:
        x, y, z = as_vector(half_extents, "half_extents")
        self._half_extents = (
            as_length(x, "half_extents[0]"),
            as_length(y, "half_extents[1]"),
            as_length(z, "half_extents[2]"),
        )
        super().__init__(box_field(self._half_extents))

    @property
    def half_extents(self) -> NDArray[np.float64]:
        """Half of the edges along x, y and z, (3,) float64, metres."""
        return np.array(self._half_extents)

    def __repr__(self) -> str:
        return f"Box(half_extents={self._half_extents})"


class Sphere(Field):
    """A solid sphere, centred at its origin.

    Args:
        radius: Metres.

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
        """Metres."""
        return self._radius

    def __repr__(self) -> str:
        return f"Sphere(radius={self._radius:g})"


class Capsule(Field):
    """A solid cylinder along z with half a sphere on each end, centred at its origin.

    Args:
        radius: Metres.
        length: Between the centres of the half-spheres, metres: the caps are not in it.

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
        """Metres."""
        return self._radius

    @property
    def length(self) -> float:
        """Between the centres of the half-spheres, metres."""
        return self._length

    def __repr__(self) -> str:
        return f"Capsule(radius={self._radius:g}, length={self._length:g})"


class Cylinder(Field):
    """A solid cylinder along z, centred at its origin.

    Args:
        radius: Metres.
        length: Along z, metres.

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
        """Metres."""
        return self._radius

    @property
    def length(self) -> float:
        """Along z, metres."""
        return self._length

    def __repr__(self) -> str:
        return f"Cylinder(radius={self._radius:g}, length={self._length:g})"


class Cone(Field):
    """A solid cone about z: its base at ``z = -height / 2``, its apex at ``height / 2``.

    Args:
        radius: Of the base, metres.
        height: Along z, metres.

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
        """Of the base, metres."""
        return self._radius

    @property
    def height(self) -> float:
        """Along z, metres."""
        return self._height

    def __repr__(self) -> str:
        return f"Cone(radius={self._radius:g}, height={self._height:g})"


class ConvexPolyhedron(Field):
    """A solid convex polyhedron: the largest of the signed distances to its faces' planes.

    Exact inside and where the nearest point of the surface is on a face. Beyond edges and corners
    it is less than the true distance, so that a margin rounds nothing there.

    Args:
        mesh: As for :meth:`voxshell.Model.from_mesh`: closed, convex to 1e-5 of its longest side,
            of at most 4096 faces. For the hull of points: ``voxshell.ConvexHull(points).mesh``,
            which is good to 2e-4 of its size, or ``trimesh.convex.convex_hull(points)``.

    Raises:
        MeshError: The mesh cannot be read, is not closed, or is not convex; the message says by how
            much.
        MemoryLimitError: It has more faces.
        InputTypeError: ``mesh`` is no mesh.

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
        """The triangles as they were given: (n, 3) float64, metres, and (m, 3) uint32; read-only."""
        return self._mesh

    def __repr__(self) -> str:
        return f"ConvexPolyhedron({self._face_count} faces)"
