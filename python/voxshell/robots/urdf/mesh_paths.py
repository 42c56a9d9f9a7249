"""Search for the mesh files that a URDF file names."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING
from urllib.parse import unquote

if TYPE_CHECKING:
    from collections.abc import Iterator

_PACKAGE_SCHEMES = ("package://", "model://")


def find_mesh(robot_path: str, name: str) -> str | None:
    """Return the path of a mesh file, or None if there is no such file.

    A name is searched in the folder of the robot's file and in each folder above it. A name with
    ``package://`` or ``model://`` is searched there with and without the name of the package, and
    in the folders of the environment variable ``ROS_PACKAGE_PATH``. Backslashes separate folders,
    as on Windows.

    Args:
        robot_path: The path of the robot's file.
        name: The name in the robot's file.
    """
    candidates = _list_candidates(robot_path, name.strip().replace("\\", "/"))
    return next(filter(os.path.isfile, candidates), None)


def _list_candidates(robot_path: str, name: str) -> Iterator[str]:
    folder = os.path.dirname(os.path.abspath(robot_path))
    if name.startswith("file://"):
        name = unquote(name[len("file://") :])
    elif name.startswith("$(find "):
        name = _PACKAGE_SCHEMES[0] + name[len("$(find ") :].replace(")", "", 1)
    relatives = [name]
    for scheme in _PACKAGE_SCHEMES:
        if name.startswith(scheme):
            whole = name[len(scheme) :].lstrip("/")
            _, _, inside = whole.partition("/")
            relatives = [whole, inside]
            break
    else:
        if os.path.isabs(name) or "://" in name:
            yield name
            return
    relatives = [relative for relative in relatives if relative]
    for parent in _list_parents(folder):
        for relative in relatives:
            yield os.path.join(parent, relative)
    if len(relatives) > 1:
        for parent in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep):
            if not parent:
                continue
            yield os.path.join(parent, relatives[0])
            yield os.path.join(os.path.dirname(parent), relatives[0])


def _list_parents(folder: str) -> Iterator[str]:
    """Yield a folder, then each folder above it."""
    while True:
        yield folder
        above = os.path.dirname(folder)
        if above == folder:
            return
        folder = above
