"""A cache of models on the disk.

:meth:`voxshell.Model.from_mesh` looks here before it builds. The key of a model is a digest of its
mesh and settings, so an entry never goes out of date. Any number of processes may use a folder at
the same time, and may be killed at any time.

The folder is ``$VOXSHELL_CACHE_DIR``, or ``voxshell/models`` in ``$XDG_CACHE_HOME`` or
``~/.cache``. Its limit is ``$VOXSHELL_CACHE_SIZE``, for example "500MB". The default is 2 GB, and
"0" turns the cache off. When the folder exceeds its limit, the least recently used models are
removed.
"""

from __future__ import annotations

import hashlib
import os
import re
import threading
import time
from collections import OrderedDict
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from voxshell import _core
from voxshell.base.unfinished import is_unfinished, remove_stale, unfinished_folder
from voxshell.base.user_warnings import warn_user
from voxshell.errors import (
    MemoryLimitError,
    ModelFileError,
)
from voxshell.model.cache_place import DEFAULT_CAPACITY, find_folder, read_capacity
from voxshell.model.file_lock import FileLock

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from voxshell._core import Model as CoreModel
    from voxshell.model.meshes import Mesh

WORTH_SECONDS = 0.05
"""Models with a shorter build are not kept: storing and loading them would take as long."""

MOST_IN_MEMORY = 16
"""Number of models kept in memory if the folder cannot be used."""

LONGEST_WAIT = 600.0
"""Seconds to wait while another process builds the same model; then this one builds it, too."""

_SEAL, _LONGEST_NAME = 16, 100
"""Digits of a seal, and bytes of a mesh's name in that of a file, which has at most 255."""
_SUFFIX, _LOCK_SUFFIX = ".vxs", ".lock"
_MODEL = re.compile(r"([0-9a-f]{64})-([0-9a-f]{16})(?:-(.+))?\.vxs")
_LOCK = re.compile(r"[0-9a-f]{64}\.lock")


class CacheWarning(UserWarning):
    """Models cannot be kept on the disk, so they are kept in memory. The message says why."""


@dataclass(frozen=True)
class Entry:
    """A model on the disk.

    Attributes:
        key: Digest of its mesh and settings.
        seal: Digest of the key and the file's checksum.
        size: Bytes.
        used: Time of last use, seconds since 1970.
        name: Of the mesh from which it was built first; empty if that had none.
    """

    key: str
    seal: str
    size: int
    used: float
    name: str = ""


class ModelCache:
    """A folder of models.

    Args:
        folder: The folder, which is made when the first model is stored. None if there is no home
            directory.
        capacity: Limit of their total size, bytes; 0 keeps none.

    Example:
        >>> import tempfile, trimesh
        >>> import voxshell as vx
        >>> from voxshell.model.cache import ModelCache
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     cache = ModelCache(Path(folder), capacity=10**9)
        ...     cache.entries()
        []
    """

    def __init__(self, folder: Path | None, capacity: int = DEFAULT_CAPACITY) -> None:
        self.folder = folder
        self.capacity = capacity

    def fetch(
        self,
        key: str,
        build: Callable[[], CoreModel],
        waiting: Callable[[], object] = lambda: None,
        name: str = "",
    ) -> CoreModel:
        """Return the model of a key, and build it if it is not in the cache.

        If several processes or threads request the same model, one of them builds it. If the folder
        cannot be used, models are kept in memory and one warning is issued. A progress callback
        that requests the model being built by its own thread builds another one.

        Args:
            key: From :func:`compute_key`.
            build: Builds the model.
            waiting: Called repeatedly while another process builds the model; may raise.
            name: Of the mesh, for :attr:`Entry.name`; empty if it has none.
        """
        if self.capacity <= 0 or key in _building.keys:
            return build()
        try:
            model = _recall(key) or self._load(key)
        except OSError as error:
            return self._build_for_memory(key, build, error)
        if model is not None:
            return model
        with self._locked(key, waiting) as problem:
            if problem is not None:
                return self._build_for_memory(key, build, problem)
            # Another process may have built it in the meantime, or left a damaged file.
            with suppress(OSError):  # storing reports it
                model = _recall(key) or self._load(key)
            if model is not None:
                return model
            started = time.perf_counter()
            with _building.noted(key):
                model = build()
            if time.perf_counter() - started >= WORTH_SECONDS:
                self._store(key, model, name)
            return model

    def entries(self) -> list[Entry]:
        """Return all models, the most recently used first."""
        found = [
            Entry(match[1], match[2], status.st_size, status.st_mtime, match[3] or "")
            for file, status in self._files()
            if (match := _MODEL.fullmatch(file.name))
        ]
        return sorted(found, key=lambda entry: (-entry.used, entry.key))

    def clear(self) -> int:
        """Remove all models and return how many there were.

        Raises:
            OSError: A model cannot be removed.
        """
        removed = 0
        for entry in self.entries():
            with suppress(FileNotFoundError):
                self._path(entry).unlink()
                removed += 1
        self.sweep()
        return removed

    def sweep(self) -> None:
        """Remove what killed processes left behind."""
        for file, _ in self._files():
            with suppress(OSError):
                if is_unfinished(file.name):
                    remove_stale(Path(file.path))
                elif _LOCK.fullmatch(file.name):
                    with FileLock(Path(file.path)) as lock:
                        lock.try_acquire()

    # ---- files -----------------------------------------------------------------------------------

    def _path(self, entry: Entry) -> Path:
        assert self.folder is not None
        return self.folder / _name(entry.key, entry.seal, entry.name)

    def _load(self, key: str) -> CoreModel | None:
        """Load a model; return None if there is none that can be used."""
        if self.folder is None:
            raise FileNotFoundError("no home directory; set VOXSHELL_CACHE_DIR")
        for path in self._find(key):
            try:
                # The seal of a valid file of another model differs.
                if _read_seal(key, path) != path.name[len(key) + 1 :][:_SEAL]:
                    continue
                model = _core.Model.load(os.fsencode(path))
            except (ModelFileError, MemoryLimitError, OSError):
                continue
            with suppress(OSError):
                os.utime(path)
            return model
        return None

    def _find(self, key: str) -> list[Path]:
        """Return the files of a key, and remove what killed processes left behind."""
        assert self.folder is not None
        names = []
        try:
            with os.scandir(self.folder) as files:
                names = [file.name for file in files]
        except (FileNotFoundError, NotADirectoryError):
            pass
        if not all(name.endswith(_SUFFIX) for name in names):
            self.sweep()
        found = [name for name in names if name.startswith(key)]
        return [self.folder / name for name in found if _MODEL.fullmatch(name)]

    def _store(self, key: str, model: CoreModel, name: str) -> None:
        assert self.folder is not None
        try:
            with unfinished_folder(self.folder, self.folder) as unfinished:
                unnamed = unfinished / f"model{_SUFFIX}"
                model.save(os.fsencode(unnamed))
                for path in self.folder.glob(f"{key}-*{_SUFFIX}"):  # damaged ones
                    with suppress(FileNotFoundError):
                        path.unlink()
                seal = _read_seal(key, unnamed)
                unnamed.replace(self.folder / _name(key, seal, _as_file_name(name)))
            self._make_room()
        except OSError as error:
            self._warn(error)
            _remember(key, model)

    def _make_room(self) -> None:
        self.sweep()
        entries = self.entries()
        total = sum(entry.size for entry in entries)
        while total > self.capacity:
            oldest = entries.pop()
            with suppress(FileNotFoundError):
                self._path(oldest).unlink()
            total -= oldest.size

    def _files(self) -> Iterator[tuple[os.DirEntry[str], os.stat_result]]:
        if self.folder is None:
            return
        with suppress(FileNotFoundError, NotADirectoryError), os.scandir(self.folder) as files:
            for file in files:
                with suppress(FileNotFoundError):
                    yield file, file.stat(follow_symlinks=False)

    @contextmanager
    def _locked(self, key: str, waiting: Callable[[], object]) -> Iterator[OSError | None]:
        """Hold the lock of a key, or yield the error that prevents it."""
        assert self.folder is not None
        lock = FileLock(self.folder / (key + _LOCK_SUFFIX))
        give_up = time.monotonic() + LONGEST_WAIT
        pause = 0.001
        while True:
            try:
                self.folder.mkdir(parents=True, exist_ok=True)
                held = lock.try_acquire()
            except OSError as error:
                yield error
                return
            if held or time.monotonic() > give_up:
                break
            waiting()
            time.sleep(pause)
            pause = min(2 * pause, 0.05)
        with lock:
            yield None

    # ---- without a folder ------------------------------------------------------------------------

    def _build_for_memory(
        self, key: str, build: Callable[[], CoreModel], problem: OSError
    ) -> CoreModel:
        self._warn(problem)
        model = build()
        _remember(key, model)
        return model

    def _warn(self, problem: OSError) -> None:
        place = "" if self.folder is None else f" in {self.folder}"
        message = (
            f"models cannot be cached{place} ({problem}); they are kept in memory. "
            "VOXSHELL_CACHE_DIR names another folder, VOXSHELL_CACHE_SIZE=0 turns the cache off"
        )
        if place not in _warned:
            _warned.add(place)
            warn_user(message, CacheWarning)


def _name(key: str, seal: str, name: str) -> str:
    return f"{key}-{seal}{'-' if name else ''}{name}{_SUFFIX}"


def _as_file_name(name: str) -> str:
    """Return a mesh's name without what file names may not have, and not too long for one."""
    return re.sub(r"[^\w.+-]+", "_", name).encode()[:_LONGEST_NAME].decode(errors="ignore")


def _read_seal(key: str, path: Path) -> str:
    """Return the seal of a model file: its checksum follows the magic number."""
    # A pipe has nothing to read, where open() and read() would wait for a writer.
    with open(path, "rb", buffering=0, opener=_open_at_once) as file:
        checksum = (file.read(16) or b"")[8:]
    return hashlib.sha256(key.encode() + checksum).hexdigest()[:_SEAL]


def _open_at_once(path: str, flags: int) -> int:
    return os.open(path, flags | os.O_NONBLOCK | os.O_CLOEXEC)


class _Building(threading.local):
    """The models that a thread is building; it must not wait for them."""

    def __init__(self) -> None:
        self.keys: set[str] = set()

    @contextmanager
    def noted(self, key: str) -> Iterator[None]:
        self.keys.add(key)
        try:
            yield
        finally:
            self.keys.remove(key)


_building = _Building()
_memory: OrderedDict[str, CoreModel] = OrderedDict()
_memory_lock = threading.Lock()
_warned: set[str] = set()


def _recall(key: str) -> CoreModel | None:
    with _memory_lock:
        model = _memory.get(key)
        if model is not None:
            _memory.move_to_end(key)
        return model


def _remember(key: str, model: CoreModel) -> None:
    with _memory_lock:
        _memory[key] = model
        while len(_memory) > MOST_IN_MEMORY:
            _memory.popitem(last=False)


def open_cache() -> ModelCache:
    """Return the cache that the environment names.

    Raises:
        SettingsError: ``VOXSHELL_CACHE_SIZE`` is not a size.
    """
    return ModelCache(find_folder(os.environ), read_capacity(os.environ))


def compute_key(mesh: Mesh, settings: Mapping[str, float]) -> str:
    """Return a digest of everything that a model depends on: mesh, settings and code.

    Args:
        mesh: The mesh as the core receives it, in meters.
        settings: The settings as the core receives them.
    """
    digest = hashlib.sha256(_digest_of_code())
    for name, value in sorted(settings.items()):
        digest.update(f"{name}={value!r};".encode())
    for array in mesh:
        digest.update(f"{array.dtype.str}{array.shape};".encode())
        digest.update(array.data)
    return digest.hexdigest()


@cache
def _digest_of_code() -> bytes:
    """Return a digest of the compiled core: another build of it may build other models."""
    assert _core.__file__ is not None
    return hashlib.sha256(Path(_core.__file__).read_bytes()).digest()
