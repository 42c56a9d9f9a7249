"""Meshes of a robot's links, in meters."""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn

import numpy as np

from voxshell.base.extras import explain_import
from voxshell.errors import MeshError, RobotError
from voxshell.model.meshes import Mesh, read_mesh
from voxshell.robots.description import MeshArrays

if TYPE_CHECKING:
    from voxshell.robots.description import MeshFile


def read_link_mesh(owner: str, file: MeshFile | MeshArrays) -> Mesh:
    """Return a mesh with its scale and the unit of its file applied.

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
    if file.path.lower().endswith(".dae"):
        _need_collada(file.path)
    try:
        mesh = read_mesh(file.path)
    except MeshError as error:
        refuse_mesh(owner, file, error)
    affine = np.array(file.geometry_from_file)
    faces = mesh.faces[:, ::-1] if np.linalg.det(affine[:, :3]) < 0.0 else mesh.faces
    return Mesh(mesh.vertices @ affine[:, :3].T + affine[:, 3], faces)


def refuse_mesh(owner: str, file: MeshFile | MeshArrays, error: MeshError) -> NoReturn:
    """Raise an error of a mesh as a :class:`RobotError` that names the link."""
    what = str(error) if file.path in str(error) else f"{file.path}: {error}"
    raise RobotError(f"{owner}: {what}") from error


def _need_collada(path: str) -> None:
    try:
        import collada  # noqa: F401
    except ImportError as error:
        raise explain_import(
            error,
            f"cannot read mesh {path}: COLLADA files need pycollada, which cannot be imported "
            f"({error}); run: pip install 'voxshell[urdf]'",
        ) from error
