"""Small bodies, and writers of mesh files that share nothing with the library's readers."""

from __future__ import annotations

import json
import struct
import zlib
from collections.abc import Iterable, Sequence
from io import BytesIO
from typing import Any
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile

import numpy as np

CORNERS = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
"""A tetrahedron, counter-clockwise seen from outside."""

Triangles = np.ndarray  # (n, 3, 3)


def triangles(corners: Any = CORNERS, faces: Any = FACES) -> Triangles:
    return np.asarray(corners, np.float64)[np.asarray(faces)]


def tetrahedra(count: int, apart: float = 2.0) -> Triangles:
    """Rows of equal ones."""
    side = int(np.ceil(count ** (1 / 3)))
    places = np.indices((side, side, side)).reshape(3, -1).T[:count] * apart
    return (triangles()[None] + places[:, None, None]).reshape(-1, 3, 3)


def stl(body: Triangles, count: int | None = None, head: bytes = b"", order: str = "<") -> bytes:
    rows = np.zeros(len(body), [("numbers", f"{order}f4", 12), ("attribute", f"{order}u2")])
    with np.errstate(over="ignore"):
        rows["numbers"][:, 3:] = body.reshape(-1, 9)
    count = len(body) if count is None else count
    return head.ljust(80, b"\0") + struct.pack(f"{order}I", count) + rows.tobytes()


def facet(*corners: Sequence[object], normal: str = "0 0 1") -> str:
    lines = "".join(f"   vertex {' '.join(map(str, corner))}\n" for corner in corners)
    return f" facet normal {normal}\n  outer loop\n{lines}  endloop\n endfacet\n"


def stl_text(body: Any = None, name: str = "body") -> str:
    facets = "".join(facet(*rows) for rows in (triangles() if body is None else body).tolist())
    return f"solid {name}\n{facets}endsolid {name}\n"


def obj(corners: Any = CORNERS, faces: Any = FACES, before: str = "", after: str = "") -> str:
    lines = [f"v {' '.join(map(str, corner))}" for corner in corners]
    lines += [f"f {' '.join(str(index + 1) for index in face)}" for face in faces]
    return before + "\n".join(lines) + "\n" + after


def off(corners: Any = CORNERS, faces: Any = FACES, counts: str = "", head: str = "OFF") -> str:
    lines = [head, counts or f"{len(corners)} {len(faces)} 0"]
    lines += [" ".join(map(str, corner)) for corner in corners]
    lines += [" ".join(map(str, (len(face), *face))) for face in faces]
    return "\n".join(lines) + "\n"


def ply_header(
    kind: str = "ascii",
    vertices: object = 4,
    faces: object = 4,
    point: str = "property float x\nproperty float y\nproperty float z\n",
    listed: str = "property list uchar int vertex_indices\n",
    before: str = "",
) -> str:
    return (
        f"ply\nformat {kind} 1.0\n{before}element vertex {vertices}\n{point}"
        f"element face {faces}\n{listed}end_header\n"
    )


def ply_text(**header: Any) -> str:
    lines = [" ".join(map(str, corner)) for corner in CORNERS]
    lines += [" ".join(map(str, (len(face), *face))) for face in FACES]
    return ply_header(**header) + "\n".join(lines) + "\n"


def ply_data(order: str = "<", corners: Any = CORNERS, faces: Any = FACES) -> bytes:
    rows = np.asarray(corners, f"{order}f4").tobytes()
    return rows + b"".join(struct.pack(f"{order}B3i", 3, *face) for face in faces)


def ply(order: str = "<", data: bytes | None = None, **header: Any) -> bytes:
    kind = {"<": "binary_little_endian", ">": "binary_big_endian"}[order]
    head = ply_header(**{"kind": kind, **header}).encode()
    return head + (ply_data(order) if data is None else data)


# ---- glTF ------------------------------------------------------------------------------------------

POSITIONS = np.asarray(CORNERS, "<f4").tobytes()
INDICES = np.asarray(FACES, "<u2").tobytes()
BUFFER = POSITIONS + INDICES


def gltf() -> dict[str, Any]:
    """A tetrahedron whose buffer is the file's own (GLB) or `body.bin`."""
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {
                **{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                **{"min": [0, 0, 0], "max": [1, 1, 1]},
            },
            {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": len(POSITIONS)},
            {"buffer": 0, "byteOffset": len(POSITIONS), "byteLength": len(INDICES)},
        ],
        "buffers": [{"byteLength": len(BUFFER)}],
    }


def change(tree: Any, path: str, value: object) -> Any:
    """Sets what a path such as "nodes.0.mesh" names; `...` removes it."""
    *folders, last = path.split(".")
    at = tree
    for key in folders:
        at = at[int(key) if isinstance(at, list) else key]
    key = int(last) if isinstance(at, list) else last
    if value is ...:
        del at[key]
    else:
        at[key] = value
    return tree


def glb(tree: Any, data: bytes = BUFFER, version: int = 2, length: int | None = None) -> bytes:
    text = tree if isinstance(tree, bytes) else json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    data += bytes(-len(data) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(data), b"BIN\0") + data
    total = 12 + len(chunks) if length is None else length
    return struct.pack("<4sII", b"glTF", version, total) + chunks


# ---- 3MF and COLLADA -------------------------------------------------------------------------------

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"


def zipped(files: dict[str, bytes | str], stored: bool = False) -> bytes:
    out = BytesIO()
    with ZipFile(out, "w", ZIP_STORED if stored else ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return out.getvalue()


def zip_of_zeros(name: str, size: int, head: bytes = b"") -> bytes:
    """An archive of one file that is mostly zeros, compressed a thousandfold."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    block = bytes(1 << 20)
    packed, checksum = [packer.compress(head)], zlib.crc32(head)
    for _ in range(size >> 20):
        packed.append(packer.compress(block))
        checksum = zlib.crc32(block, checksum)
    packed.append(packer.flush())
    data, total = b"".join(packed), len(head) + (size >> 20 << 20)
    sizes = struct.pack("<III", checksum, len(data), total)
    fields = struct.pack("<HHHHH", 20, 0, 8, 0, 33) + sizes
    names = name.encode()
    local = b"PK\3\4" + fields + struct.pack("<HH", len(names), 0) + names + data
    central = b"PK\1\2" + struct.pack("<H", 20) + fields
    central += struct.pack("<HHHHHII", len(names), 0, 0, 0, 0, 0, 0) + names
    end = struct.pack("<4s4H2IH", b"PK\5\6", 0, 0, 1, 1, len(central), len(local), 0)
    return local + central + end


def mesh_3mf(corners: Any = CORNERS, faces: Any = FACES) -> str:
    points = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in corners)
    rows = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in faces)
    return f"<mesh><vertices>{points}</vertices><triangles>{rows}</triangles></mesh>"


def object_3mf(number: object = 1, inside: str | None = None) -> str:
    return f'<object id="{number}" type="model">{mesh_3mf() if inside is None else inside}</object>'


def model_3mf(
    objects: str | None = None,
    build: str = '<item objectid="1"/>',
    unit: str | None = "meter",
    head: str = '<?xml version="1.0" encoding="UTF-8"?>',
    space: str = CORE,
) -> str:
    objects = object_3mf() if objects is None else objects
    units = "" if unit is None else f' unit="{unit}"'
    return (
        f'{head}<model{units} xmlns="{space}"><resources>{objects}</resources>'
        f"<build>{build}</build></model>"
    )


RELATIONS = (
    '<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/'
    'relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)


def pack_3mf(model: bytes | str, **others: bytes | str) -> bytes:
    return zipped({"_rels/.rels": RELATIONS, "3D/3dmodel.model": model, **others})


def dae(
    numbers: Iterable[object] = tuple(np.ravel(CORNERS)),
    indices: Iterable[object] = tuple(np.ravel(FACES)),
    count: object = 12,
    stride: object = 3,
    faces: object = 4,
    nodes: str = '<node id="n"><instance_geometry url="#g"/></node>',
    unit: str = '<unit meter="1"/>',
    source: str = "#p",
    head: str = '<?xml version="1.0"?>',
    library: str = "",
    scene: str = "#s",
) -> str:
    return f"""{head}
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><created>2020-01-01</created><modified>2020-01-01</modified>{unit}<up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p">
<float_array id="a" count="{count}">{" ".join(map(str, numbers))}</float_array>
<technique_common><accessor source="#a" count="4" stride="{stride}">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="{source}"/></vertices>
<triangles count="{faces}"><input semantic="VERTEX" source="#v" offset="0"/>
<p>{" ".join(map(str, indices))}</p></triangles></mesh></geometry></library_geometries>{library}
<library_visual_scenes><visual_scene id="s">{nodes}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="{scene}"/></scene></COLLADA>"""


# ---- what any XML may hold -------------------------------------------------------------------------


def entity_bomb(levels: int = 12) -> str:
    """A document type whose entity &bomb; is ten letters, ten times over in each level."""
    lines = ['<!ENTITY e0 "aaaaaaaaaa">']
    lines += [f'<!ENTITY e{i} "{f"&e{i - 1};" * 10}">' for i in range(1, levels)]
    return f'<!DOCTYPE x [{"".join(lines)}<!ENTITY bomb "&e{levels - 1};">]>'


def outer_entity(url: str) -> str:
    """A document type whose entity &bomb; is a file of the machine."""
    return f'<!DOCTYPE x [<!ENTITY bomb SYSTEM "{url}">]>'


def nest(tag: str, depth: int, inside: str = "") -> str:
    return f"<{tag}>" * depth + inside + f"</{tag}>" * depth
