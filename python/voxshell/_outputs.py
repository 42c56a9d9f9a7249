"""Places to write to: checked before the work, and filled whole or not at all.

What is not complete yet has a name of its own, beside the place that it is for, and is locked as long as
its writer lives. The next writer in the same folder removes what a killed one has left.
"""

from __future__ import annotations

import errno
import hashlib
import os
import re
import secrets
import shutil
import socket
import stat
import time
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from voxshell.errors import FileAccessError, SettingsError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

OF_WRITING = (errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EROFS, errno.EFBIG)
"""What the system says of a file without its name; other errors without one are not of files."""

_UNFINISHED = re.compile(r"\.unfinished-([0-9a-f]{8})-[0-9a-f]{16}(\.[^.]*)?")
"""Names of what is not complete: the writer's machine, and a random number."""

_MOST_TRIALS = 100

STALE_SECONDS = 3600.0
"""Age at which unfinished things are removed whose writer may be alive: it runs on another machine, or the
disk knows no locks."""


_WITHOUT_NAMELESS_FILES = (errno.EISDIR, errno.EOPNOTSUPP, errno.EINVAL, errno.ENOENT)
"""What disks say that know no files without a name."""


def check_output_file(path: Path) -> None:
    """Refuses a place that no file can be written to; before the work that fills it.

    Raises:
        SettingsError: It is a folder, a device or a pipe, or there is no folder to write it into.
        FileAccessError: The system does not let it be written.
    """
    mode = _find_mode(path)
    if mode is not None and stat.S_ISDIR(mode):
        raise SettingsError(f"{path} is a folder; name a file in it")
    if mode is not None and not stat.S_ISREG(mode):
        raise SettingsError(f"{path} is not a regular file; name another")
    parent = _find_mode(path.parent)
    if parent is None or not stat.S_ISDIR(parent):
        raise SettingsError(f"cannot write {path}: folder does not exist: {path.parent}")
    _try_folder(_follow(path).parent, path)


def check_output_folder(folder: Path, names: Sequence[str] = ()) -> None:
    """Refuses a place that no folder of files can be written to; before the work that fills it.

    Args:
        folder: May not be there yet, nor the folders that it is in.
        names: The files to be written into it.

    Raises:
        SettingsError: It, or what it would be in, is no folder; or a name is taken by what is no
            file.
        FileAccessError: The system does not let it be written.
    """
    nearest = _find_nearest(folder)
    mode = _find_mode(nearest)
    if mode is None or not stat.S_ISDIR(mode):
        raise SettingsError(f"{nearest} is a file; name a folder")
    for name in names:
        mode = _find_mode(folder / name)
        if mode is not None and not stat.S_ISREG(mode):
            kind = "a folder" if stat.S_ISDIR(mode) else "not a regular file"
            raise SettingsError(
                f"{folder / name} is {kind}, and a file is to be written there; name another folder"
            )
        if (folder / name).is_symlink():
            check_output_file(_follow(folder / name))
    _try_folder(nearest, folder)


def check_suffix(path: Path, suffixes: Sequence[str], what: str) -> None:
    """Refuses a name whose ending says something else than what is written.

    Args:
        path: Of a file to write.
        suffixes: Those that fit, such as ``(".html",)``; capitals do not matter.
        what: Is written, for people.

    Raises:
        SettingsError: It has another ending, or none.
    """
    if path.suffix.lower() not in suffixes:
        ending = f"in {path.suffix!r}" if path.suffix else "without a suffix"
        wanted = " or ".join(suffixes)
        raise SettingsError(
            f"{what} needs a file name that ends in {wanted}, but {path.name!r} ends {ending}; "
            f"try {path.with_suffix(suffixes[0]).name!r}"
        )


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A temporary path that takes the place of ``path`` if the block succeeds; where links lead.

    The block writes to the file that is there under the temporary path.

    Raises:
        SettingsError: No file can be written there.
        FileAccessError: The system does not let it be written.
    """
    check_output_file(path)
    target = _follow(path)
    sweep(target.parent)
    with (
        _unfinished(target.parent, path, _create_file, path.suffix) as temporary,
        _telling(temporary, path),
    ):
        yield temporary
        flush(temporary)
        temporary.replace(target)
        flush_folder(target.parent)


def write_bytes(path: Path, content: bytes | memoryview) -> None:
    """Writes a file, whole or not at all; where links lead.

    Libraries that write to a path may lose what the system says of a full disk: let them write to memory.

    Raises:
        SettingsError: No file can be written there.
        FileAccessError: The system does not let it be written.
    """
    with replacing(path) as temporary:
        temporary.write_bytes(content)


def write_text(path: Path, text: str) -> None:
    """The same as UTF-8, with the newlines that the text has."""
    write_bytes(path, text.encode())


@contextmanager
def filling(folder: Path) -> Iterator[Path]:
    """A temporary folder whose files appear in ``folder`` together if the block succeeds.

    A new folder appears with them, by one rename. In one that is there already they take the place of
    files of their names one by one, each whole, once all are complete. One writer at a time fills it.

    Raises:
        SettingsError: The files cannot be written there.
        FileAccessError: The system does not let them be written, or another writer fills the folder.
    """
    check_output_folder(folder)
    target = _follow(folder)
    nearest = _find_nearest(target)
    sweep(target.parent)
    with ExitStack() as held:
        is_new = nearest != target
        if not is_new:
            held.enter_context(_alone_in(target, folder))
        outer = held.enter_context(unfinished_folder(nearest, folder))
        # A new folder is renamed with those that it is in, so that a killed writer leaves none of them.
        temporary = outer.joinpath(*target.relative_to(nearest).parts[1:])
        with _telling(outer, folder), _telling(temporary, folder):
            temporary.mkdir(parents=True, exist_ok=True)
            yield temporary
            _flush_all(outer)
            if is_new and _appear(outer, nearest / target.relative_to(nearest).parts[0]):
                return
            if is_new:  # and made by somebody else meanwhile
                make_folder(target)
                held.enter_context(_alone_in(target, folder))
            names = sorted(path.name for path in temporary.iterdir())
            check_output_folder(folder, names)
            for name in names:
                _move(temporary / name, _follow(target / name))
            flush_folder(target)


def make_folder(folder: Path) -> None:
    """Makes a folder and those that it is in, where they are not there yet.

    Raises:
        FileAccessError: The system does not let it be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileAccessError(f"cannot write {folder}: {error.strerror}") from error


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
    with _unfinished(parent, asked, _create_folder) as folder:
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


def flush(path: Path) -> None:
    """Brings a file's content to the disk, so that no power cut leaves its new name without it.

    Raises:
        OSError: The system cannot; the error names the file.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from error


def flush_folder(folder: Path) -> None:
    """Brings new names to the disk. Where that cannot be done, files are whole under one name or another."""
    with suppress(OSError):
        flush(folder)


def _flush_all(folder: Path) -> None:
    for place, _, names in os.walk(folder):
        for name in names:
            flush(Path(place, name))
        flush_folder(Path(place))


def _appear(temporary: Path, target: Path) -> bool:
    """Whether a folder could take a place where there was none, or an empty one."""
    try:
        temporary.rename(target)
    except OSError as error:
        if error.errno in (errno.ENOTEMPTY, errno.EEXIST):
            return False
        raise
    flush_folder(target.parent)
    return True


def _move(path: Path, target: Path) -> None:
    """Lets a file take a place, whole at once; also where a link leads to another disk."""
    try:
        path.replace(target)
    except OSError as error:
        if error.errno != errno.EXDEV:
            raise
        with replacing(target) as temporary:
            shutil.copyfile(path, temporary)


@contextmanager
def _alone_in(folder: Path, asked: Path) -> Iterator[None]:
    """Refuses a folder that another writer fills; the system forgets who has ended, or was killed."""
    import fcntl

    try:
        descriptor = os.open(folder, os.O_RDONLY | os.O_CLOEXEC)
    except OSError as error:
        raise FileAccessError(f"cannot write {asked}: {error.strerror}") from error
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        _close(descriptor)
        raise FileAccessError(
            f"cannot write {asked}: another program is writing into it; wait until it ends, or name "
            "another folder"
        ) from None
    except OSError:  # disks that know no locks
        pass
    try:
        yield
    finally:
        _close(descriptor)


@contextmanager
def _unfinished(
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
                _close(descriptor)
    raise FileAccessError(f"cannot write {asked}: another program removes the files")


def _create_file(path: Path) -> int:
    return os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)


def _create_folder(path: Path) -> int | None:
    """None where a program that sweeps has removed it before it could be opened."""
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


def _close(descriptor: int) -> None:
    """Of what was only locked, or is on the disk already: there is nothing to lose."""
    with suppress(OSError):
        os.close(descriptor)


@contextmanager
def _telling(temporary: Path, asked: Path) -> Iterator[None]:
    """Lets errors of the system name the place that was asked for, not the temporary one."""
    try:
        yield
    except FileAccessError as error:
        raise FileAccessError(str(error).replace(str(temporary), str(asked))) from error
    except BrokenPipeError:
        # Of what is printed meanwhile: no pipe is written to here.
        raise
    except OSError as error:
        named = isinstance(error.filename, str)
        if not (error.filename.startswith(str(temporary)) if named else error.errno in OF_WRITING):
            raise
        path = str(error.filename or temporary).replace(str(temporary), str(asked))
        raise FileAccessError(f"cannot write {path}: {error.strerror or error}") from error


def _try_folder(folder: Path, asked: Path) -> None:
    try:
        descriptor = os.open(folder, os.O_TMPFILE | os.O_RDWR | os.O_CLOEXEC)
    except OSError as error:
        if error.errno not in _WITHOUT_NAMELESS_FILES:
            raise FileAccessError(f"cannot write {asked}: {error.strerror}") from error
        with _unfinished(folder, asked, _create_file):
            pass
    else:
        _close(descriptor)


def _find_mode(path: Path) -> int | None:
    """What is there, where links lead; None where there is nothing."""
    try:
        return path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as error:
        raise FileAccessError(f"cannot write {path}: {error.strerror}") from error


def _find_nearest(folder: Path) -> Path:
    """The folder itself, or the nearest one above that is there."""
    return next(
        (each for each in (folder, *folder.parents) if _find_mode(each) is not None), folder
    )


def _follow(path: Path) -> Path:
    return Path(os.path.realpath(path))
