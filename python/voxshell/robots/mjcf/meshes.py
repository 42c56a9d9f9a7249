"""The meshes in a model's ``<asset>``."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np

from voxshell.base.arguments import FARTHEST
from voxshell.base.poses import pose as make_pose
from voxshell.errors import MeshError
from voxshell.model.meshes import Mesh, read_mesh
from voxshell.robots.description import MeshArrays, MeshFile
from voxshell.robots.link_meshes import read_link_mesh, refuse_mesh
from voxshell.robots.mjcf.compiler import normalize
from voxshell.robots.mjcf.defaults import MAIN
from voxshell.robots.mjcf.mesh_matter import weigh_mesh
from voxshell.robots.mjcf.msh_file import read_msh
from voxshell.simulation.comparison_shapes import ConvexHull

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.model.mass_properties import MassProperties
    from voxshell.robots.description import Affine
    from voxshell.robots.mjcf.compiler import Compiler
    from voxshell.robots.mjcf.defaults import Defaults
    from voxshell.robots.mjcf.model_file import ModelFile
    from voxshell.robots.xml_elements import Element

_ANY_COUNT = range(3, 100_000_000)
_INERTIAS = ("convex", "exact", "legacy", "shell")


class Meshes:
    """Meshes by name. Files are located when a geom needs them for collisions or for its mass."""

    def __init__(self, file: ModelFile, compiler: Compiler, defaults: Defaults) -> None:
        self._file = file
        self._compiler = compiler
        self._elements: dict[str, Element] = {}
        self._geometries: dict[str, MeshFile | MeshArrays] = {}
        self._matters: dict[str, MassProperties] = {}
        for section in file.sections("asset"):
            for mesh in section.all("mesh"):
                complete = defaults.complete(mesh, MAIN)
                name = mesh.attributes.get("name")
                if name is None:
                    if "builtin" in complete.attributes:
                        complete.text("name")
                    stem = os.path.basename(complete.text("file").replace("\\", "/"))
                    name = os.path.splitext(stem)[0]
                self._elements.setdefault(name, complete)

    def find(self, geom: Element) -> MeshFile | MeshArrays:
        """Return the mesh of a geom.

        Raises:
            RobotError: There is no mesh of that name, or its file is missing.
        """
        name = geom.text("mesh")
        if name not in self._elements:
            geom.refuse(f"has a mesh {name[:60]!r}, but <asset> has no such mesh; correct the name")
        if name not in self._geometries:
            self._geometries[name] = self._make(name, self._elements[name])
        return self._geometries[name]

    def weigh(self, geom: Element) -> MassProperties:
        """Return the matter of a geom's mesh at density 1, by MuJoCo's rules; 0 without volume.

        Raises:
            RobotError: The mesh cannot be read.
        """
        name = geom.text("mesh")
        mesh = self.read(geom)
        if name not in self._matters:
            kind = self._elements[name].word("inertia", _INERTIAS, "legacy")
            if kind == "convex":
                try:
                    mesh = _enclose(mesh.vertices)
                except MeshError as error:
                    refuse_mesh(self._owner(name), self.find(geom), error)
            self._matters[name] = weigh_mesh(mesh, kind)
        return self._matters[name]

    def read(self, geom: Element) -> Mesh:
        """Return the triangles of a geom's mesh.

        Raises:
            RobotError: The mesh cannot be read.
        """
        geometry = self.find(geom)
        mesh = read_link_mesh(self._owner(geom.text("mesh")), geometry)
        if np.abs(mesh.vertices).max() > FARTHEST:
            geom.refuse(f"has a mesh with vertices beyond {FARTHEST:g} m; correct its scale")
        return mesh

    def _owner(self, name: str) -> str:
        return f"{self._elements[name].where}: mesh {name!r}"

    def _make(self, name: str, element: Element) -> MeshFile | MeshArrays:
        affine = self._read_affine(element)
        vertices = element.numbers("vertex", _ANY_COUNT)
        if vertices is not None:
            return self._make_inline(name, element, vertices, affine)
        if "builtin" in element.attributes or (
            "file" not in element.attributes and element.first("plugin") is not None
        ):
            element.refuse(
                "is made by MuJoCo (builtin or plugin), and only meshes of vertices or files are read; "
                "export it to a file that <mesh file> names"
            )
        file_name = element.text("file")
        if self._compiler.strips_paths:
            file_name = os.path.basename(file_name.replace("\\", "/"))
        path = self._file.find(self._compiler.mesh_folder, file_name, element)
        if path is None:
            element.refuse(
                f"has a file {file_name[:200]!r} that is missing; put it where meshdir points, relative to "
                "the model's folder"
            )
        file = MeshFile(path, affine, has_scale="scale" in element.attributes)
        if path.lower().endswith(".msh"):
            try:
                return MeshArrays(path, _move(read_msh(path), affine))
            except MeshError as error:
                refuse_mesh(self._owner(name), file, error)
        return file

    def _make_inline(
        self, name: str, element: Element, vertices: list[float], affine: Affine
    ) -> MeshArrays:
        faces = element.numbers("face", _ANY_COUNT)
        if len(vertices) % 3 or len(faces or ()) % 3:
            element.refuse(
                "has a number of vertex or face entries that is not a multiple of 3; correct it"
            )
        points = np.reshape(vertices, (-1, 3))
        path = f"vertices of mesh {name!r}"
        made = MeshArrays(path, Mesh(points, np.zeros((0, 3), np.uint32)))
        try:
            if faces is None:
                mesh = _enclose(points)
            else:
                mesh = read_mesh((points, np.reshape(faces, (-1, 3))))
        except MeshError as error:
            refuse_mesh(self._owner(name), made, error)
        return MeshArrays(path, _move(mesh, affine))

    @staticmethod
    def _read_affine(element: Element) -> Affine:
        """Return the transform: subtract refpos, rotate by the inverse of refquat, then scale."""
        scale = element.numbers("scale", (3,)) or [1.0, 1.0, 1.0]
        if not all(scale):
            element.refuse(f"has a scale of {scale}; it must not be 0")
        origin = element.numbers("refpos", (3,)) or [0.0, 0.0, 0.0]
        wxyz = element.numbers("refquat", (4,)) or [1.0, 0.0, 0.0, 0.0]
        turn = make_pose(wxyz=normalize(element, "refquat", wxyz))[:3, :3].T
        linear = np.diag(scale) @ turn
        rows = np.column_stack([linear, -linear @ origin])
        return tuple((a, b, c, d) for a, b, c, d in rows.tolist())


def _enclose(points: NDArray[np.float64]) -> Mesh:
    """Return the convex hull of points, whose corners Bullet rounds.

    Raises:
        MeshError: They do not enclose a volume.
    """
    mesh = ConvexHull(points).mesh
    nearest = [int(np.argmin(((points - corner) ** 2).sum(axis=1))) for corner in mesh.vertices]
    return Mesh(points[nearest], mesh.faces)


def _move(mesh: Mesh, affine: Affine) -> Mesh:
    matrix = np.array(affine)
    faces = mesh.faces[:, ::-1] if np.linalg.det(matrix[:, :3]) < 0.0 else mesh.faces
    return Mesh(mesh.vertices @ matrix[:, :3].T + matrix[:, 3], faces)
