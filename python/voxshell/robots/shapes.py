"""Shapes of links from their collision geometry."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from voxshell.base.arguments import as_choice, as_integer, as_length, as_positive
from voxshell.errors import MemoryLimitError, MeshError, RobotError, SettingsError
from voxshell.model.build_settings import as_open, as_settings, as_sheet_thickness
from voxshell.model.build_warnings import find_flaws
from voxshell.model.building import build_core
from voxshell.model.meshes import Mesh, doubt_unit
from voxshell.model.model import Model
from voxshell.model.shapes import Box, Capsule, Cylinder, Plane, Sphere
from voxshell.robots.description import MeshArrays, MeshFile, Primitive
from voxshell.robots.link_meshes import read_link_mesh, refuse_mesh
from voxshell.robots.sheets import Sheet, find_sheet
from voxshell.simulation.comparison_shapes import ConvexHull
from voxshell.simulation.compound import Compound, Part

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.model.build_warnings import Finding
    from voxshell.robots.description import Collision, Geometry, RobotDescription
    from voxshell.robots.lumps import Lump

_DEFAULT_RESOLUTION = 100
"""Voxels along the longest side of a model. Models by the default tolerance take three to nine times as
long to build, measured with six robots."""

_REMEDY_FOR_UNITS = (
    'give the mesh scale="0.001 0.001 0.001" in the robot\'s file; if it is in meters, scale="1 1 1" '
    "silences this warning"
)

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
    tolerance: float | None = None
    open: Literal["auto", "solid", "sheet"] = "auto"
    sheet_thickness: float | None = None

    def __post_init__(self) -> None:
        as_choice(self.mesh_as, "mesh_as", ("model", "hull"))
        as_open(self.open)
        as_sheet_thickness(self.sheet_thickness, self.open)
        if self.tolerance is not None:
            as_length(self.tolerance, "tolerance")
        sizes = (self.tolerance, self.voxel_size, self.resolution)
        if sum(size is not None for size in sizes) > 1:
            raise SettingsError("give only one of tolerance, voxel_size and resolution")
        if self.voxel_size is not None:
            as_positive(self.voxel_size, "voxel_size")
        if self.resolution is not None:
            as_integer(self.resolution, "resolution", 2, 2**31 - 1)


class Shaper:
    """Makes shapes from the collision geometry of links."""

    def __init__(self, robot: RobotDescription, settings: MeshSettings) -> None:
        self._robot = robot
        self._tolerance = settings.tolerance
        self._voxel_size = settings.voxel_size
        self._resolution = settings.resolution
        if settings.tolerance is settings.voxel_size is settings.resolution is None:
            self._resolution = _DEFAULT_RESOLUTION
        self._mesh_as = settings.mesh_as
        self._open = settings.open
        self._sheet_thickness = settings.sheet_thickness
        self._made: dict[tuple[Geometry, bytes], _Made] = {}

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
            made = self._made[key]
            if made.sheet is not None:
                self._robot.flat[link] = made.sheet.thickness
            self._robot.note_flaws(link, geometry.path, made.flaws)
            return made.part, np.eye(4)
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
                return self._shape_mesh(Mesh(ball.vertices * geometry.sizes, ball.faces))[0]

    def _make_mesh(
        self, link: str, file: MeshFile | MeshArrays, place: NDArray[np.float64]
    ) -> _Made:
        mesh = read_link_mesh(self._robot.links[link].owner, file)
        if isinstance(file, MeshFile) and not file.has_scale:
            doubt = doubt_unit(file.path, mesh.vertices, _REMEDY_FOR_UNITS)
            if doubt and doubt not in self._robot.doubts:
                self._robot.doubts.append(doubt)
        mesh = Mesh(mesh.vertices @ place[:3, :3].T + place[:3, 3], mesh.faces)
        sheet = find_sheet(mesh, self._sheet_thickness)
        try:
            if sheet is None:
                return _Made(*self._shape_mesh(mesh), None)
            return _Made(*self._shape_sheet(sheet), sheet)
        except MeshError as error:
            refuse_mesh(self._robot.links[link].owner, file, error)
        except MemoryLimitError as error:
            raise MemoryLimitError(f"{self._robot.path}: link {link!r}: {error}") from error

    def _shape_sheet(self, sheet: Sheet) -> tuple[Part, list[Finding]]:
        if self._mesh_as == "hull":
            return _make_hull(sheet.find_points()), []
        built = build_core(
            sheet.mesh,
            as_settings(
                tolerance=self._tolerance, open_as="sheet", sheet_thickness=sheet.thickness
            ),
        )
        return _mark(Model(built.core)), find_flaws(built.core, built.widest_rim, open_as="sheet")

    def _shape_mesh(self, mesh: Mesh) -> tuple[Part, list[Finding]]:
        if self._mesh_as == "hull":
            return _make_hull(mesh.vertices), []
        voxel_size = self._voxel_size
        side = float(np.ptp(mesh.vertices, axis=0).max()) if len(mesh.vertices) > 0 else 0.0
        if voxel_size is not None and side > 0.0:
            voxel_size = min(voxel_size, side)
        built = build_core(
            mesh,
            as_settings(
                tolerance=self._tolerance,
                voxel_size=voxel_size,
                resolution=self._resolution,
                open_as=self._open,
                sheet_thickness=self._sheet_thickness,
            ),
        )
        flaws = find_flaws(built.core, built.widest_rim, open_as=self._open)
        return _mark(Model(built.core)), flaws


class _Made(NamedTuple):
    """The shape of a mesh, what is wrong with it, and the sheet that it is, if it is one."""

    part: Part
    flaws: list[Finding]
    sheet: Sheet | None


def _mark(model: Model) -> Model:
    model._is_of_robot = True
    return model


def _make_hull(vertices: NDArray[np.float64]) -> ConvexHull:
    try:
        return ConvexHull(vertices)
    except MeshError as error:
        raise MeshError(f"{error}; repair the mesh, or give it a thickness") from None
