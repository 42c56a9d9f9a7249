"""Reading of input files other than meshes and models: regular files of limited size."""

from __future__ import annotations

import os
import re
import stat
from itertools import islice
from typing import TYPE_CHECKING

from voxshell.base.near_names import find_closest
from voxshell.errors import FileAccessError, MissingFileError, SettingsError

if TYPE_CHECKING:
    from pathlib import Path

_MOST_ENTRIES = 2000
"""Entries of a folder among which a similar name is searched for."""

_URL = re.compile(
    r"[A-Za-z][A-Za-z0-9+.-]+:/"
)  # a path has one slash of two, Windows' drives one letter


def check_exists(path: str | bytes | os.PathLike[str]) -> None:
    """Refuse a path at which nothing exists, also a URL; its reader reports all other problems.

    The message says which folder a relative path starts from, and names a file of a similar name.

    Raises:
        MissingFileError: Nothing exists there.
    """
    try:
        os.stat(path)
    except (FileNotFoundError, NotADirectoryError):
        name = os.fsdecode(path)
        if not name:
            why = "the path is empty"
        elif _URL.match(name):
            why = "it is a URL; download it, and pass the path of the file"
        else:
            why = f"it does not exist{_advise_on_missing(name)}"
        raise MissingFileError(f"cannot read {name or repr(name)}: {why}") from None
    except (OSError, ValueError):
        return


def _advise_on_missing(name: str) -> str:
    """Return the current folder if a path depends on it, and the file that was probably meant."""
    folder, wanted = os.path.split(name)
    advice = ""
    try:
        if not os.path.isabs(name):
            advice = f"; the current folder is {os.getcwd()}"
        with os.scandir(folder or ".") as entries:
            present = [entry.name for entry in islice(entries, _MOST_ENTRIES)]
    except OSError:
        return advice
    meant = find_closest(wanted, present)
    return f"{advice}; did you mean {os.path.join(folder, meant)}?" if meant else advice


def read_small_file(path: str | Path, most: int, what: str = "file") -> bytes:
    """Read a whole file.

    Args:
        path: The file's path.
        most: Largest size that is accepted, bytes.
        what: Kind of file, for error messages: "scene file".

    Raises:
        MissingFileError: The file does not exist.
        SettingsError: The file is not a regular file, or is larger than ``most``.
        FileAccessError: The system refuses to read the file.
    """
    check_exists(path)
    # open() would block on a pipe that nobody writes to.
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    try:
        descriptor = os.open(path, flags | getattr(os, "O_CLOEXEC", 0))
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or error
        raise FileAccessError(f"cannot read {path}: {why}") from None
    try:
        status = os.fstat(descriptor)
        if stat.S_ISDIR(status.st_mode):
            raise SettingsError(f"cannot read {what} {path}: it is a folder")
        if not stat.S_ISREG(status.st_mode):
            raise SettingsError(f"{path}: not a regular file")
        if status.st_size > most:
            raise SettingsError(f"{path} has {status.st_size} bytes; at most {most} are read")
        with open(descriptor, "rb", closefd=False) as file:
            return file.read(status.st_size)
    finally:
        os.close(descriptor)


def read_needed_file(path: str | Path, most: int, what: str = "file") -> bytes:
    """Read a whole file that an argument names, so that the argument is wrong if that fails.

    Args:
        path: As for :func:`read_small_file`.
        most: Likewise.
        what: Likewise.

    Raises:
        MissingFileError: The file does not exist.
        SettingsError: The file cannot be read otherwise.
    """
    try:
        return read_small_file(path, most, what)
    except MissingFileError:
        raise
    except FileAccessError as error:
        raise SettingsError(str(error)) from error
