"""XML elements of a robot's file with their lines and checked attributes."""

from __future__ import annotations

import math
import os
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NoReturn
from xml.parsers import expat

from voxshell.base.arguments import join_choices
from voxshell.base.input_files import read_small_file
from voxshell.errors import RobotError, SettingsError

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterator

_MOST_BYTES = 100_000_000
"""Largest size of a file, bytes, without the files that it names."""

_MOST_ELEMENTS = 200_000
"""Largest number of elements in a file; reading them takes less than a second."""

_OPTIONAL = re.compile(r"\$\(optenv +(\w+) +([^()]*)\)")
"""An environment variable with a default, which ROS would substitute."""

_OTHER_ROOTS = {
    "robot": "load URDF files with load_urdf",
    "mujoco": "load MJCF files with load_mjcf",
    "mujocoinclude": "it is a part of MJCF files; load one that includes it with load_mjcf",
    "sdf": "SDF files are not read; convert it to URDF or MJCF",
    "COLLADA": "it is a mesh; pass it to voxshell.Model.from_mesh",
}
"""What to do about files of other kinds, by their root."""

_MESHES = (".stl", ".obj", ".ply", ".off", ".glb", ".gltf", ".3mf")
"""Suffixes of meshes that are not XML."""

_PADDING = b"\0 \t\r\n\x1a"
"""Bytes that some exporters append after the last element."""


@dataclass(eq=False)
class Element:
    """An element of a file.

    Attributes:
        path: The file's path.
        owner: The link or joint that it belongs to, for error messages: "link 'arm'".
        line: Its first line, counted from 1.
    """

    path: str
    owner: str
    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Element] = field(default_factory=list)

    def all(self, tag: str) -> Iterator[Element]:
        """Yield the direct children with a name."""
        return (child for child in self.children if child.tag == tag)

    def first(self, tag: str) -> Element | None:
        """Return the first direct child with a name."""
        return next(self.all(tag), None)

    def text(self, attribute: str) -> str:
        """Return a required attribute.

        Raises:
            RobotError: It is missing.
        """
        if attribute not in self.attributes:
            self.refuse(f"has a <{self.tag}> without {attribute}; add it")
        return self.attributes[attribute]

    def numbers(
        self, attribute: str, counts: Container[int], *, finite: bool = True
    ) -> list[float] | None:
        """Return the numbers in an attribute, separated by spaces or commas; None if it is missing.

        Args:
            attribute: Its name.
            counts: Valid counts of numbers.
            finite: Refuse infinity; NaN is always refused.

        Raises:
            RobotError: It has an invalid number or count.
        """
        text = self.attributes.get(attribute)
        if text is None:
            return None
        text = _OPTIONAL.sub(lambda it: os.environ.get(it[1], it[2].strip()), text)
        try:
            numbers = [float(word) for word in text.replace(",", " ").split()]
        except ValueError:
            numbers = []
        fits = "_" not in text and len(numbers) in counts
        if not fits or not all(map(math.isfinite if finite else _is_number, numbers)):
            hint = f"give {_describe_counts(counts)}"
            if "$" in text:
                hint = f"it is a macro of xacro: expand it with xacro {self.path}"
            self.refuse(f'has <{self.tag} {attribute}="{text[:60]}">; {hint}')
        return numbers

    def word(self, attribute: str, words: tuple[str, ...], default: str) -> str:
        """Return an attribute that is one of some words, or the default if it is missing.

        Raises:
            RobotError: It is another word.
        """
        word = self.attributes.get(attribute, default)
        if word not in words:
            self.refuse(
                f'has <{self.tag} {attribute}="{word[:60]}">; it must be {join_choices(words)}'
            )
        return word

    def number(self, attribute: str, *, finite: bool = True) -> float | None:
        """Return the number in an attribute; None if it is missing.

        Raises:
            RobotError: It is not one number.
        """
        numbers = self.numbers(attribute, (1,), finite=finite)
        return None if numbers is None else numbers[0]

    @property
    def where(self) -> str:
        """File and line, for error messages."""
        return f"{self.path}:{self.line}"

    def refuse(self, what: str) -> NoReturn:
        """Raise a :class:`RobotError` that names the file, the line, and the link or joint."""
        raise RobotError(f"{self.where}: {self.owner} {what}")


@dataclass(frozen=True)
class Dialect:
    """Rules to read the elements of a kind of file.

    Attributes:
        roots: Valid names of the root.
        most_levels: Largest depth of nested elements.
        refuses_deeper: True if deeper elements are errors; otherwise they belong to extensions and
            are ignored.
        find_owner: Returns the owner of an element for error messages, from its tag, its name (""
            without one), its level, and the owner of its parent.
    """

    roots: tuple[str, ...]
    most_levels: int
    refuses_deeper: bool
    find_owner: Callable[[str, str, int, str], str]


def read_elements(path: str, dialect: Dialect) -> Element:
    """Return the root element of a file.

    Raises:
        MissingFileError: It does not exist.
        FileAccessError: The system refuses to read it.
        RobotError: It is not a regular file, is too large, is not XML, declares
            entities, or its root is not a valid one.
    """
    try:
        data = read_small_file(path, _MOST_BYTES, "robot")
    except SettingsError as error:
        raise RobotError(str(error)) from None
    return _parse(path, data, dialect)


def _parse(path: str, data: bytes, dialect: Dialect) -> Element:
    parser = expat.ParserCreate(namespace_separator=None)
    opened: list[Element] = []
    roots: list[Element] = []
    depth = count = 0

    def refuse_entity(*_: object) -> None:
        raise RobotError(f"{path}: it declares XML entities, which robots do not need; expand them")

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth, count
        depth += 1
        count += 1
        where = f"{path}:{parser.CurrentLineNumber}"
        if count > _MOST_ELEMENTS:
            raise RobotError(f"{where}: more than {_MOST_ELEMENTS} elements; split the file")
        if depth > dialect.most_levels:
            if dialect.refuses_deeper:
                raise RobotError(
                    f"{where}: elements are nested more than {dialect.most_levels} deep; "
                    "make the tree flatter"
                )
            return
        owner = dialect.find_owner(
            tag, attributes.get("name", "")[:60], depth, opened[-1].owner if opened else "the robot"
        )
        element = Element(path, owner, tag, attributes, parser.CurrentLineNumber)
        (opened[-1].children if opened else roots).append(element)
        opened.append(element)

    def end(_: str) -> None:
        nonlocal depth
        if depth <= dialect.most_levels:
            opened.pop()
        depth -= 1

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.EntityDeclHandler = refuse_entity
    # In UTF-16, the last letter ends with a zero byte.
    text = data if data[:2] in (b"\xff\xfe", b"\xfe\xff") else data.lstrip().rstrip(_PADDING)
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        what = _find_kind(path, dialect) or f"it is not valid XML: {error}"
        raise RobotError(f"{path}: {what}") from None
    root = roots[0]
    if root.tag not in dialect.roots:
        remedy = _OTHER_ROOTS.get(root.tag, "")
        raise RobotError(
            f"{root.where}: it is a <{root.tag[:60]}>, not a <{dialect.roots[0]}>{remedy and ': '}{remedy}"
        )
    return root


def _find_kind(path: str, dialect: Dialect) -> str:
    """Return what a file that is not XML is, by its suffix, and what to do; "" if that is unknown."""
    suffix = os.path.splitext(path)[1].lower()
    wanted = "an MJCF file" if "mujoco" in dialect.roots else "a URDF file"
    if suffix in _MESHES:
        return f"it is a mesh, not {wanted}; pass it to voxshell.Model.from_mesh"
    if suffix == ".vxs":
        return f"it is a model, not {wanted}; pass it to voxshell.Model.load"
    return ""


def _describe_counts(counts: Container[int]) -> str:
    """Return the numbers that an attribute takes: "1 finite number", "3 or 4 finite numbers"."""
    if not isinstance(counts, tuple):
        return "only finite numbers"
    return f"{join_choices(map(str, counts))} finite number{'' if counts == (1,) else 's'}"


def _is_number(value: float) -> bool:
    return not math.isnan(value)
