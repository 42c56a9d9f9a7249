"""Models that were built before, kept on the disk.

:meth:`voxshell.Model.from_mesh` looks here before it builds. A model is found again by a digest of
its mesh and settings, so that nothing that is found can be out of date. Any number of processes may
use one folder at the same time, and may be killed at any time.

The folder is ``$VOXSHELL_CACHE_DIR``, or ``voxshell/models`` in ``$XDG_CACHE_HOME`` or ``~/.cache``.
It holds at most ``$VOXSHELL_CACHE_SIZE``, such as "500MB"; 2 GB by default; "0" turns the cache off.
The models that were not used for longest go first.
"""

from __future__ import annotations

import hashlib
import os
import re
import threading
import time
import warnings
from collections import OrderedDict
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from voxshell import _core
from voxshell.base.unfinished import is_unfinished, remove_stale, unfinished_folder
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
"""A model that was built faster is not kept: to store and find it would take as long."""

MOST_IN_MEMORY = 16
"""Models kept in memory where the folder cannot be used."""

LONGEST_WAIT = 600.0
"""Seconds to wait for another process that builds the same model, before building it as well."""

_SUFFIX, _LOCK_SUFFIX = ".vxs", ".lock"
_MODEL = re.compile(r"([0-9a-f]{64})-([0-9a-f]{16})\.vxs")
_LOCK = re.compile(r"[0-9a-f]{64}\.lock")


class CacheWarning(UserWarning):
    """Models cannot be kept on the disk: the message says why. They are kept in memory instead."""


@dataclass(frozen=True)
class Entry:
    """One model on the disk.

    Attributes:
        key: Digest of its mesh and settings.
        seal: Digest of the key and the file's checksum.
        size: Bytes.
        used: When it was last used, seconds since 1970.
    """

    key: str
    seal: str
    size: int
    used: float


class ModelCache:
    """A folder of models.

    Args:
        folder: Where they are; it is made when the first model is stored. None: there is no such
            place.
        capacity: Bytes that they may take; 0 keeps none.

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
    ) -> CoreModel:
        """The model of a key, built where it is not there yet.

        Of several processes or threads that ask for the same model, one builds it. Where the folder
        cannot be used, models are kept in memory instead, with one warning. What asks for the model
        while it is built by the same thread, as a progress callback may, builds one of its own.

        Args:
            key: From :func:`compute_key`.
            build: Makes the model.
            waiting: Called now and then while another process builds it; may raise.
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
            # Somebody else may have built it in the meantime, or left a damaged file.
            with suppress(OSError):  # of which storing tells
                model = _recall(key) or self._load(key)
            if model is not None:
                return model
            started = time.perf_counter()
            with _building.noted(key):
                model = build()
            if time.perf_counter() - started >= WORTH_SECONDS:
                self._store(key, model)
            return model

    def entries(self) -> list[Entry]:
        """What is there, the most recently used first."""
        found = [
            Entry(match[1], match[2], status.st_size, status.st_mtime)
            for file, status in self._files()
            if (match := _MODEL.fullmatch(file.name))
        ]
        return sorted(found, key=lambda entry: (-entry.used, entry.key))

    def clear(self) -> int:
        """Removes all models; returns how many there were.

        Raises:
            OSError: One cannot be removed.
        """
        removed = 0
        for entry in self.entries():
            with suppress(FileNotFoundError):
                self._path(entry).unlink()
                removed += 1
        self.sweep()
        return removed

    def sweep(self) -> None:
        """Removes what processes that were killed left behind."""
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
        return self.folder / _name(entry.key, entry.seal)

    def _load(self, key: str) -> CoreModel | None:
        """None where there is none, or none that can be used."""
        if self.folder is None:
            raise FileNotFoundError("no home directory; set VOXSHELL_CACHE_DIR")
        for path in self._find(key):
            try:
                # A sound file of another model has another seal.
                if path.name != _name(key, _read_seal(key, path)):
                    continue
                model = _core.Model.load(os.fsencode(path))
            except (ModelFileError, MemoryLimitError, OSError):
                continue
            with suppress(OSError):
                os.utime(path)
            return model
        return None

    def _find(self, key: str) -> list[Path]:
        """The files of a key; what killed processes left behind is removed on the way."""
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

    def _store(self, key: str, model: CoreModel) -> None:
        assert self.folder is not None
        try:
            with unfinished_folder(self.folder, self.folder) as unfinished:
                unnamed = unfinished / f"model{_SUFFIX}"
                model.save(os.fsencode(unnamed))
                for path in self.folder.glob(f"{key}-*{_SUFFIX}"):  # damaged ones
                    with suppress(FileNotFoundError):
                        path.unlink()
                unnamed.replace(self.folder / _name(key, _read_seal(key, unnamed)))
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
        """Holds the lock of a key, or gives the reason why there is none."""
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
            warnings.warn(message, CacheWarning, stacklevel=2)


def _name(key: str, seal: str) -> str:
    return f"{key}-{seal}{_SUFFIX}"


def _read_seal(key: str, path: Path) -> str:
    """Of a model file, which holds its checksum behind its magic, under a key."""
    with path.open("rb") as file:
        checksum = file.read(16)[8:]
    return hashlib.sha256(key.encode() + checksum).hexdigest()[:16]


class _Building(threading.local):
    """What the thread is building, for which it must not wait."""

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
    """The cache that the environment names.

    Raises:
        SettingsError: ``VOXSHELL_CACHE_SIZE`` is no size.
    """
    return ModelCache(find_folder(os.environ), read_capacity(os.environ))


def compute_key(mesh: Mesh, settings: Mapping[str, float]) -> str:
    """A digest of all that a model depends on: mesh, settings and the code that builds it.

    Args:
        mesh: In metres, as it goes to the core.
        settings: As they go to the core.
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
    """Of the compiled core: another version, or another build, may build another model."""
    assert _core.__file__ is not None
    return hashlib.sha256(Path(_core.__file__).read_bytes()).digest()
