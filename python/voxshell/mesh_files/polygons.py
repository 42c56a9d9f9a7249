"""Faces of very many corners, and parts without number, in OBJ, OFF, PLY and STL files."""

from __future__ import annotations

import re
import struct

from voxshell.mesh_files.budget import MOST_CORNERS, check_corners

_LONG_LINE = re.compile(rb"[^\n]{%d,}" % (2 * MOST_CORNERS))
"""That may hold more than the most corners: each takes a digit and a blank."""

_STL_HEADER, _STL_TRIANGLE = 84, 50
"""Bytes, of binary files."""

_PLY_SIZES = {
    **dict.fromkeys(("char", "int8", "uchar", "uint8"), 1),
    **dict.fromkeys(("short", "int16", "ushort", "uint16"), 2),
    **dict.fromkeys(("int", "int32", "uint", "uint32", "float", "float32"), 4),
    **dict.fromkeys(("double", "float64", "int64", "uint64"), 8),
}
_PLY_COUNTS = {"uchar": "B", "uint8": "B", "ushort": "H", "uint16": "H", "uint": "I", "uint32": "I"}
_PLY_COUNTS |= {"char": "b", "int8": "b", "short": "h", "int16": "h", "int": "i", "int32": "i"}


def merge_materials(data: bytes) -> bytes:
    """An OBJ file without materials: the parts of many would be read one by one, slowly.

    Raises:
        MeshError: A face has too many corners.
    """
    if b"\\" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\\\n", b"")  # lines that go on
    for line in _LONG_LINE.finditer(data):
        if line[0].lstrip().startswith(b"f"):
            check_corners(len(line[0].split()) - 1)
    return re.sub(rb"(?m)^[ \t]*usemtl[^\n]*", b"", data)


def check_off(data: bytes) -> None:
    """Of text alone; trimesh reads no others.

    Raises:
        MeshError: A face has too many corners.
    """
    for line in _LONG_LINE.finditer(data):
        if not line[0].lstrip().startswith(b"#"):
            check_corners(len(line[0].split()) - 1)


def merge_solids(data: bytes) -> bytes:
    """An STL file whose text has one solid: of many, each would become a mesh, slowly."""
    is_text = data[:80].lstrip()[:5].lower() == b"solid"
    if not is_text or len(data) == _STL_HEADER + _STL_TRIANGLE * _count_triangles(data):
        return data
    facets = re.sub(rb"(?mi)^[ \t]*(?:end)?solid\b[^\n]*", b"", data)
    return b"solid\n" + facets + b"\nendsolid\n"


def _count_triangles(data: bytes) -> int:
    """As a binary STL file says."""
    return struct.unpack_from("<I", data, 80)[0] if len(data) >= _STL_HEADER else 0


def check_ply(data: bytes) -> None:
    """Of text, or of numbers, whose faces all have as many corners as the first.

    Raises:
        MeshError: A face has too many corners.
    """
    header, _, body = data[:100_000].partition(b"end_header")
    lines = [line.split() for line in header.decode("latin-1").splitlines()]
    form = next((line[1] for line in lines if len(line) > 1 and line[0] == "format"), "ascii")
    if form.startswith("ascii"):
        check_off(data[len(header) :])
        return
    start = len(header) + len("end_header") + (2 if body.startswith(b"\r\n") else 1)
    order = ">" if "big" in form else "<"
    count = 0
    for line in lines:
        if len(line) == 3 and line[0] == "element":
            count = int(line[2])
        elif len(line) == 3 and line[0] == "property":
            start += count * _PLY_SIZES[line[1]]
        elif len(line) == 5 and line[:2] == ["property", "list"] and count > 0:
            form = order + _PLY_COUNTS[line[2]]
            # What follows lists cannot be found so; a second list is no face's.
            check_corners(struct.unpack_from(form, data, start)[0])
            return
