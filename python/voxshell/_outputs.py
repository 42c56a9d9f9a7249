"""Places to write to: checked before the work, and filled whole or not at all."""

from __future__ import annotations

import errno
import os
import shutil
import stat
import tempfile
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from voxshell.errors import FileAccessError, SettingsError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

_OF_WRITING = (errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.EROFS, errno.EFBIG)
"""What the system says of a file without its name; other errors without one are not of files."""


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
        raise SettingsError(f"there is no folder {path.parent} to write into")
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


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A temporary path that takes the place of ``path`` if the block succeeds; where links lead.

    Raises:
        SettingsError: No file can be written there.
        FileAccessError: The system does not let it be written.
    """
    check_output_file(path)
    target = _follow(path)
    with _unfinished(target.parent, path) as folder:
        temporary = folder / path.name
        with _telling(temporary, path):
            yield temporary
            temporary.replace(target)


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
    with ExitStack() as held, _unfinished(_find_nearest(target), folder) as outer:
        is_new = not target.exists()
        if not is_new:
            held.enter_context(_alone_in(target, folder))
        temporary = outer / "files"
        with _telling(temporary, folder):
            temporary.mkdir()
            yield temporary
            if is_new and _appear(temporary, target):
                return
            if is_new:  # and made by somebody else meanwhile
                held.enter_context(_alone_in(target, folder))
            names = sorted(path.name for path in temporary.iterdir())
            check_output_folder(folder, names)
            for name in names:
                # Links may lead to another disk, where only what lies there already is whole at once.
                with replacing(target / name) as place:
                    shutil.move(temporary / name, place)


def _appear(temporary: Path, target: Path) -> bool:
    """Whether a folder could take a place where there was none, or an empty one."""
    target.parent.mkdir(parents=True, exist_ok=True)
    try:
        temporary.rename(target)
    except OSError as error:
        if error.errno in (errno.ENOTEMPTY, errno.EEXIST):
            return False
        raise
    return True


@contextmanager
def _alone_in(folder: Path, asked: Path) -> Iterator[None]:
    """Refuses a folder that another writer fills; the system forgets who has ended, or was killed."""
    import fcntl

    descriptor = os.open(folder, os.O_RDONLY | os.O_CLOEXEC)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        raise FileAccessError(
            f"cannot write {asked}: another program is writing into it; wait until it ends, or name "
            "another folder"
        ) from None
    except OSError:  # disks that know no locks
        pass
    try:
        yield
    finally:
        os.close(descriptor)


@contextmanager
def _unfinished(parent: Path, asked: Path) -> Iterator[Path]:
    """A folder for what is not complete, on the disk that it will stay on."""
    try:
        folder = Path(tempfile.mkdtemp(dir=parent, prefix=".unfinished-"))
    except OSError as error:
        raise FileAccessError(f"cannot write {asked}: {error.strerror}") from error
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


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
        if not (error.filename.startswith(str(temporary)) if named else error.errno in _OF_WRITING):
            raise
        path = str(error.filename or temporary).replace(str(temporary), str(asked))
        raise FileAccessError(f"cannot write {path}: {error.strerror or error}") from error


def _try_folder(folder: Path, asked: Path) -> None:
    try:
        # Has no name where the system knows such files.
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise FileAccessError(f"cannot write {asked}: {error.strerror}") from error


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
