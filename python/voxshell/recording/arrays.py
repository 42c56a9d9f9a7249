"""Arrays of recordings: copied, checked and read-only."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from voxshell.errors import RecordingError

LARGEST = 1e30
"""Largest size of a number: its square is still finite, and viewers store it in single precision."""


def keep(owner: object, name: str, array: NDArray[Any]) -> None:
    """Store a read-only array in a frozen dataclass."""
    array.flags.writeable = False
    object.__setattr__(owner, name, array)


def as_floats(value: ArrayLike, what: str) -> NDArray[np.float64]:
    """Return a new float64 array; raise an error that counts numbers that are not finite or too large."""
    try:
        array = np.array(value, dtype=np.float64, order="C")
    except (TypeError, ValueError) as error:
        raise RecordingError(f"{what} must be numbers: {error}") from error
    bad = int(np.sum(~np.isfinite(array)))
    if bad:
        raise RecordingError(f"{what} hold {bad} of {array.size} numbers that are not finite")
    bad = int(np.sum(np.abs(array) > LARGEST))
    if bad:
        raise RecordingError(f"{what} hold {bad} of {array.size} numbers beyond {LARGEST:g}")
    return array


def as_points(value: ArrayLike, what: str) -> NDArray[np.float64]:
    """Return a new (n, 3) array; an empty list becomes (0, 3)."""
    array = as_floats(value, what)
    if array.size == 0:
        return np.zeros((0, 3))
    if array.ndim != 2 or array.shape[1] != 3:
        raise RecordingError(f"{what} must have shape (n, 3), got {array.shape}")
    return array


def as_integers(value: ArrayLike, what: str) -> NDArray[np.int64]:
    """Return a new int64 array; floats are refused instead of rounded."""
    array = np.asarray(value)
    if array.size and not np.issubdtype(array.dtype, np.integer):
        raise RecordingError(f"{what} must be integers, got {array.dtype}")
    return np.array(array, dtype=np.int64, order="C")
