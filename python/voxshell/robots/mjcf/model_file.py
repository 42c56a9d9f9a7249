"""MJCF files with what they include, as one tree of elements."""

from __future__ import annotations

import os
from dataclasses import replace
from typing import TYPE_CHECKING

from voxshell.base.arguments import as_path
from voxshell.errors import FileAccessError
from voxshell.robots.xml_elements import Dialect, Element, read_elements

if TYPE_CHECKING:
    from collections.abc import Sequence

_MOST_LEVELS = 100
"""Of elements in each other, includes counted; hands have 20."""

_MOST_FILES = 100
"""That a model may consist of, each counted as often as it is included."""

_NAMED = ("body", "mesh", "joint", "geom")


def read_model(path: str | os.PathLike[str]) -> ModelFile:
    """Reads a file and what it includes.

    Raises:
        FileAccessError: The file cannot be read.
        RobotError: A file is not MJCF, or includes itself, one that is missing, or too many.
    """
    name = os.fsdecode(as_path(path, "path"))
    if not os.path.isfile(name):
        raise FileAccessError(f"cannot read robot {name}: there is no such file")
    return ModelFile(name)


class ModelFile:
    """A file with what it includes.

    Attributes:
        path: Of the file.
        root: Its root, whose sections contain those of the included files.
        files: How many there are so far, with those of attached models.
    """

    def __init__(self, path: str, files: int = 0) -> None:
        self.path = path
        self.files = files
        self.root: Element = self._read(path)
        self.root = replace(
            self.root, children=self._expand(self.root, 1, (os.path.realpath(path),))
        )

    def sections(self, tag: str) -> list[Element]:
        """The sections of that name."""
        return list(self.root.all(tag))

    def find(self, folder: str, name: str, near: Element) -> str | None:
        """The path of a file that an element names, or None.

        Args:
            folder: Where the model keeps files of the kind, relative to the model's.
            name: As the element gives it.
            near: The element; what it includes may lie beside its own file.
        """
        name = name.strip().replace("\\", "/")
        for own in (self.path, near.path):
            candidate = os.path.join(os.path.dirname(os.path.abspath(own)), folder, name)
            try:
                if os.path.isfile(candidate):
                    return candidate
            except ValueError:  # a NUL, or what the system's encoding does not have
                return None
        return None

    def _read(self, path: str) -> Element:
        self.files += 1
        return read_elements(path, _DIALECT)

    def _expand(self, element: Element, level: int, within: tuple[str, ...]) -> list[Element]:
        """The children of an element, each include replaced by what its file holds."""
        if level > _MOST_LEVELS:
            element.refuse(
                f"has elements in each other, more than {_MOST_LEVELS} of them; take some apart"
            )
        children: list[Element] = []
        for child in element.children:
            if child.tag != "include":
                inside = self._expand(child, level + 1, within)
                children.append(replace(child, children=inside))
                continue
            path = self._find_included(child, within)
            included = self._read(path)
            children += self._expand(included, level, (*within, os.path.realpath(path)))
        return children

    def _find_included(self, include: Element, within: Sequence[str]) -> str:
        name = include.text("file")
        path = self.find("", name, include)
        if path is None:
            include.refuse(
                f"includes {name[:200]!r}, and there is no such file; put it where the path points, seen "
                "from the model's folder"
            )
        if os.path.realpath(path) in within:
            include.refuse(f"includes {name[:200]!r}, which is the file itself; leave it out")
        if self.files >= _MOST_FILES:
            include.refuse(f"includes more than {_MOST_FILES} files; join some of them")
        return path


def _find_owner(tag: str, name: str, level: int, above: str) -> str:
    del level
    if tag in _NAMED and name:
        return f"{tag} {name!r}"
    return f"a {tag} of {above}" if tag == "geom" else above


_DIALECT = Dialect(
    ("mujoco", "mujocoinclude"), most_levels=_MOST_LEVELS, refuses_deeper=True, find_owner=_find_owner
)
