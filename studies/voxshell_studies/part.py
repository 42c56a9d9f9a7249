"""Parts of experiments: units of work that are computed once and identified by their inputs."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, is_dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import voxshell
from numpy.typing import NDArray
from voxshell.measuring.environment import describe_environment

Columns: TypeAlias = Mapping[str, NDArray[Any]]
"""One table: arrays of one length by name."""

Tables: TypeAlias = Mapping[str, Columns]
"""The results of a part: tables by name."""

_ROOTS = (Path(voxshell.__file__).parent, Path(__file__).parent)
# Code that only draws or prints cannot change data: finished parts stay valid after a change there.
_NO_DATA = ("cli", "viewer", "peers", "report")


@dataclass(frozen=True)
class Part:
    """A unit of an experiment: a pure function of plain settings.

    Attributes:
        name: Unique within the experiment, and valid as a file name.
        function: A function at a module's top level that returns tables.
        arguments: Its keyword arguments: dataclasses, numbers, texts, tuples of them.
        timed: True if the tables contain times, so that nothing else may run at the same time.
        cost: Approximate time, seconds, only for progress displays.
    """

    name: str
    function: Callable[..., Tables]
    arguments: Mapping[str, Any] = field(default_factory=dict)
    timed: bool = False
    cost: float = 1.0

    @property
    def address(self) -> str:
        """Digest of function, arguments and code; equal digests give equal data."""
        text = json.dumps(
            [describe_function(self.function), plain(self.arguments), compute_fingerprint()],
            sort_keys=True,
        )
        return hashlib.sha256(text.encode()).hexdigest()[:20]


@dataclass(frozen=True)
class Outcome:
    """The result of a part.

    Attributes:
        tables: The data.
        manifest: How it was made.
    """

    tables: Tables
    manifest: dict[str, Any]


def compute_part(part: Part) -> Outcome:
    """Compute a part in the calling process."""
    start = time.perf_counter()
    tables = {
        name: {key: np.asarray(values) for key, values in columns.items()}
        for name, columns in part.function(**part.arguments).items()
    }
    for name, columns in tables.items():
        lengths = {key: len(values) for key, values in columns.items()}
        if len(set(lengths.values())) > 1:
            raise ValueError(f"{part.name}: columns of {name} differ in length: {lengths}")
    return Outcome(
        tables,
        {
            "part": part.name,
            "address": part.address,
            "function": describe_function(part.function),
            "arguments": plain(part.arguments),
            "timed": part.timed,
            "seconds": round(time.perf_counter() - start, 3),
            "code": compute_fingerprint(),
            "environment": describe_environment(),
        },
    )


def as_columns(names: Sequence[str], rows: Sequence[Sequence[float]]) -> Columns:
    """Return rows of numbers as a table.

    Example:
        >>> as_columns(("step", "seconds"), [(0, 0.5), (1, 0.25)])["seconds"]
        array([0.5 , 0.25])
    """
    values = np.array(rows, dtype=np.float64).reshape(-1, len(names))
    return dict(zip(names, values.T.copy(), strict=True))


def describe_function(function: Callable[..., Any]) -> str:
    """Return the module and name of a function."""
    return f"{function.__module__}.{function.__qualname__}"


def plain(value: Any) -> Any:
    """Return a value as JSON represents it."""
    if is_dataclass(value) and not isinstance(value, type):
        value = asdict(value)
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return value


@cache
def compute_fingerprint() -> str:
    """Return a digest of the compiled modules and of the sources that data depends on."""
    digest = hashlib.sha256()
    for path in sorted(_code_files()):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:20]


def _code_files() -> list[Path]:
    sources = [
        path
        for root in _ROOTS
        for path in root.rglob("*.py")
        if not set(path.relative_to(root).parts) & set(_NO_DATA)
    ]
    compiled = [
        Path(spec.origin)
        for name in ("voxshell._bullet", "voxshell._core")
        if (spec := find_spec(name)) is not None and spec.origin
    ]
    return sources + compiled
