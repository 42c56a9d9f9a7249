"""Places to write to: checked before the work, and filled whole or not at all.

What is not complete yet has a name of its own, beside the place that it is for, and is locked as long as
its writer lives. The next writer in the same folder removes what a killed one has left.
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
from voxshell.errors import FileAccessError, SettingsError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

OF_WRITING = (errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EROFS, errno.EFBIG)
"""What the system says of a file without its name; other errors without one are not of files."""

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
        unfinished(target.parent, path, create_file, path.suffix) as temporary,
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
        close(descriptor)
        raise FileAccessError(
            f"cannot write {asked}: another program is writing into it; wait until it ends, or name "
            "another folder"
        ) from None
    except OSError:  # disks that know no locks
        pass
    try:
        yield
    finally:
        close(descriptor)


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
        with unfinished(folder, asked, create_file):
            pass
    else:
        close(descriptor)


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
