"""Reading of regular files only: pipes and devices could block the reader, or never end."""

from __future__ import annotations

import os
import stat

from voxshell.errors import MeshError
from voxshell.model.mesh_files.budget import check_expansion, check_size


def read_regular(path: str) -> bytes:
    """Read a file.

    Raises:
        MeshError: It is a folder, a pipe or a device, it does not exist, or it is too large.
        OSError: The system refuses to read it.
    """
    # open() would block on a pipe that nobody writes to.
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    try:
        descriptor = os.open(path, flags | getattr(os, "O_CLOEXEC", 0))
    except FileNotFoundError:
        raise MeshError("it does not exist") from None
    try:
        status = os.fstat(descriptor)
        if stat.S_ISDIR(status.st_mode):
            raise MeshError("it is a folder")
        if not stat.S_ISREG(status.st_mode):
            raise MeshError("it is a pipe or a device; copy the mesh to a regular file")
        check_size(status.st_size)
        if hasattr(status, "st_blocks"):
            check_expansion(status.st_size, 512 * status.st_blocks)  # sparse files
        with open(descriptor, "rb", closefd=False) as file:
            return file.read(status.st_size)
    finally:
        os.close(descriptor)


class Neighbors:
    """The files that a mesh file may refer to: regular files in its folder or below.

    Args:
        path: Path of the mesh file.
    """

    def __init__(self, path: str) -> None:
        self._folder = os.path.realpath(os.path.dirname(path))
        self._read: dict[str, bytes] = {}

    def get(self, name: str) -> bytes:
        """Return a file's content; each file is read once.

        Raises:
            MeshError: The file cannot be read; the message names it.
        """
        path = os.path.realpath(os.path.join(self._folder, name.strip()))
        if os.path.commonpath([path, self._folder]) != self._folder:
            path = os.path.join(self._folder, os.path.basename(name))
        if path not in self._read:
            try:
                self._read[path] = read_regular(path)
                check_size(self.size)
            except (MeshError, OSError) as error:
                raise MeshError(
                    f"it refers to {str(name)[:200]!r}, which cannot be read: {str(error)[:300]}"
                ) from None
        return self._read[path]

    __getitem__ = get

    @property
    def size(self) -> int:
        """Total size of all files read so far, bytes."""
        return sum(map(len, self._read.values()))
