"""Checks of arguments, shared by the public functions. Each says what it wanted and what it got."""

from __future__ import annotations

import math
import operator
import os
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.errors import (
    FileAccessError,
    InputTypeError,
    SettingsError,
    VoxshellError,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_MOST_THREADS = 1024
FARTHEST = 1e15
"""Metres beyond which a length is refused: its square still fits single precision."""


def as_real(value: Any, name: str) -> float:
    """A finite number."""
    try:
        # True would be 1, a metre where a length is wanted.
        if isinstance(value, (str, bytes, bytearray, bool, np.bool_)):
            raise TypeError
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise SettingsError(f"{name} must be a number, not {value!r}") from None
    if not math.isfinite(number):
        raise SettingsError(f"{name} must be finite, not {number}")
    return number


def as_positive(value: Any, name: str) -> float:
    """A finite number above zero."""
    number = as_real(value, name)
    if not number > 0.0:
        raise SettingsError(f"{name} must be above 0, not {number:g}")
    return number


def as_not_negative(value: Any, name: str) -> float:
    """A finite number of at least 0."""
    number = as_real(value, name)
    if number < 0.0:
        raise SettingsError(f"{name} must be at least 0, not {number:g}")
    return number


def as_share(value: float, name: str) -> float:
    """A number from 0 to 1."""
    share = as_real(value, name)
    if not 0.0 <= share <= 1.0:
        raise SettingsError(f"{name} must be from 0 to 1, not {share:g}")
    return share


def as_length(value: Any, name: str) -> float:
    """A length above zero, in metres."""
    number = as_positive(value, name)
    if number > FARTHEST:
        raise SettingsError(f"{name} must be at most {FARTHEST:g} m, not {number:g}")
    return number


def as_integer(value: Any, name: str, lowest: int, highest: int) -> int:
    """An integer of a range, both ends included."""
    try:
        if isinstance(value, bool):
            raise TypeError
        number = operator.index(value)
    except TypeError:
        raise SettingsError(f"{name} must be an integer, not {value!r}") from None
    if not lowest <= number <= highest:
        raise SettingsError(f"{name} must be from {lowest} to {highest}, not {number}")
    return number


def as_threads(value: Any) -> int:
    """A number of threads for the core, for which None, one a core, is 0."""
    return 0 if value is None else as_integer(value, "threads", 1, _MOST_THREADS)


def as_floats(
    value: ArrayLike,
    name: str,
    shape: tuple[int | None, ...],
    error: type[VoxshellError] = SettingsError,
) -> NDArray[np.float64]:
    """A contiguous float64 array of a shape, in which None stands for any length."""
    try:
        array = np.asarray(value)
    except (TypeError, ValueError) as failure:
        raise error(f"{name} must be {describe(shape)} numbers: {failure}") from None
    fits = array.ndim == len(shape) and all(
        want is None or want == have for want, have in zip(shape, array.shape, strict=True)
    )
    if array.dtype.kind not in "fiu" or not fits:
        raise error(
            f"{name} must be {describe(shape)} numbers, not {describe(array.shape)} {array.dtype}"
        )
    return np.ascontiguousarray(array, dtype=np.float64)


def as_points(value: ArrayLike, name: str) -> NDArray[np.float64]:
    """An (n, 3) array; whether its numbers are finite is for the core to check."""
    return as_floats(value, name, (None, 3))


def as_vector(value: ArrayLike, name: str) -> tuple[float, float, float]:
    """Three finite numbers."""
    x, y, z = as_floats(value, name, (3,)).tolist()
    if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(z)):
        raise SettingsError(f"{name} must be finite, not {(x, y, z)}")
    return x, y, z


def as_path(value: Any, name: str) -> bytes:
    """The name of a file as the system has it."""
    try:
        path = os.fsencode(value)
    except (TypeError, ValueError):
        raise InputTypeError(f"{name} must be a path, not {type(value).__name__}") from None
    if not path or b"\0" in path:
        raise FileAccessError(f"{name} must name a file, not {value!r}")
    return path


def describe(shape: tuple[int | None, ...]) -> str:
    """A shape in words, as in "(n, 3)"."""
    sizes = ["n" if size is None else str(size) for size in shape]
    return f"({sizes[0]},)" if len(sizes) == 1 else f"({', '.join(sizes)})"
