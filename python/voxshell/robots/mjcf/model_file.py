"""MJCF files with their included files, as one tree of elements."""

from __future__ import annotations

import os
from dataclasses import replace

from voxshell.base.arguments import as_path
from voxshell.robots.xml_elements import Dialect, Element, read_elements

MOST_LEVELS = 100
"""Depth of nested elements, across files; models of hands have 20."""

_MOST_FILES = 100
"""Number of files in a model; each counts as often as it is included or attached."""

_MOST_ELEMENTS = 200_000
"""Number of elements in all files, counted likewise."""

_NAMED = ("body", "mesh", "joint", "geom")


class ModelFile:
    """A file with its included files, and with the files that all of them name.

    Attributes:
        path: The file's path.
        root: Its root, whose sections include those of the included files.
    """

    def __init__(self, path: str, library: _Library) -> None:
        self.path = path
        self._library = library
        root = library.read(path)
        children = self._expand(root, 1, (os.path.realpath(path),))
        self.root: Element = replace(root, children=children)

    def sections(self, tag: str) -> list[Element]:
        """Return the sections with a name."""
        return list(self.root.all(tag))

    def find(self, folder: str, name: str, near: Element) -> str | None:
        """Return the path of a file that an element names, or None.

        Args:
            folder: The model's folder for files of this kind, relative to the model's.
            name: The name in the element.
            near: The element; the file may also be in the folder of the element's file.
        """
        name = os.path.join(folder, name.strip()).replace("\\", "/")
        folders = (os.path.dirname(os.path.abspath(own)) for own in (self.path, near.path))
        candidates = (os.path.join(each, name) for each in folders)
        return next(filter(os.path.isfile, candidates), None)

    def attach(self, element: Element) -> ModelFile:
        """Return another model, whose file an element names.

        Raises:
            RobotError: It cannot be read.
        """
        return ModelFile(self._find_model(element), self._library)

    def _find_model(self, element: Element) -> str:
        name = element.text("file")
        path = self.find("", name, element)
        if path is None:
            element.refuse(
                f"names the file {name[:200]!r}, which does not exist; put it where the path points, relative "
                "to the model's folder"
            )
        if self._library.is_full:
            element.refuse(
                f"names a file beyond the limit of {_MOST_FILES} files; join some of them"
            )
        return path

    def _expand(self, element: Element, level: int, within: tuple[str, ...]) -> list[Element]:
        """Return the children of an element, with the contents of included files."""
        if level > MOST_LEVELS:
            element.refuse(f"is nested in more than {MOST_LEVELS} elements; make the tree flatter")
        self._library.count(element)
        children: list[Element] = []
        for child in element.children:
            if child.tag != "include":
                if child.children:
                    inside = self._expand(child, level + 1, within)
                    children.append(replace(child, children=inside))
                else:
                    children.append(child)
                continue
            path = self._find_model(child)
            if os.path.realpath(path) in within:
                child.refuse(f"includes {child.text('file')[:200]!r} in itself; remove that")
            included = self._library.read(path)
            children += self._expand(included, level, (*within, os.path.realpath(path)))
        return children


class _Library:
    """The files of a model, each of which is read once, and their total size."""

    def __init__(self) -> None:
        self._read: dict[str, Element] = {}
        self._files = 0
        self._elements = 0

    @property
    def is_full(self) -> bool:
        return self._files >= _MOST_FILES

    def read(self, path: str) -> Element:
        self._files += 1
        key = os.path.realpath(path)
        if key not in self._read:
            self._read[key] = read_elements(path, _DIALECT)
        return self._read[key]

    def count(self, element: Element) -> None:
        self._elements += len(element.children)
        if self._elements > _MOST_ELEMENTS:
            element.refuse(f"is beyond the limit of {_MOST_ELEMENTS} elements; split the model")


def read_model(path: str | os.PathLike[str]) -> ModelFile:
    """Read a file and the files that it includes.

    Raises:
        MissingFileError: The file does not exist.
        FileAccessError: The file cannot be read.
        RobotError: A file is not MJCF, or includes itself, a missing file, or too many files.
    """
    name = os.fsdecode(as_path(path, "path"))
    return ModelFile(name, _Library())


def _find_owner(tag: str, name: str, level: int, above: str) -> str:
    del level
    if tag in _NAMED and name:
        return f"{tag} {name!r}"
    return f"a {tag} of {above}" if tag == "geom" else above


_DIALECT = Dialect(
    ("mujoco", "mujocoinclude"),
    most_levels=MOST_LEVELS,
    refuses_deeper=True,
    find_owner=_find_owner,
)
