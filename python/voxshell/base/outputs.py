"""Writing of output files: check the place before the work, then write completely or not at all.

An incomplete file has a temporary name beside its target and stays locked while its writer runs. If
a writer is killed, the next writer in the same folder removes what it left.
"""

from __future__ import annotations

import errno
import os
import shutil
import stat
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from voxshell.base.unfinished import close, create_file, sweep, unfinished, unfinished_folder
from voxshell.errors import FileAccessError, MissingFileError, SettingsError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

OF_WRITING = (errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EROFS, errno.EFBIG)
"""Codes of errors that concern writing even if they name no file."""

_WITHOUT_NAMELESS_FILES = (errno.EISDIR, errno.EOPNOTSUPP, errno.EINVAL, errno.ENOENT)
"""Error codes of file systems that do not support unnamed files."""


def check_output_file(path: Path) -> None:
    """Refuse a path where no file can be written. Call this before the work that fills the file.

    Raises:
        SettingsError: It is a folder, a device or a pipe.
        MissingFileError: Its folder does not exist.
        FileAccessError: The system refuses to write it.
    """
    mode = _find_mode(path)
    if mode is not None and stat.S_ISDIR(mode):
        raise SettingsError(f"{path} is a folder; name a file in it")
    if mode is not None and not stat.S_ISREG(mode):
        raise SettingsError(f"{path} is not a regular file; name another")
    parent = _find_mode(path.parent)
    if parent is None or not stat.S_ISDIR(parent):
        raise MissingFileError(explain_missing_folder(path))
    _try_folder(_follow(path).parent, path)


def explain_missing_folder(path: Path) -> str:
    """Return why no file can be written at a path whose parent is not a folder."""
    if _find_mode(path.parent) is None:
        return f"cannot write {path}: the folder {path.parent} does not exist; create it first"
    return f"cannot write {path}: {path.parent} is not a folder"


def check_output_folder(folder: Path, names: Sequence[str] = ()) -> None:
    """Refuse a path where no files can be written. Call this before the work that fills it.

    Args:
        folder: It and its parents need not exist yet.
        names: Names of the files to write into it.

    Raises:
        SettingsError: The path or one of its parents is not a folder, or a name belongs to
            something that is not a regular file.
        FileAccessError: The system refuses to write it.
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
    """Refuse a file name whose suffix does not match what is written.

    Args:
        path: The file to write.
        suffixes: Valid suffixes, such as ``(".html",)``; case does not matter.
        what: What is written, for the error message.

    Raises:
        SettingsError: The suffix is another one or missing.
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
    """Yield a temporary path that replaces ``path``, following links, if the block succeeds.

    The file exists under the temporary path already; the block writes to it.

    Raises:
        SettingsError: No file can be written there.
        FileAccessError: The system refuses to write it.
    """
    check_output_file(path)
    target = _follow(path)
    sweep(target.parent)
    with (
        unfinished(target.parent, path, create_file, path.suffix) as temporary,
        _telling(temporary, path),
    ):
        yield temporary
        flush(temporary)
        temporary.replace(target)
        flush_folder(target.parent)


def write_bytes(path: Path, content: bytes | memoryview) -> None:
    """Write a file completely or not at all. Symbolic links are followed.

    Libraries that write to a path may hide the error of a full disk: let them write to memory
    instead.

    Raises:
        SettingsError: No file can be written there.
        FileAccessError: The system refuses to write it.
    """
    with replacing(path) as temporary:
        temporary.write_bytes(content)


def write_text(path: Path, text: str) -> None:
    """Write text as UTF-8 like :func:`write_bytes`, without changing its newlines.

    Question marks replace what is not Unicode.
    """
    write_bytes(path, text.encode(errors="replace"))


@contextmanager
def filling(folder: Path) -> Iterator[Path]:
    """Yield a temporary folder whose files appear in ``folder`` if the block succeeds.

    A new folder appears with all files, by one rename. In an existing folder, the complete files
    replace those of the same names one after the other. Only one writer can fill a folder at a
    time.

    Raises:
        SettingsError: The files cannot be written there.
        FileAccessError: The system refuses to write them, or another writer is filling the folder.
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
        # New parents are renamed along with the folder, so that a killed writer leaves none of them
        # behind.
        temporary = outer.joinpath(*target.relative_to(nearest).parts[1:])
        with _telling(outer, folder), _telling(temporary, folder):
            temporary.mkdir(parents=True, exist_ok=True)
            yield temporary
            _flush_all(outer)
            if is_new and _appear(outer, nearest / target.relative_to(nearest).parts[0]):
                return
            if is_new:  # another program has made it in the meantime
                make_folder(target)
                held.enter_context(_alone_in(target, folder))
            names = sorted(path.name for path in temporary.iterdir())
            check_output_folder(folder, names)
            for name in names:
                _move(temporary / name, _follow(target / name))
            flush_folder(target)


def make_folder(folder: Path) -> None:
    """Make a folder and its missing parents.

    Raises:
        FileAccessError: The system refuses to make it.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileAccessError(f"cannot write {folder}: {error.strerror}") from error


def flush(path: Path) -> None:
    """Flush a file to the disk, so that a power failure after its rename does not lose its content.

    Raises:
        OSError: The system cannot flush it; the error names the file.
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
    """Flush new names in a folder to the disk, or files may keep their temporary names."""
    with suppress(OSError):
        flush(folder)


def _flush_all(folder: Path) -> None:
    for place, _, names in os.walk(folder):
        for name in names:
            flush(Path(place, name))
        flush_folder(Path(place))


def _appear(temporary: Path, target: Path) -> bool:
    """Rename a folder to a new path or over an empty folder; return whether that worked."""
    try:
        temporary.rename(target)
    except OSError as error:
        if error.errno in (errno.ENOTEMPTY, errno.EEXIST):
            return False
        raise
    flush_folder(target.parent)
    return True


def _move(path: Path, target: Path) -> None:
    """Replace a file in one step, also if a link leads to another disk."""
    try:
        path.replace(target)
    except OSError as error:
        if error.errno != errno.EXDEV:
            raise
        with replacing(target) as temporary:
            shutil.copyfile(path, temporary)


@contextmanager
def _alone_in(folder: Path, asked: Path) -> Iterator[None]:
    """Lock a folder for one writer. The system releases the lock when the process ends."""
    import fcntl

    try:
        descriptor = os.open(folder, os.O_RDONLY | os.O_CLOEXEC)
    except OSError as error:
        raise FileAccessError(f"cannot write {asked}: {error.strerror}") from error
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        close(descriptor)
        raise FileAccessError(
            f"cannot write {asked}: another program is writing into it; wait until it ends, or name "
            "another folder"
        ) from None
    except OSError:  # disks without locks
        pass
    try:
        yield
    finally:
        close(descriptor)


@contextmanager
def _telling(temporary: Path, asked: Path) -> Iterator[None]:
    """Make errors of the system name the requested path instead of the temporary one."""
    try:
        yield
    except FileAccessError as error:
        raise FileAccessError(str(error).replace(str(temporary), str(asked))) from error
    except BrokenPipeError:
        # Such an error comes from printing: no pipe is written to here.
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
        with unfinished(folder, asked, create_file):
            pass
    else:
        close(descriptor)


def _find_mode(path: Path) -> int | None:
    """Return the file mode of what is at a path, following links; None if nothing is there."""
    try:
        return path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as error:
        raise FileAccessError(f"cannot write {path}: {error.strerror}") from error


def _find_nearest(folder: Path) -> Path:
    """Return the folder itself, or its nearest parent that exists."""
    return next(
        (each for each in (folder, *folder.parents) if _find_mode(each) is not None), folder
    )


def _follow(path: Path) -> Path:
    return Path(os.path.realpath(path))
