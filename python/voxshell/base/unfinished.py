"""Temporary files: locked while they are written, and removed if their writer was killed."""

from __future__ import annotations

import hashlib
import os
import re
import secrets
import shutil
import socket
import time
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from voxshell.errors import FileAccessError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

_UNFINISHED = re.compile(r"\.unfinished-([0-9a-f]{8})-[0-9a-f]{16}(\.[^.]*)?")
"""Matches temporary names, which contain a hash of the machine's name and a random number."""

_NO_MACHINE = "00000000"
"""In the names of what could not be locked. No machine trusts its lock, so that it is removed by its
age alone, also if locks work a moment later."""

_MOST_TRIALS = 100

STALE_SECONDS = 3600.0
"""Age at which temporary files are removed although their writer may be alive: it runs on another
machine, or the disk has no locks."""


@contextmanager
def unfinished_folder(parent: Path, asked: Path) -> Iterator[Path]:
    """Yield a temporary folder on the disk of its parent; the block may rename it.

    Args:
        parent: The folder that contains it.
        asked: The path that error messages name.

    Raises:
        FileAccessError: The system refuses to make it.
    """
    sweep(parent)
    with unfinished(parent, asked, create_folder) as folder:
        yield folder


def sweep(folder: Path) -> None:
    """Remove the temporary files that killed writers have left in a folder."""
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if is_unfinished(entry.name):
                remove_stale(Path(entry.path))


def is_unfinished(name: str) -> bool:
    """Return whether a name is that of a temporary file or folder."""
    return _UNFINISHED.fullmatch(name) is not None


def remove_stale(path: Path) -> None:
    """Remove a temporary file or folder unless its writer may be alive."""
    import fcntl

    with suppress(OSError):
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
        try:
            found = _UNFINISHED.fullmatch(path.name)
            tells = found is not None and found[1] == _name_machine()
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                return
            except OSError:  # disks without locks
                tells = False
            if tells or os.fstat(descriptor).st_mtime < time.time() - STALE_SECONDS:
                _remove(path)
        finally:
            os.close(descriptor)


@contextmanager
def unfinished(
    parent: Path, asked: Path, create: Callable[[Path], int | None], suffix: str = ""
) -> Iterator[Path]:
    """Lock a temporary file or folder during the block, then remove it unless it was renamed."""
    import fcntl

    machine = _name_machine()
    for _ in range(_MOST_TRIALS):
        temporary = parent / f".unfinished-{machine}-{secrets.token_hex(8)}{suffix}"
        descriptor = None
        try:
            try:
                descriptor = create(temporary)
            except OSError as error:
                raise FileAccessError(f"cannot write {asked}: {error.strerror}") from error
            if descriptor is None:
                continue
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            except OSError:  # disks without locks
                if machine != _NO_MACHINE:
                    machine = _NO_MACHINE
                    continue
            # Another program's sweep may have removed it before it was locked.
            if _is_at(descriptor, temporary):
                yield temporary
                return
        finally:
            with suppress(OSError):
                _remove(temporary)
            if descriptor is not None:
                close(descriptor)
    raise FileAccessError(f"cannot write {asked}: another program removes the files")


def create_file(path: Path) -> int:
    """Create a file and return its open descriptor."""
    return os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)


def create_folder(path: Path) -> int | None:
    """Create a folder and return its descriptor; None if another program's sweep has removed it."""
    path.mkdir()
    try:
        return os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    except FileNotFoundError:
        return None


def _is_at(descriptor: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), os.stat(path))
    except FileNotFoundError:
        return False


@cache
def _name_machine() -> str:
    """Return a hash of this machine's name. Locks may not work across machines."""
    return hashlib.sha256(socket.gethostname().encode()).hexdigest()[:8]


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink()


def close(descriptor: int) -> None:
    """Close a descriptor. No data is pending, so errors do not matter."""
    with suppress(OSError):
        os.close(descriptor)
