"""A mesh file, opened and checked: what a library may read of it."""

from __future__ import annotations

import os
from typing import NamedTuple

from voxshell.errors import MeshError
from voxshell.model.mesh_files import gltf, polygons, xml_scenes
from voxshell.model.mesh_files.regular import Neighbors, read_regular

KINDS = ("3mf", "dae", "glb", "gltf", "obj", "off", "ply", "stl")
"""Endings of the files that are read."""


class MeshFile(NamedTuple):
    """What a library may read.

    Attributes:
        kind: One of :data:`KINDS`.
        data: What the file holds.
        neighbors: The files that it may refer to.
    """

    kind: str
    data: bytes
    neighbors: Neighbors


def open_mesh_file(path: str) -> MeshFile:
    """Reads a file and checks what it asks for, without making a mesh of it.

    Raises:
        MeshError: It is no regular file, its kind is not read, or it, or what it refers to, asks for
            too much.
        OSError: The system does not let it be read.
        Exception: Of any kind, where the file is damaged.
    """
    kind = os.path.splitext(path)[1][1:].lower()
    if kind not in KINDS and os.path.isfile(path):
        raise MeshError(
            f"its ending is none of a format that can be read here ({', '.join(KINDS)}); convert it "
            "to one, or read it with trimesh and pass the mesh"
        )
    data = read_regular(path)
    neighbors = Neighbors(path)
    match kind:
        case "3mf":
            xml_scenes.check_3mf(data)
        case "dae":
            xml_scenes.check_dae(data)
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
    return MeshFile(kind, data, neighbors)
