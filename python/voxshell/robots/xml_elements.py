"""A robot's XML file as elements that know their line, and the numbers in their attributes."""

from __future__ import annotations

import math
import os
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NoReturn
from xml.parsers import expat

from voxshell.base.input_files import read_small_file
from voxshell.errors import RobotError, SettingsError

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterator

_MOST_BYTES = 100_000_000
"""Of a file, without those that it names."""

_MOST_ELEMENTS = 200_000
"""Of a file; they are read within a second."""

_OPTIONAL = re.compile(r"\$\(optenv +(\w+) +([^()]*)\)")
"""A variable of the environment and its default, which ROS puts in place of it."""

_PADDING = b"\0 \t\r\n\x1a"
"""Bytes that some exporters leave after the last element."""


@dataclass(eq=False)
class Element:
    """An element of a file.

    Attributes:
        path: Of the file.
        owner: The link or joint that it belongs to, for errors: "link 'arm'".
        line: Where it begins, counted from 1.
    """

    path: str
    owner: str
    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Element] = field(default_factory=list)

    def all(self, tag: str) -> Iterator[Element]:
        """The elements of that name directly in this one."""
        return (child for child in self.children if child.tag == tag)

    def first(self, tag: str) -> Element | None:
        """The first element of that name directly in this one."""
        return next(self.all(tag), None)

    def text(self, attribute: str) -> str:
        """An attribute that must be there.

        Raises:
            RobotError: It is not.
        """
        if attribute not in self.attributes:
            self.refuse(f"has a <{self.tag}> without {attribute}; add it")
        return self.attributes[attribute]

    def numbers(
        self, attribute: str, counts: Container[int], *, finite: bool = True
    ) -> list[float] | None:
        """The numbers of an attribute, parted by spaces or commas; None if it is not there.

        Args:
            attribute: Its name.
            counts: How many numbers it may have.
            finite: Whether infinity is refused; NaN always is.

        Raises:
            RobotError: It does not hold that many numbers.
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
            hint = f"give {_list_counts(counts)} finite numbers"
            if "$" in text:
                hint = f"it is a macro of xacro: expand it with xacro {self.path}"
            self.refuse(f'has <{self.tag} {attribute}="{text[:60]}">; {hint}')
        return numbers

    def word(self, attribute: str, words: tuple[str, ...], default: str) -> str:
        """An attribute that is one of some words; the default if it is not there.

        Raises:
            RobotError: It is another word.
        """
        word = self.attributes.get(attribute, default)
        if word not in words:
            self.refuse(
                f'has <{self.tag} {attribute}="{word[:60]}">; it must be {" or ".join(words)}'
            )
        return word

    def number(self, attribute: str, *, finite: bool = True) -> float | None:
        """The number of an attribute; None if it is not there.

        Raises:
            RobotError: It is not one number.
        """
        numbers = self.numbers(attribute, (1,), finite=finite)
        return None if numbers is None else numbers[0]

    @property
    def where(self) -> str:
        """File and line, for errors."""
        return f"{self.path}:{self.line}"

    def refuse(self, what: str) -> NoReturn:
        """Raises a :class:`RobotError` that names the file, the line, and the link or joint."""
        raise RobotError(f"{self.where}: {self.owner} {what}")


@dataclass(frozen=True)
class Dialect:
    """How the elements of a kind of file are read.

    Attributes:
        roots: What the root may be.
        most_levels: Of elements in each other.
        refuses_deeper: Whether deeper ones are refused; otherwise they belong to extensions, and are
            left out.
        find_owner: Says whom an element belongs to, for errors: from its tag, its name ("" without
            one), its level, and the owner of what it is in.
    """

    roots: tuple[str, ...]
    most_levels: int
    refuses_deeper: bool
    find_owner: Callable[[str, str, int, str], str]


def read_elements(path: str, dialect: Dialect) -> Element:
    """The root element of a file.

    Raises:
        FileAccessError: The system does not let it be read.
        RobotError: It does not exist, is no regular file, is too large, is not XML, declares entities,
            or its root is none of those that it may be.
    """
    try:
        data = read_small_file(path, _MOST_BYTES, "robot")
    except SettingsError as error:
        raise RobotError(f"cannot read robot {path}: {error}") from None
    return _parse(path, data, dialect)


def _parse(path: str, data: bytes, dialect: Dialect) -> Element:
    parser = expat.ParserCreate(namespace_separator=None)
    opened: list[Element] = []
    roots: list[Element] = []
    depth = count = 0

    def refuse_entity(*_: object) -> None:
        raise RobotError(f"{path}: it declares XML entities, which no robot needs; write them out")

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth, count
        depth += 1
        count += 1
        where = f"{path}:{parser.CurrentLineNumber}"
        if count > _MOST_ELEMENTS:
            raise RobotError(f"{where}: more than {_MOST_ELEMENTS} elements; make several files")
        if depth > dialect.most_levels:
            if dialect.refuses_deeper:
                raise RobotError(
                    f"{where}: elements lie in each other, more than {dialect.most_levels} of them; "
                    "take some apart"
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
    # In UTF-16 the last letter ends with a zero byte.
    text = data if data[:2] in (b"\xff\xfe", b"\xfe\xff") else data.lstrip().rstrip(_PADDING)
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        raise RobotError(f"{path}: it is no XML: {error}") from None
    if roots[0].tag not in dialect.roots:
        raise RobotError(
            f"{roots[0].where}: it is a <{roots[0].tag[:60]}>, not a <{dialect.roots[0]}>"
        )
    return roots[0]


def _list_counts(counts: Container[int]) -> str:
    return " or ".join(map(str, counts)) if isinstance(counts, tuple) else "only"


def _is_number(value: float) -> bool:
    return not math.isnan(value)
