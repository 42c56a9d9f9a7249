"""glTF and GLB."""

from __future__ import annotations

import base64
import json
import struct
from collections.abc import Iterator
from typing import Any

import numpy as np

from .bodies import BUFFER, change, glb, gltf
from .case import Case, Content, Wants, of_files

Change = tuple[str, str, object, Wants]

CHANGES: tuple[Change, ...] = (
    ("no asset", "asset", ..., "either"),
    ("version 3.0", "asset.version", "3.0", "refused"),
    ("version 1.0", "asset.version", "1.0", "refused"),
    ("a number as version", "asset.version", 2, "either"),
    ("no scenes", "scenes", ..., "either"),
    ("a scene beyond the list", "scene", 7, "refused"),
    ("a negative scene", "scene", -1, "refused"),
    ("a word as scene", "scene", "first", "refused"),
    ("no nodes", "nodes", ..., "refused"),
    ("a node beyond the list", "scenes.0.nodes", [7], "refused"),
    ("a negative node", "scenes.0.nodes", [-1], "refused"),
    ("a node as fraction", "scenes.0.nodes", [0.5], "refused"),
    ("a node that is its own child", "nodes.0.children", [0], "refused"),
    ("nodes in a circle", "nodes", [{"children": [1], "mesh": 0}, {"children": [0]}], "refused"),
    ("a node with two parents", "nodes", [{"children": [1, 1]}, {"mesh": 0}], "either"),
    ("a mesh beyond the list", "nodes.0.mesh", 7, "refused"),
    ("a negative mesh", "nodes.0.mesh", -1, "refused"),
    ("true as mesh", "nodes.0.mesh", True, "refused"),
    ("a word as mesh", "nodes.0.mesh", "0", "refused"),
    ("no meshes", "meshes", ..., "refused"),
    ("meshes as a table", "meshes", {"0": {}}, "refused"),
    ("no primitives", "meshes.0.primitives", [], "refused"),
    ("primitives of null", "meshes.0.primitives", None, "refused"),
    ("no corners", "meshes.0.primitives.0.attributes", {}, "refused"),
    ("corners beyond the list", "meshes.0.primitives.0.attributes.POSITION", 9, "refused"),
    ("corners of index -1", "meshes.0.primitives.0.attributes.POSITION", -1, "refused"),
    ("indices beyond the list", "meshes.0.primitives.0.indices", 9, "refused"),
    ("corners as indices", "meshes.0.primitives.0.indices", 0, "refused"),
    ("points", "meshes.0.primitives.0.mode", 0, "refused"),
    ("lines", "meshes.0.primitives.0.mode", 1, "refused"),
    ("a strip", "meshes.0.primitives.0.mode", 5, "either"),
    ("an unknown mode", "meshes.0.primitives.0.mode", 99, "refused"),
    ("corners of two numbers", "accessors.0.type", "VEC2", "refused"),
    ("corners of an unknown kind", "accessors.0.type", "VEC9", "refused"),
    ("corners of an unknown type", "accessors.0.componentType", 5199, "refused"),
    ("corners of integers", "accessors.0.componentType", 5125, "either"),
    ("more corners than there are", "accessors.0.count", 5, "refused"),
    ("2**31 corners", "accessors.0.count", 2**31, "refused"),
    ("2**64 corners", "accessors.0.count", 2**64, "refused"),
    ("-4 corners", "accessors.0.count", -4, "refused"),
    ("no count", "accessors.0.count", ..., "refused"),
    ("a fraction as count", "accessors.0.count", 3.5, "refused"),
    ("a word as count", "accessors.0.count", "four", "refused"),
    ("1e18 corners of zeros", "accessors.0", {
        "componentType": 5126, "count": 10**18, "type": "VEC3"}, "refused"),
    ("10**9 indices of zeros", "accessors.1", {
        "componentType": 5123, "count": 10**9, "type": "SCALAR"}, "refused"),
    ("an offset beyond the view", "accessors.0.byteOffset", 10**6, "refused"),
    ("a negative offset", "accessors.1.byteOffset", -24, "refused"),
    ("indices of fractions", "accessors.1.componentType", 5126, "refused"),
    ("a view beyond the list", "accessors.0.bufferView", 9, "refused"),
    ("a negative view", "accessors.0.bufferView", -1, "refused"),
    ("a view beyond its buffer", "bufferViews.0.byteLength", 10**9, "refused"),
    ("a view of negative length", "bufferViews.0.byteLength", -48, "refused"),
    ("a view at a negative offset", "bufferViews.1.byteOffset", -24, "refused"),
    ("a view at 2**63", "bufferViews.1.byteOffset", 2**63, "refused"),
    ("a stride of 1", "bufferViews.0.byteStride", 1, "refused"),
    ("a stride of 0", "bufferViews.0.byteStride", 0, "either"),
    ("a stride of 2**40", "bufferViews.0.byteStride", 2**40, "refused"),
    ("a buffer beyond the list", "bufferViews.0.buffer", 3, "refused"),
    ("a buffer of another length", "buffers.0.byteLength", 10**9, "either"),
    ("a buffer of negative length", "buffers.0.byteLength", -1, "either"),
    ("no buffers", "buffers", [], "either"),
    ("a matrix of 15 numbers", "nodes.0.matrix", [1.0] * 15, "refused"),
    ("a matrix of zeros", "nodes.0.matrix", [0.0] * 16, "refused"),
    ("a matrix of NaN", "nodes.0.matrix", [float("nan")] * 16, "refused"),
    ("a matrix of words", "nodes.0.matrix", ["a"] * 16, "refused"),
    ("a scale of zero", "nodes.0.scale", [0, 0, 0], "refused"),
    ("a scale of 1e300", "nodes.0.scale", [1e300] * 3, "refused"),
    ("a scale of infinity", "nodes.0.scale", [float("inf")] * 3, "refused"),
    ("a scale that mirrors", "nodes.0.scale", [-1, 1, 1], "either"),
    ("a turn of zero", "nodes.0.rotation", [0, 0, 0, 0], "refused"),
    ("a turn of three numbers", "nodes.0.rotation", [0, 0, 1], "refused"),
    ("a move of NaN", "nodes.0.translation", [float("nan"), 0, 0], "refused"),
    ("a move of 1e300", "nodes.0.translation", [1e300, 0, 0], "refused"),
    ("a packing that is required", "extensionsRequired", ["KHR_draco_mesh_compression"], "refused"),
    ("an unknown extension that is required", "extensionsRequired", ["EVIL_extension"], "refused"),
    ("extensions of numbers", "extensionsRequired", 5, "either"),
    ("corners of normalized integers", "accessors.0.normalized", True, "refused"),
    ("sparse corners beyond the list", "accessors.0.sparse", {
        "count": 1, "indices": {"bufferView": 1, "componentType": 5123, "byteOffset": 4},
        "values": {"bufferView": 0, "byteOffset": 0}}, "refused"),
    ("10**9 sparse corners", "accessors.0.sparse", {
        "count": 10**9, "indices": {"bufferView": 1, "componentType": 5123},
        "values": {"bufferView": 0}}, "refused"),
    ("a name of control characters", "nodes.0.name", "\x00\x1b[31m\n", "loaded"),
    ("the name of a frame that readers use", "nodes.0.name", "world", "either"),
)  # fmt: skip

BUFFERS: tuple[tuple[str, object, Wants], ...] = (
    ("a missing file", "missing.bin", "refused"),
    ("a file of the system", "../../../../../../etc/passwd", "refused"),
    ("an absolute path", "/etc/passwd", "refused"),
    ("a device without end", "/dev/zero", "refused"),
    ("the network", "http://127.0.0.1:9/body.bin", "refused"),
    ("a file address", "file:///etc/passwd", "refused"),
    ("its folder", ".", "refused"),
    ("itself", "body.gltf", "either"),
    ("a name of 5000 letters", "a" * 5000, "refused"),
    ("a name with NUL", "a\0b", "refused"),
    ("a number", 5, "refused"),
    ("damaged base64", "data:application/octet-stream;base64,$$$$", "refused"),
    ("cut base64", "data:application/octet-stream;base64," + base64.b64encode(BUFFER).decode()[:50],
     "refused"),
    ("data without a comma", "data:application/octet-stream", "refused"),
)  # fmt: skip


def doubled(levels: int) -> dict[str, Any]:
    """Each node has the next one twice: 2**levels bodies."""
    nodes: list[dict[str, Any]] = [{"children": [i + 1, i + 1]} for i in range(levels)]
    return change(gltf(), "nodes", [*nodes, {"mesh": 0}])


def doubled_by_pairs(levels: int) -> dict[str, Any]:
    """Two nodes a level, each with both of the next: no child is listed twice."""
    nodes: list[dict[str, Any]] = [
        {"children": [2 * level + 2, 2 * level + 3]} for level in range(levels) for _ in range(2)
    ]
    return change(gltf(), "nodes", [*nodes, {"mesh": 0}, {"mesh": 0}])


def chain(length: int) -> dict[str, Any]:
    nodes: list[dict[str, Any]] = [{"children": [i + 1]} for i in range(length)]
    return change(gltf(), "nodes", [*nodes, {"mesh": 0}])


def with_indices(*indices: int) -> bytes:
    return glb(gltf(), BUFFER[:48] + np.array(indices, "<u2").tobytes())


def list_texts() -> Iterator[tuple[str, Content, Wants]]:
    whole = json.dumps(gltf())
    yield "no JSON", "solid", "refused"
    yield "cut", whole[:-20], "refused"
    yield "a list", "[]", "refused"
    yield "an empty table", "{}", "refused"
    yield "null", "null", "refused"
    yield "100000 brackets", "[" * 100_000, "refused"
    yield (
        "100000 brackets in a node",
        whole.replace('"mesh": 0}', '"extras": ' + "[" * 100_000 + "]" * 100_000 + "}"),
        "refused",
    )
    yield (
        "a number of 100000 digits",
        whole.replace('"count": 4', '"count": 4' + "0" * 100_000),
        ("refused"),
    )
    yield "an exponent of 999", whole.replace('"count": 4', '"count": 1e999'), "refused"
    yield "each key twice", whole.replace('"scene": 0', '"scene": 5, "scene": 0'), "either"
    yield "UTF-16", whole.encode("utf-16"), "refused"
    yield "a byte order mark", b"\xef\xbb\xbf" + whole.encode(), "either"
    yield "Latin-1", whole.replace("2.0", "\xf6").encode("latin-1"), "refused"
    yield (
        "half of a surrogate pair",
        whole.replace('"mesh": 0', '"name": "\\ud800", "mesh": 0'),
        ("either"),
    )


def list_binaries() -> Iterator[tuple[str, Content, Wants]]:
    whole = glb(gltf())
    text = struct.unpack_from("<I", whole, 12)[0]
    for at in (0, 4, 8, 12, 16, 20, 20 + text // 2, 20 + text, 28 + text, len(whole) - 4):
        yield f"cut after {at} bytes", whole[:at], "refused"
    yield "other magic", b"glTG" + whole[4:], "refused"
    yield "version 1", glb(gltf(), version=1), "refused"
    yield "version 2**32 - 1", glb(gltf(), version=2**32 - 1), "refused"
    yield "a length of 0", glb(gltf(), length=0), "either"
    yield "a length of 2**32 - 1", glb(gltf(), length=2**32 - 1), "refused"
    yield "a chunk of 2**32 - 1", whole[:12] + b"\xff" * 4 + whole[16:], "refused"
    yield "a chunk of no bytes", whole[:12] + bytes(4) + whole[16:], "refused"
    yield "an unknown chunk for JSON", whole[:16] + b"ABCD" + whole[20:], "refused"
    yield "JSON that is noise", glb(b"\xff\xfe\0\1"), "refused"
    yield "no data", glb(gltf(), b""), "refused"
    yield "data cut", glb(gltf(), BUFFER[:40]), "refused"
    yield "its chunks swapped", whole[:12] + whole[20 + text :] + whole[12 : 20 + text], "refused"
    yield (
        "an index beyond the corners",
        with_indices(*[0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 4]),
        ("refused"),
    )
    yield "eleven indices", glb(change(gltf(), "accessors.1.count", 11)), "refused"
    yield "corners of NaN", glb(gltf(), b"\0\0\xc0\x7f" * 12 + BUFFER[48:]), "refused"
    yield "20 levels of two", glb(doubled(20)), "refused"
    yield "60 levels of two", glb(doubled(60)), "refused"
    yield "20 levels of pairs", glb(doubled_by_pairs(20)), "refused"
    yield "1000 levels of pairs", glb(doubled_by_pairs(1000)), "refused"
    yield "a chain of 900 nodes", glb(chain(900)), "either"
    yield "a chain of 20000 nodes", lambda: glb(chain(20_000)), "either"
    yield (
        "100000 nodes of one mesh",
        lambda: glb(
            change(
                change(gltf(), "nodes", [{"mesh": 0}] * 100_000),
                "scenes.0.nodes",
                [*range(100_000)],
            )
        ),
        "refused",
    )
    yield (
        "100000 meshes of one accessor",
        lambda: glb(change(gltf(), "meshes", gltf()["meshes"] * 100_000)),
        "either",
    )
    yield (
        "20000 primitives of one accessor",
        lambda: glb(
            change(gltf(), "meshes.0.primitives", gltf()["meshes"][0]["primitives"] * 20_000)
        ),
        "refused",
    )


def list_cases() -> Iterator[Case]:
    for name, path, value, wants in CHANGES:
        yield of_files("mesh", f"glTF, {name}", "body.glb", glb(change(gltf(), path, value)), wants)
    for name, content, wants in list_texts():
        yield of_files(
            "mesh", f"glTF text, {name}", "body.gltf", content, wants, {"body.bin": BUFFER}
        )
    for name, content, wants in list_binaries():
        yield of_files("mesh", f"GLB, {name}", "body.glb", content, wants)
    for name, address, wants in BUFFERS:
        text = json.dumps(change(gltf(), "buffers.0.uri", address))
        yield of_files("mesh", f"glTF text, a buffer of {name}", "body.gltf", text, wants)
