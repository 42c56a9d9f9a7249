"""Checks of glTF files: their numbers, nodes and the files that they refer to."""

from __future__ import annotations

import json
import struct
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.errors import MeshError
from voxshell.model.mesh_files.budget import (
    MOST_PLACED,
    check_expansion,
    check_parts,
    check_placed,
)

if TYPE_CHECKING:
    from collections.abc import Hashable

    from voxshell.model.mesh_files.regular import Neighbors

_COMPONENT_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
_COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}

_HARMLESS = (
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "KHR_xmp",
    "EXT_texture_",
    "MSFT_texture",
)
"""Prefixes of extensions that do not change the surface."""

_DRACO = "KHR_draco_mesh_compression"


def check_glb(data: bytes, neighbors: Neighbors) -> None:
    """Check the JSON of a binary file like :func:`check_gltf`.

    Raises:
        MeshError: The file exceeds a limit.
    """
    stated, length = struct.unpack_from("<II", data, 8)
    if stated > len(data):
        raise MeshError(
            f"it is truncated: {len(data)} bytes of {stated}; copy it again, or export the mesh again"
        )
    check_gltf(data[20 : 20 + length], neighbors, stored=len(data))


def check_gltf(text: bytes, neighbors: Neighbors, stored: int | None = None) -> None:
    """Check the sizes of accessors and views, and how often and how deeply nodes place meshes.

    Args:
        text: JSON.
        neighbors: The files in its folder; buffers are read from there.
        stored: Size of the file in bytes, if it contains more than the text.

    Raises:
        MeshError: The file exceeds a limit, refers to something unreadable, or uses something that
            trimesh would misread.
    """
    tree = json.loads(text)
    for buffer in tree.get("buffers", ()):
        if "base64," not in buffer.get("uri", "base64,"):
            neighbors.get(buffer["uri"])
    accessors = [_measure(each) for each in tree.get("accessors", ())]
    views = sum(max(0, each["byteLength"]) for each in tree.get("bufferViews", ()))
    check_expansion(
        views + sum(accessors), (len(text) if stored is None else stored) + neighbors.size
    )
    check_parts(sum(len(mesh["primitives"]) for mesh in tree.get("meshes", ())), MOST_PLACED)
    children: dict[Hashable, list[Hashable]] = {}
    sizes: dict[Hashable, int] = {}
    for number, mesh in enumerate(tree.get("meshes", ())):
        for i, primitive in enumerate(mesh["primitives"]):
            used = [primitive["attributes"].get("POSITION"), primitive.get("indices")]
            size = sum(accessors[each] for each in used if each is not None)
            sizes["primitive", number, i] = size
    for number, node in enumerate(tree.get("nodes", ())):
        children[number] = [*node.get("children", ())]
        if "mesh" in node:
            mesh = node["mesh"]
            primitives = len(tree["meshes"][mesh]["primitives"])
            children[number] += [("primitive", mesh, i) for i in range(primitives)]
    scenes = tree.get("scenes", ())
    roots = scenes[tree.get("scene", 0)].get("nodes", ()) if scenes else ()
    check_placed(children, roots, sizes)
    _check_features(tree)


def _measure(accessor: dict[str, Any]) -> int:
    components = _COMPONENTS[accessor["type"]]
    return max(0, accessor["count"]) * components * _COMPONENT_BYTES[accessor["componentType"]]


def _check_features(tree: dict[str, Any]) -> None:
    """Refuse what trimesh ignores or misreads.

    Raises:
        MeshError: The file has another version, needs an unsupported extension, or has sparse or
            normalized corners, negative indices, or rotations of length 0.
    """
    version = str(tree.get("asset", {}).get("version", "2.0"))
    if version.partition(".")[0] != "2":
        raise MeshError(
            f"it has glTF version {version[:20]}; only 2.0 is read; export the mesh again"
        )
    required = tree.get("extensionsRequired", ())
    for extension in required if isinstance(required, list) else ():
        if extension == _DRACO and find_spec("DracoPy") is not None:
            continue
        if not str(extension).startswith(_HARMLESS):
            raise MeshError(
                f"it needs the extension {str(extension)[:60]!r}, which is not read; export the mesh "
                "without"
            )
    if any("sparse" in each for each in tree.get("accessors", ())):
        raise MeshError("it has sparse accessors, which are not read; export the mesh without")
    for mesh in tree.get("meshes", ()):
        for primitive in mesh["primitives"]:
            corners = primitive["attributes"].get("POSITION")
            if corners is not None and tree["accessors"][corners].get("normalized"):
                raise MeshError("it has corners of normalized integers; export the mesh as floats")
    for node in tree.get("nodes", ()):
        if "rotation" in node and not np.any(np.asarray(node["rotation"], dtype=np.float64)):
            raise MeshError("a node has the invalid rotation [0, 0, 0, 0]; export the mesh again")
    if _has_negative(tree):
        raise MeshError("it has a negative index; it is damaged: export it again")


def _has_negative(tree: dict[str, Any]) -> bool:
    """Return whether an index is negative; Python would count it from the end."""
    nodes, scenes = tree.get("nodes", ()), tree.get("scenes", ())
    indices = [tree.get("scene", 0)]
    indices += [each.get("bufferView", 0) for each in tree.get("accessors", ())]
    indices += [each.get("buffer", 0) for each in tree.get("bufferViews", ())]
    indices += [each.get("mesh", 0) for each in nodes]
    indices += [child for each in nodes for child in each.get("children", ())]
    indices += [child for each in scenes for child in each.get("nodes", ())]
    for mesh in tree.get("meshes", ()):
        for primitive in mesh["primitives"]:
            indices += [primitive.get("indices", 0), primitive["attributes"].get("POSITION", 0)]
    return any(index is not None and index < 0 for index in indices)
