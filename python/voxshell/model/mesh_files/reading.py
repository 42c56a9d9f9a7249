"""Opening of mesh files, with checks before a library reads them."""

from __future__ import annotations

import os
from typing import NamedTuple

from voxshell.errors import MeshError
from voxshell.model.mesh_files import gltf, polygons, xml_scenes
from voxshell.model.mesh_files.regular import Neighbors, read_regular

KINDS = ("3mf", "dae", "glb", "gltf", "obj", "off", "ply", "stl")
"""Suffixes of the supported formats."""

UNITLESS = ("obj", "off", "ply", "stl")
"""Those whose files do not state the unit of their coordinates."""


class MeshFile(NamedTuple):
    """A checked file that a library may read.

    Attributes:
        kind: One of :data:`KINDS`.
        data: The file's content.
        neighbors: The files that it may refer to.
        unit: Of its coordinates, meters; 1 if it states none.
    """

    kind: str
    data: bytes
    neighbors: Neighbors
    unit: float


def open_mesh_file(path: str) -> MeshFile:
    """Read a file and check its content, without making a mesh of it.

    Raises:
        MeshError: It is not a regular file, its format is not supported, or it or a file that it
            refers to exceeds a limit.
        OSError: The system refuses to read it.
        Exception: Any other error, if the file is damaged.
    """
    kind = os.path.splitext(path)[1][1:].lower()
    if kind not in KINDS and os.path.isfile(path):
        raise MeshError(
            f"its suffix belongs to no supported format ({', '.join(KINDS)}); convert it "
            "to one of them, or read it with trimesh and pass the mesh"
        )
    data = read_regular(path)
    neighbors = Neighbors(path)
    unit = 1.0
    match kind:
        case "3mf":
            unit = xml_scenes.check_3mf(data)
        case "dae":
            unit = xml_scenes.check_dae(data)
        case "glb":
            gltf.check_glb(data, neighbors)
        case "gltf":
            gltf.check_gltf(data, neighbors)
        case "obj":
            data = polygons.merge_materials(data)
        case "off":
            polygons.check_off(data)
        case "ply":
            polygons.check_ply(data)
        case _:
            data = polygons.merge_solids(data)
    return MeshFile(kind, data, neighbors, unit)
