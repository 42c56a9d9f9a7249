"""Input files other than meshes and models: regular ones, of a size that they may have."""

from __future__ import annotations

import os
import stat
from typing import TYPE_CHECKING

from voxshell.errors import FileAccessError, SettingsError

if TYPE_CHECKING:
    from pathlib import Path


def read_small_file(path: str | Path, most: int, what: str = "file") -> bytes:
    """Reads a whole file.

    Args:
        path: Of the file.
        most: Bytes that it may have.
        what: Kind of file, for errors: "scene file".

    Raises:
        SettingsError: The file does not exist, is not a regular file, or is larger than ``most``.
        FileAccessError: The system does not let it be read.
    """
    # A pipe without a writer would keep open() waiting.
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    try:
        descriptor = os.open(path, flags | getattr(os, "O_CLOEXEC", 0))
    except FileNotFoundError:
        raise SettingsError(f"{what} does not exist: {path}") from None
    except (OSError, ValueError) as error:
        raise FileAccessError(f"cannot read {path}: {error}") from None
    try:
        status = os.fstat(descriptor)
        if stat.S_ISDIR(status.st_mode):
            raise SettingsError(f"cannot read {what} {path}: it is a folder")
        if not stat.S_ISREG(status.st_mode):
            raise SettingsError(f"{path}: not a regular file")
        if status.st_size > most:
            raise SettingsError(f"{path} has {status.st_size} bytes, and at most {most} are read")
        with open(descriptor, "rb", closefd=False) as file:
            return file.read(status.st_size)
    finally:
        os.close(descriptor)
