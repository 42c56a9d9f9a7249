"""The Stanford bunny, from where Debian and Ubuntu keep it."""

from __future__ import annotations

from pathlib import Path

from voxshell.errors import MeshError

_DEBIAN_PATH = Path("/usr/share/glmark2/models/bunny.obj")


def find_bunny() -> Path:
    """The path of the Stanford bunny: 34,835 vertices, closed, y up.

    Raises:
        MeshError: The package that has it is not installed.
    """
    if not _DEBIAN_PATH.is_file():
        raise MeshError(
            f"the Stanford bunny is not at {_DEBIAN_PATH}; "
            "install it (Debian, Ubuntu: apt install glmark2-data) or give another mesh"
        )
    return _DEBIAN_PATH
