"""MJCF files with what they include, as one tree of elements."""

from __future__ import annotations

import os
from dataclasses import replace

from voxshell.base.arguments import as_path
from voxshell.errors import FileAccessError
from voxshell.robots.xml_elements import Dialect, Element, read_elements

MOST_LEVELS = 100
"""Of elements in each other, those of other files counted; hands have 20."""

_MOST_FILES = 100
"""That a model may consist of, each counted as often as it is included or attached."""

_MOST_ELEMENTS = 200_000
"""Of all of them, counted likewise."""

_NAMED = ("body", "mesh", "joint", "geom")


class ModelFile:
    """A file with what it includes, and the files that both name.

    Attributes:
        path: Of the file.
        root: Its root, whose sections contain those of the included files.
    """

    def __init__(self, path: str, library: _Library) -> None:
        self.path = path
        self._library = library
        root = library.read(path)
        children = self._expand(root, 1, (os.path.realpath(path),))
        self.root: Element = replace(root, children=children)

    def sections(self, tag: str) -> list[Element]:
        """The sections of that name."""
        return list(self.root.all(tag))

    def find(self, folder: str, name: str, near: Element) -> str | None:
        """The path of a file that an element names, or None.

        Args:
            folder: Where the model keeps files of the kind, relative to the model's.
            name: As the element gives it.
            near: The element; what it names may lie beside its own file.
        """
        name = os.path.join(folder, name.strip()).replace("\\", "/")
        folders = (os.path.dirname(os.path.abspath(own)) for own in (self.path, near.path))
        candidates = (os.path.join(each, name) for each in folders)
        return next(filter(os.path.isfile, candidates), None)

    def attach(self, element: Element) -> ModelFile:
        """Another model, by the element that names its file.

        Raises:
            RobotError: It cannot be read.
        """
        return ModelFile(self._find_model(element), self._library)

    def _find_model(self, element: Element) -> str:
        name = element.text("file")
        path = self.find("", name, element)
        if path is None:
            element.refuse(
                f"names the file {name[:200]!r}, and there is none; put it where the path points, seen from "
                "the model's folder"
            )
        if self._library.is_full:
            element.refuse(f"names the last of more than {_MOST_FILES} files; join some of them")
        return path

    def _expand(self, element: Element, level: int, within: tuple[str, ...]) -> list[Element]:
        """The children of an element, each include replaced by what its file holds."""
        if level > MOST_LEVELS:
            element.refuse(f"lies in more than {MOST_LEVELS} other elements; take some apart")
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
                child.refuse(f"includes {child.text('file')[:200]!r} in itself; leave it out")
            included = self._library.read(path)
            children += self._expand(included, level, (*within, os.path.realpath(path)))
        return children


class _Library:
    """The files of a model, each read once, and how much they hold."""

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
            element.refuse(
                f"is the last of more than {_MOST_ELEMENTS} elements; make several models"
            )


def read_model(path: str | os.PathLike[str]) -> ModelFile:
    """Reads a file and what it includes.

    Raises:
        FileAccessError: The file cannot be read.
        RobotError: A file is not MJCF, or includes itself, one that is missing, or too many.
    """
    name = os.fsdecode(as_path(path, "path"))
    if not os.path.isfile(name):
        raise FileAccessError(f"cannot read robot {name}: there is no such file")
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
