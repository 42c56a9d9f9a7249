"""Meshes of a robot's links, in meters."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NoReturn
from xml.parsers import expat

import numpy as np

from voxshell.errors import MeshError, MissingExtraError, RobotError
from voxshell.model.meshes import Mesh, read_mesh
from voxshell.robots.description import MeshArrays

if TYPE_CHECKING:
    from voxshell.robots.description import MeshFile


def read_link_mesh(owner: str, file: MeshFile | MeshArrays) -> Mesh:
    """Return a mesh with its scale and the unit of a COLLADA file applied.

    Faces of a mirrored mesh are reversed, so that they stay counterclockwise when seen from
    outside. The up axis of a COLLADA file is ignored, as in ROS.

    Args:
        owner: Its link, for error messages: "robot.urdf:7: link 'arm'".
        file: The mesh.

    Raises:
        RobotError: It cannot be read; the message names the robot's file, the link and the mesh.
        MissingExtraError: It is a COLLADA file, and pycollada is not installed.
        MemoryLimitError: The system has not enough memory for it.
    """
    if isinstance(file, MeshArrays):
        return file.mesh
    is_collada = file.path.lower().endswith(".dae")
    if is_collada:
        _need_collada(file.path)
    try:
        mesh = read_mesh(file.path)
    except MeshError as error:
        refuse_mesh(owner, file, error)
    affine = np.array(file.geometry_from_file)
    unit = _read_unit(file.path) if is_collada else 1.0
    faces = mesh.faces[:, ::-1] if np.linalg.det(affine[:, :3]) < 0.0 else mesh.faces
    return Mesh(mesh.vertices * unit @ affine[:, :3].T + affine[:, 3], faces)


def refuse_mesh(owner: str, file: MeshFile | MeshArrays, error: MeshError) -> NoReturn:
    """Raise an error of a mesh as a :class:`RobotError` that names the link."""
    what = str(error) if file.path in str(error) else f"{file.path}: {error}"
    raise RobotError(f"{owner}: {what}") from error


def _need_collada(path: str) -> None:
    try:
        import collada  # noqa: F401
    except ImportError as error:
        raise MissingExtraError(
            f"cannot read mesh {path}: COLLADA files need pycollada, which cannot be imported "
            f"({error}); run: pip install 'voxshell[urdf]'"
        ) from error


class _Found(Exception):  # noqa: N818
    """Ends the parsing early."""


def _read_unit(path: str) -> float:
    """Return the unit of a COLLADA file in meters; 1 if the file does not state it."""
    parser = expat.ParserCreate()
    unit = [1.0]

    def start(tag: str, attributes: dict[str, str]) -> None:
        if tag.rpartition(":")[2] == "unit":
            meters = float(attributes.get("meter", "1"))
            if math.isfinite(meters) and meters > 0.0:
                unit[0] = meters
            raise _Found

    def end(tag: str) -> None:
        if tag.rpartition(":")[2] == "asset":
            raise _Found

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    try:
        with open(path, "rb") as file:
            parser.ParseFile(file)
    except (_Found, expat.ExpatError, ValueError, OSError):
        pass
    return unit[0]
