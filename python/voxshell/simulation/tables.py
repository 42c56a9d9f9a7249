"""Conversion of the bindings' rows of numbers to structured arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

CONTACT_DTYPE = np.dtype(
    [
        ("body_a", np.int32),
        ("body_b", np.int32),
        ("id", np.int32),
        ("point_a", np.float64, 3),
        ("point_b", np.float64, 3),
        ("normal", np.float64, 3),
        ("depth", np.float64),
        ("impulse", np.float64),
    ]
)
RAY_DTYPE = np.dtype(
    [
        ("body", np.int32),
        ("fraction", np.float64),
        ("point", np.float64, 3),
        ("normal", np.float64, 3),
    ]
)
TIMINGS_DTYPE = np.dtype(
    [(name, np.float64) for name in ("step", "narrow_phase", "query", "reduction", "manifold")]
)


def as_contacts(rows: NDArray[np.float64]) -> NDArray[np.void]:
    """Return (n,) of CONTACT_DTYPE from (n, 14)."""
    return _as_table(rows, CONTACT_DTYPE)


def as_hits(rows: NDArray[np.float64]) -> NDArray[np.void]:
    """Return (n,) of RAY_DTYPE from (n, 8)."""
    return _as_table(rows, RAY_DTYPE)


def as_timings(rows: NDArray[np.float64]) -> NDArray[np.void]:
    """Return (n,) of TIMINGS_DTYPE from (n, 5), without a copy."""
    return rows.view(TIMINGS_DTYPE)[:, 0]


def compute_forces(
    contacts: NDArray[np.void], dynamic: Sequence[int], time_step: float
) -> NDArray[np.float64]:
    """(n, 3) newtons, world frame: the normal force of each contact in the last step on the body that it moves.

    That is body a, or body b where a is not dynamic.

    Args:
        contacts: (n,) of CONTACT_DTYPE.
        dynamic: Numbers of the dynamic bodies.
        time_step: Seconds.
    """
    sign = np.where(np.isin(contacts["body_a"], np.asarray(dynamic, np.int64)), 1.0, -1.0)
    return (sign * contacts["impulse"] / time_step)[:, None] * contacts["normal"]


def _as_table(rows: NDArray[np.float64], dtype: np.dtype[np.void]) -> NDArray[np.void]:
    """Assign columns to fields in order, three columns to a vector."""
    table = np.empty(len(rows), dtype)
    column = 0
    for name in dtype.names or ():
        width = int(np.prod(dtype[name].shape, dtype=int))
        table[name] = rows[:, column : column + width].reshape(table[name].shape)
        column += width
    return table
