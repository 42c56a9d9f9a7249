"""Checks of 3MF and COLLADA files, and their units: sizes in archives, faces, and how often parts are placed."""

from __future__ import annotations

import io
import math
import re
import zipfile
from collections import defaultdict
from typing import TYPE_CHECKING
from xml.parsers import expat

import numpy as np

from voxshell.errors import MeshError
from voxshell.model.mesh_files.budget import check_corners, check_expansion, check_placed

if TYPE_CHECKING:
    from collections.abc import Hashable

_MOST_LEVELS = 200
"""Depth of nested elements; readers follow them by recursion."""

_NO_INDEX = re.compile(r"-|\d{10}")
"""Indices that are negative or exceed 32 bits: pycollada would wrap or truncate them."""

_MOST_PLACED_3MF = 3500
"""Objects. trimesh takes 1.5 s for these; its time grows with their square."""

_MOST_PLACED_DAE = 12_000
"""Nodes and geometries. trimesh takes 1.5 s for these."""


_UNITS_3MF = {
    "micron": 1e-6,
    "millimeter": 1e-3,
    "centimeter": 1e-2,
    "inch": 0.0254,
    "foot": 0.3048,
    "meter": 1.0,
}
"""In meters (3MF Core Specification 1.3, section 3.4.1)."""


def check_3mf(data: bytes) -> float:
    """Check the expanded size of the archive, and how often and how deeply objects are placed.

    Returns:
        The unit of its coordinates in meters: a millimeter if it states none.

    Raises:
        MeshError: The file exceeds a limit.
    """
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = archive.infolist()
        # No reader reads more than the sizes that the archive declares.
        check_expansion(sum(member.file_size for member in members), len(data))
        objects = _Objects()
        for member in members:
            if member.filename.lower().endswith(".model"):
                objects.scan(archive.read(member))
    check_placed(objects.children, objects.roots, objects.sizes, _MOST_PLACED_3MF)
    return objects.unit


def check_dae(data: bytes) -> float:
    """Check the corners of faces, and how often nodes place geometries.

    Returns:
        The unit of its coordinates in meters: 1 if it states none.

    Raises:
        MeshError: The file exceeds a limit.
    """
    nodes = _Nodes()
    nodes.scan(data)
    # COLLADA's transforms are multiplied one by one, in negligible time.
    check_placed(nodes.children, nodes.roots, nodes.sizes, _MOST_PLACED_DAE)
    return nodes.unit


class _Scan:
    """Scans the elements of an XML text without keeping them."""

    def __init__(self) -> None:
        self.children: dict[Hashable, list[Hashable]] = defaultdict(list)
        self.sizes: dict[Hashable, int] = defaultdict(int)
        self.roots: list[Hashable] = []
        self._levels = 0

    def scan(self, text: bytes) -> None:
        """Add what a text places.

        Raises:
            MeshError: The text exceeds a limit.
            ExpatError: It is not valid XML.
        """
        parser = expat.ParserCreate(namespace_separator=" ")
        parser.buffer_text = True

        def start(name: str, attributes: dict[str, str]) -> None:
            self._levels += 1
            if self._levels > _MOST_LEVELS:
                raise MeshError(
                    f"its XML elements are nested more than {_MOST_LEVELS} deep; export the mesh again"
                )
            self.start(name.rpartition(" ")[2], attributes, parser.CurrentByteIndex)

        def end(name: str) -> None:
            self._levels -= 1
            self.end(name.rpartition(" ")[2], parser.CurrentByteIndex)

        def refuse_entity(*_: object) -> None:
            raise MeshError(
                "it declares XML entities, which meshes do not need; export the mesh again"
            )

        parser.StartElementHandler = start
        parser.EndElementHandler = end
        parser.CharacterDataHandler = self.text
        parser.EntityDeclHandler = refuse_entity
        parser.Parse(text, True)

    def start(self, name: str, attributes: dict[str, str], at: int) -> None:
        raise NotImplementedError

    def end(self, name: str, at: int) -> None:
        raise NotImplementedError

    def text(self, text: str) -> None:
        pass


class _Objects(_Scan):
    """The objects of a 3MF file."""

    def __init__(self) -> None:
        super().__init__()
        self.unit = _UNITS_3MF["millimeter"]
        self._object = ""
        self._began = 0

    def start(self, name: str, attributes: dict[str, str], at: int) -> None:
        if name == "model":
            unit = attributes.get("unit", "millimeter")
            if unit not in _UNITS_3MF:
                raise MeshError(
                    f"its unit is {unit!r}, but 3MF has only {', '.join(_UNITS_3MF)}; export the mesh again"
                )
            self.unit = _UNITS_3MF[unit]
        elif name == "object":
            self._object = attributes.get("id", "")
        elif name == "mesh":
            self._began = at
        elif name == "component":
            self.children[self._object].append(attributes.get("objectid", ""))
        elif name == "item":
            self.roots.append(attributes.get("objectid", ""))

    def end(self, name: str, at: int) -> None:
        if name == "mesh":
            self.sizes[self._object] += at - self._began


class _Nodes(_Scan):
    """The nodes and geometries of a COLLADA file."""

    def __init__(self) -> None:
        super().__init__()
        self.unit = 1.0
        self._nodes: list[str] = []
        self._count = 0
        self._geometry = ""
        self._began = 0
        self._inside: list[str] = []
        self._offsets = 1
        self._numbers: list[str] = []
        self._text_before = ""

    def start(self, name: str, attributes: dict[str, str], at: int) -> None:
        self._inside.append(name)
        self._text_before = ""
        target = attributes.get("url", "")[1:]
        if name == "node":
            self._count += 1
            node = attributes.get("id") or f" {self._count}"
            if self._nodes:
                self.children["node", self._nodes[-1]].append(("node", node))
            elif "visual_scene" in self._inside:
                self.roots.append(("node", node))
            self._nodes.append(node)
        elif name == "instance_node" and self._nodes:
            self.children["node", self._nodes[-1]].append(("node", target))
        elif name == "instance_geometry" and self._nodes:
            self.children["node", self._nodes[-1]].append(("geometry", target))
        elif name == "unit":
            self.unit = float(attributes.get("meter", 1.0))
            if not (math.isfinite(self.unit) and self.unit > 0.0):
                raise MeshError(
                    f"its unit is {self.unit:g} meters, which is not a valid length; export the mesh again"
                )
        elif name == "geometry":
            self._geometry, self._began = attributes.get("id", ""), at
        elif name in ("polygons", "polylist"):
            self._offsets = 1
        elif name == "input":
            self._offsets = max(self._offsets, 1 + int(attributes.get("offset", 0)))

    def end(self, name: str, at: int) -> None:
        self._inside.pop()
        if name == "node":
            self._nodes.pop()
        elif name == "geometry":
            self.sizes["geometry", self._geometry] = at - self._began
        elif name in ("vcount", "p", "matrix") and self._numbers:
            numbers = "".join(self._numbers)
            self._numbers = []
            if name == "matrix":
                if len(numbers.split()) != 16:
                    raise MeshError(
                        f"a <matrix> has {len(numbers.split())} numbers, not 16; export the mesh again"
                    )
            elif name == "p":
                check_corners(len(numbers.split()) // self._offsets)
            else:
                check_corners(int(np.array(numbers.split() or [0], dtype=np.int64).max()))

    def text(self, text: str) -> None:
        inside = self._inside[-1] if self._inside else ""
        if inside == "p":
            # The parser delivers text in pieces, which may end within a number.
            if _NO_INDEX.search(self._text_before + text):
                raise MeshError(
                    "a face has a negative index or one of ten digits; export the mesh again"
                )
            self._text_before = text[-9:]
        if inside in ("vcount", "matrix") or (inside == "p" and "polygons" in self._inside):
            self._numbers.append(text)
