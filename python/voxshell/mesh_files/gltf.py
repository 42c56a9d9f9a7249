"""What glTF files ask for: numbers, nodes and the files that they refer to."""

from __future__ import annotations

import json
import struct
from typing import TYPE_CHECKING, Any

from voxshell.mesh_files.budget import check_expansion, check_placed

if TYPE_CHECKING:
    from collections.abc import Hashable

    from voxshell.mesh_files.regular import Neighbors

_COMPONENT_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
_COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}


def check_glb(data: bytes, neighbors: Neighbors) -> None:
    """Checks the JSON in a binary file, as :func:`check_gltf` does.

    Raises:
        MeshError: It asks for too much.
    """
    length = struct.unpack_from("<I", data, 12)[0]
    check_gltf(data[20 : 20 + length], neighbors, stored=len(data))


def check_gltf(text: bytes, neighbors: Neighbors, stored: int | None = None) -> None:
    """Checks sizes of accessors and views, and how often and how deeply nodes place meshes.

    Args:
        text: JSON.
        neighbors: Files beside it, of which buffers are read.
        stored: Bytes of the file, if it holds more than the text.

    Raises:
        MeshError: It asks for too much, or refers to what cannot be read.
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


def _measure(accessor: dict[str, Any]) -> int:
    components = _COMPONENTS[accessor["type"]]
    return max(0, accessor["count"]) * components * _COMPONENT_BYTES[accessor["componentType"]]
