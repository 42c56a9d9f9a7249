"""Locks between processes and threads."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path


class FileLock:
    """A lock between processes and threads: a locked file that its holder removes."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._descriptor: int | None = None

    def try_acquire(self) -> bool:
        """Try to take the lock; return whether this object holds it.

        Raises:
            OSError: No lock is possible in this place.
        """
        import fcntl

        while True:
            descriptor, is_new = self._open()
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                # The previous holder may have removed the file that is open here.
                if os.path.samestat(os.fstat(descriptor), os.stat(self._path)):
                    self._descriptor = descriptor
                    return True
            except FileNotFoundError:
                pass
            except BlockingIOError:
                os.close(descriptor)
                return False
            except OSError:
                if is_new:  # where there are no locks, nothing else removes it
                    with suppress(OSError):
                        os.unlink(self._path)
                os.close(descriptor)
                raise
            except BaseException:
                os.close(descriptor)
                raise
            os.close(descriptor)

    def _open(self) -> tuple[int, bool]:
        """Open or create the file; return its descriptor, and whether it is surely new."""
        flags = os.O_RDWR | os.O_CREAT | os.O_CLOEXEC
        try:
            return os.open(self._path, flags | os.O_EXCL, 0o666), True
        except FileExistsError:
            return os.open(self._path, flags, 0o666), False

    def __enter__(self) -> FileLock:
        return self

    def __exit__(self, *_: object) -> None:
        if self._descriptor is not None:
            with suppress(OSError):
                os.unlink(self._path)
            with suppress(OSError):  # the file holds no data
                os.close(self._descriptor)
            self._descriptor = None
