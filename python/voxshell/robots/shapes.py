"""Shapes of links from their collision geometry."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from voxshell.base.arguments import as_integer, as_positive
from voxshell.errors import MemoryLimitError, MeshError, RobotError, SettingsError
from voxshell.model.meshes import Mesh
from voxshell.model.model import Model
from voxshell.model.shapes import Box, Capsule, Cylinder, Plane, Sphere
from voxshell.robots.description import MeshArrays, MeshFile, Primitive
from voxshell.robots.mesh_files import read_link_mesh, refuse_mesh
from voxshell.simulation.comparison_shapes import ConvexHull
from voxshell.simulation.compound import Compound, Part

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.robots.description import Collision, Geometry, RobotDescription
    from voxshell.robots.lumps import Lump

_DEFAULT_RESOLUTION = 100

_FLAT = 1e-6
"""Thickness of a mesh below which it lies in a plane, in diameters: files may have single precision."""

_SHEET_THICKNESS = 1.0 / 200.0
"""Of the hull of a flat mesh, in longest sides, as sheets of :meth:`voxshell.Model.from_mesh` have it."""

_ELLIPSOID_SUBDIVISIONS = 4
"""Subdivisions of an ellipsoid's mesh: 5120 triangles, within 0.06 % of its largest radius."""


@dataclass(frozen=True)
class MeshSettings:
    """How meshes become shapes; the arguments of the loaders.

    Raises:
        SettingsError: A setting is out of range.
    """

    voxel_size: float | None
    resolution: int | None
    mesh_as: Literal["model", "hull"]

    def __post_init__(self) -> None:
        if self.mesh_as not in ("model", "hull"):
            raise SettingsError(f"mesh_as must be 'model' or 'hull', not {self.mesh_as!r}")
        if self.voxel_size is not None:
            as_positive(self.voxel_size, "voxel_size")
        if self.resolution is not None:
            as_integer(self.resolution, "resolution", 2, 2**31 - 1)


class Shaper:
    """Makes shapes from the collision geometry of links."""

    def __init__(self, robot: RobotDescription, settings: MeshSettings) -> None:
        self._robot = robot
        self._voxel_size = settings.voxel_size
        self._resolution = settings.resolution
        if settings.voxel_size is None and settings.resolution is None:
            self._resolution = _DEFAULT_RESOLUTION
        self._mesh_as = settings.mesh_as
        self._made: dict[tuple[Geometry, bytes], Part] = {}

    def shape_of(self, lump: Lump) -> Part | Compound | Plane | None:
        """Return a lump's shape; None without a surface. A plane must be alone, at z = 0."""
        parts: list[tuple[Part, NDArray[np.float64]]] = []
        for name, lump_from_link in lump.links.items():
            for collision in self._robot.links[name].collisions:
                geometry = collision.geometry
                if isinstance(geometry, Primitive) and geometry.kind == "plane":
                    return Plane()
                place = lump_from_link @ collision.link_from_geometry
                parts.append(self._make(name, collision, place))
        if not parts:
            return None
        if len(parts) == 1 and np.array_equal(parts[0][1], np.eye(4)):
            return parts[0][0]
        return Compound(parts)

    def _make(
        self, link: str, collision: Collision, place: NDArray[np.float64]
    ) -> tuple[Part, NDArray[np.float64]]:
        geometry = collision.geometry
        if isinstance(geometry, (MeshFile, MeshArrays)):
            key = geometry, place.tobytes()
            if key not in self._made:
                self._made[key] = self._make_mesh(link, geometry, place)
            return self._made[key], np.eye(4)
        try:
            return self._make_primitive(geometry), place
        except (SettingsError, MeshError) as error:
            raise RobotError(f"{self._robot.links[link].owner}: {error}") from error

    def _make_primitive(self, geometry: Primitive) -> Part:
        match geometry.kind:
            case "box":
                return Box(np.array(geometry.sizes) / 2.0)
            case "sphere":
                return Sphere(geometry.sizes[0])
            case "cylinder":
                return Cylinder(*geometry.sizes)
            case "capsule":
                return Capsule(*geometry.sizes)
            case _:
                from trimesh.creation import icosphere

                ball = icosphere(subdivisions=_ELLIPSOID_SUBDIVISIONS)
                return self._shape_mesh(Mesh(ball.vertices * geometry.sizes, ball.faces))

    def _make_mesh(
        self, link: str, file: MeshFile | MeshArrays, place: NDArray[np.float64]
    ) -> Part:
        mesh = read_link_mesh(self._robot.links[link].owner, file)
        mesh = Mesh(mesh.vertices @ place[:3, :3].T + place[:3, 3], mesh.faces)
        try:
            normal = _find_flat_normal(mesh)
            if normal is None:
                return self._shape_mesh(mesh)
            self._robot.flat.append(link)
            return self._shape_sheet(mesh, normal)
        except MeshError as error:
            refuse_mesh(self._robot.links[link].owner, file, error)
        except MemoryLimitError as error:
            raise MemoryLimitError(f"{self._robot.path}: link {link!r}: {error}") from error

    def _shape_sheet(self, mesh: Mesh, normal: NDArray[np.float64]) -> Part:
        vertices, faces = mesh
        if self._mesh_as == "hull":
            half = 0.5 * _SHEET_THICKNESS * float(np.ptp(vertices, axis=0).max()) * normal
            return _make_hull(np.concatenate([vertices - half, vertices + half]))
        a, b, c = (vertices[faces[:, corner]] for corner in range(3))
        up = np.cross(b - a, c - a) @ normal > 0.0
        # Both sides of a closed mesh are the same surface.
        return self._shape_mesh(Mesh(vertices, faces[up] if up.any() else faces), open="sheet")

    def _shape_mesh(self, mesh: Mesh, open: Literal["auto", "sheet"] = "auto") -> Part:  # noqa: A002
        if self._mesh_as == "hull":
            return _make_hull(mesh.vertices)
        voxel_size = self._voxel_size
        side = float(np.ptp(mesh.vertices, axis=0).max()) if len(mesh.vertices) > 0 else 0.0
        if voxel_size is not None and side > 0.0:
            voxel_size = min(voxel_size, side)
        return Model.from_mesh(mesh, voxel_size=voxel_size, resolution=self._resolution, open=open)


def _find_flat_normal(mesh: Mesh) -> NDArray[np.float64] | None:
    """Return the unit normal of a mesh in a plane, (3,); None if it has a volume, or is a wire."""
    if len(mesh.faces) == 0:
        return None
    used = mesh.vertices[np.unique(mesh.faces)]
    _, spread, axes = np.linalg.svd(used - used.mean(axis=0), full_matrices=False)
    is_flat = len(spread) == 3 and spread[1] > _FLAT * spread[0] >= spread[2]
    return axes[2] if is_flat else None


def _make_hull(vertices: NDArray[np.float64]) -> ConvexHull:
    try:
        return ConvexHull(vertices)
    except MeshError as error:
        raise MeshError(f"{error}; repair the mesh, or give it a thickness") from None
