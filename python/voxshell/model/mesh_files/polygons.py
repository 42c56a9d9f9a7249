"""Checks of OBJ, OFF, PLY and STL files: corners of faces, numbers of parts, truncated rows."""

from __future__ import annotations

import re
import struct
from typing import TYPE_CHECKING

import numpy as np

from voxshell.errors import MeshError
from voxshell.model.mesh_files.budget import MOST_CORNERS, check_corners

if TYPE_CHECKING:
    from collections.abc import Sequence

_LONG_LINE = re.compile(rb"[^\n]{%d,}" % (2 * MOST_CORNERS))
"""Length of a row that may exceed the limit of corners: each corner takes a digit and a blank."""

_STL_HEADER, _STL_TRIANGLE = 84, 50
"""Size of the number types of binary files, bytes."""

_PLY_SIZES = {
    **dict.fromkeys(("char", "int8", "uchar", "uint8"), 1),
    **dict.fromkeys(("short", "int16", "ushort", "uint16"), 2),
    **dict.fromkeys(("int", "int32", "uint", "uint32", "float", "float32"), 4),
    **dict.fromkeys(("double", "float64", "int64", "uint64"), 8),
}
_PLY_COUNTS = {"uchar": "B", "uint8": "B", "ushort": "H", "uint16": "H", "uint": "I", "uint32": "I"}
_PLY_COUNTS |= {"char": "b", "int8": "b", "short": "h", "int16": "h", "int": "i", "int32": "i"}


def merge_materials(data: bytes) -> bytes:
    """Return an OBJ file without its materials: trimesh reads parts of different materials slowly.

    Raises:
        MeshError: A face has too many corners.
    """
    if b"\\" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\\\n", b"")  # continued lines
    for line in _LONG_LINE.finditer(data):
        if line[0].lstrip().startswith(b"f"):
            check_corners(len(line[0].split()) - 1)
    if zero := re.search(rb"(?m)^[ \t]*f[ \t](?:[^\n]*[ \t])?[+-]?0+(?=[/\s]|$)", data):
        line = data.count(b"\n", 0, zero.start()) + 1
        raise MeshError(f"line {line} has a face with vertex 0, but OBJ files count from 1")
    return re.sub(rb"(?m)^[ \t]*usemtl[^\n]*", b"", data)


def check_off(data: bytes) -> None:
    """Check an OFF file in text format; trimesh does not read binary ones.

    Raises:
        MeshError: A face has too many corners, or rows are missing or not numeric.
    """
    _check_long_rows(data)
    text = _decode(data)
    lines = [line for row in text.splitlines() if (line := row.partition("#")[0].strip())]
    head, found, counts = lines[0].partition("OFF") if lines else ("", "", "")
    if not found or head not in ("", "C"):
        raise MeshError("it does not begin with OFF or COFF; it is damaged or has another format")
    rows = [counts.strip(), *lines[1:]] if counts.strip() else lines[1:]
    vertices, faces = (int(word) for word in rows[0].split()[:2])
    _check_rows(rows[1:], [(vertices, None), (faces, 0)])


def _decode(data: bytes) -> str:
    """Return the data as text; like trimesh, respect byte order marks."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return data.decode("utf-16")
    return data.decode("utf-8-sig", errors="replace")


def _check_long_rows(data: bytes) -> None:
    for line in _LONG_LINE.finditer(data):
        if not line[0].lstrip().startswith(b"#"):
            check_corners(len(line[0].split()) - 1)


def _check_rows(rows: Sequence[str], elements: Sequence[tuple[int, int | None]]) -> None:
    """Refuse rows that are missing, too short or not numeric: trimesh would misread them.

    Args:
        rows: Rows of text.
        elements: For each element the number of rows, and the column that holds the length of its
            list. As many integers follow it. None if it has no list.

    Raises:
        MeshError: There are such rows.
    """
    wanted = sum(count for count, _ in elements)
    if min((count for count, _ in elements), default=0) < 0 or wanted > len(rows):
        raise MeshError(
            f"it has {len(rows)} rows, but its header announces {wanted}; it is truncated or damaged: "
            "export it again"
        )
    begin = 0
    for count, column in elements:
        for number, row in enumerate(rows[begin : begin + count], start=begin + 1):
            if "_" in row:
                raise MeshError(f"row {number} after the header is not all numbers: {row[:80]!r}")
            if column is None:
                continue
            words = row.split()
            length = int(words[column])
            corners = words[column + 1 : column + 1 + length]
            if length < 0 or len(corners) < length or not all(map(str.isdigit, corners)):
                raise MeshError(
                    f"row {number} after the header is not a face of {length} corners: {row[:80]!r}"
                )
        begin += count


def merge_solids(data: bytes) -> bytes:
    """Return an STL file whose text has one solid: trimesh would read many solids slowly.

    Raises:
        MeshError: The text ends within a facet.
    """
    is_text = data[:80].lstrip()[:5].lower() == b"solid"
    if not is_text or len(data) == _STL_HEADER + _STL_TRIANGLE * _count_triangles(data):
        return data
    facets = re.sub(rb"(?mi)^[ \t]*(?:end)?solid\b[^\n]*", b"", data)
    words = facets.lower()
    begun, ended = words.count(b"outer"), words.count(b"endloop")
    if begun != ended:
        raise MeshError(
            f"it begins {begun} facets but ends {ended}; it is truncated or damaged: export it again"
        )
    return b"solid\n" + facets + b"\nendsolid\n"


def _count_triangles(data: bytes) -> int:
    """Return the number of triangles that a binary STL file states."""
    return struct.unpack_from("<I", data, 80)[0] if len(data) >= _STL_HEADER else 0


def check_ply(data: bytes) -> None:
    """Check a PLY file in text or binary format.

    Raises:
        MeshError: A face has too many corners, rows are missing or not numeric, or the faces of a
            binary file have different numbers of corners.
    """
    ended = data.find(b"end_header")
    header = data if ended < 0 else data[:ended]
    lines = [line.split() for line in header.decode("latin-1").splitlines()]
    forms = [line[1] for line in lines if len(line) > 1 and line[0] == "format"]
    if len(forms) > 1:
        raise MeshError("its header has two formats; it is damaged: export it again")
    elements = _list_elements(lines)
    form = forms[0] if forms else "ascii"
    start = len(header) + len("end_header")
    start += 2 if data[start : start + 2] == b"\r\n" else 1
    if form.startswith("ascii"):
        _check_long_rows(data[len(header) :])
        _check_ply_text(data[start:], elements)
        return
    order = ">" if "big" in form else "<"
    for count, properties in elements:
        if count == 0:
            continue
        if any(len(each) == 2 for each in properties):
            # The position of elements after lists is unknown; a second list never belongs to faces.
            _check_ply_list(data, start, count, properties, order)
            return
        start += count * sum(_PLY_SIZES[each[0]] for each in properties)


def _list_elements(lines: list[list[str]]) -> list[tuple[int, list[tuple[str, ...]]]]:
    """Return each element's count and the types of its properties; a list has two types."""
    elements: list[tuple[int, list[tuple[str, ...]]]] = []
    for line in lines:
        if len(line) == 3 and line[0] == "element":
            elements.append((int(line[2]), []))
        elif line[:2] == ["property", "list"] and len(line) == 5 and elements:
            if line[4] in ("vertex_index", "vertex_indices") and line[3] not in _PLY_COUNTS:
                raise MeshError(f"its faces have indices of type {line[3][:20]!r}, not integers")
            elements[-1][1].append((line[2], line[3]))
        elif line[:1] == ["property"] and len(line) == 3 and elements:
            elements[-1][1].append((line[1],))
    return elements


def _check_ply_text(body: bytes, elements: list[tuple[int, list[tuple[str, ...]]]]) -> None:
    rows = body.decode("utf-8").splitlines()
    begin = 0
    counted: list[tuple[int, int | None]] = []
    for count, properties in elements:
        lists = [i for i, each in enumerate(properties) if len(each) == 2]
        counted.append((count, lists[0] if lists else None))
        if not lists:
            for number, row in enumerate(rows[begin : begin + max(0, count)], start=begin + 1):
                if len(row.split()) < len(properties):
                    raise MeshError(
                        f"row {number} after the header has fewer than {len(properties)} numbers: "
                        f"{row[:80]!r}"
                    )
        begin += max(0, count)
    _check_rows(rows, counted)


def _check_ply_list(
    data: bytes, start: int, count: int, properties: list[tuple[str, ...]], order: str
) -> None:
    """Check an element that is a list: all lists must be as long as the first."""
    at = next(i for i, each in enumerate(properties) if len(each) == 2)
    before = sum(_PLY_SIZES[each[0]] for each in properties[:at])
    form = order + _PLY_COUNTS[properties[at][0]]
    length = struct.unpack_from(form, data, start + before)[0]
    check_corners(length)
    if sum(len(each) == 2 for each in properties) > 1:
        return
    stride = sum(_PLY_SIZES[each[0]] for each in properties)
    stride += length * _PLY_SIZES[properties[at][1]]
    rows = np.frombuffer(data, np.uint8, offset=start)
    if stride <= 0 or count * stride > len(rows):
        return  # lists have other lengths; trimesh reads them one by one, or reports missing data
    size = struct.calcsize(form)
    lengths = rows[: count * stride].reshape(count, stride)[:, before : before + size]
    lengths = np.ascontiguousarray(lengths).view(form)
    if (lengths != length).any():
        raise MeshError(
            "its faces have different numbers of corners, which is not supported in binary files; "
            "triangulate them and export the mesh again"
        )
