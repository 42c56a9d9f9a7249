"""What is being written has a name of its own, is locked as long as its writer lives, and is swept after that."""

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
"""Names of what is not complete: the writer's machine, and a random number."""

_MOST_TRIALS = 100

STALE_SECONDS = 3600.0
"""Age at which unfinished things are removed whose writer may be alive: it runs on another machine, or the
disk knows no locks."""


@contextmanager
def unfinished_folder(parent: Path, asked: Path) -> Iterator[Path]:
    """A folder for what is not complete, on the disk that it will stay on; it may be renamed.

    Args:
        parent: Where it is.
        asked: What errors name.

    Raises:
        FileAccessError: The system does not let it be made.
    """
    sweep(parent)
    with unfinished(parent, asked, create_folder) as folder:
        yield folder


def sweep(folder: Path) -> None:
    """Removes what killed writers have left unfinished in a folder."""
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if is_unfinished(entry.name):
                remove_stale(Path(entry.path))


def is_unfinished(name: str) -> bool:
    """Whether a file or folder of this name is not complete."""
    return _UNFINISHED.fullmatch(name) is not None


def remove_stale(path: Path) -> None:
    """Removes something unfinished unless its writer may be alive."""
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
            except OSError:  # disks that know no locks
                tells = False
            if tells or os.fstat(descriptor).st_mtime < time.time() - STALE_SECONDS:
                _remove(path)
        finally:
            os.close(descriptor)


@contextmanager
def unfinished(
    parent: Path, asked: Path, create: Callable[[Path], int | None], suffix: str = ""
) -> Iterator[Path]:
    """Something that is locked until the block ends, and removed unless it has another name by then."""
    for _ in range(_MOST_TRIALS):
        temporary = parent / f".unfinished-{_name_machine()}-{secrets.token_hex(8)}{suffix}"
        descriptor = None
        try:
            try:
                descriptor = create(temporary)
            except OSError as error:
                raise FileAccessError(f"cannot write {asked}: {error.strerror}") from error
            # A program that sweeps may have found it before it was locked.
            if descriptor is not None and _lock(descriptor) and _is_at(descriptor, temporary):
                yield temporary
                return
        finally:
            with suppress(OSError):
                _remove(temporary)
            if descriptor is not None:
                close(descriptor)
    raise FileAccessError(f"cannot write {asked}: another program removes the files")


def create_file(path: Path) -> int:
    """A new file, open; its descriptor."""
    return os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)


def create_folder(path: Path) -> int | None:
    """A new folder, open; its descriptor. None where a program that sweeps has removed it before it could be opened."""
    path.mkdir()
    try:
        return os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    except FileNotFoundError:
        return None


def _lock(descriptor: int) -> bool:
    """Whether nobody else holds it; also where the disk knows no locks."""
    import fcntl

    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        pass
    return True


def _is_at(descriptor: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), os.stat(path))
    except FileNotFoundError:
        return False


@cache
def _name_machine() -> str:
    """Locks may be unknown to other machines that have the same disk: what is theirs is left to them."""
    return hashlib.sha256(socket.gethostname().encode()).hexdigest()[:8]


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink()


def close(descriptor: int) -> None:
    """Of what was only locked, or is on the disk already: there is nothing to lose."""
    with suppress(OSError):
        os.close(descriptor)
