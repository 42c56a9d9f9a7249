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
        ("friction", np.float64, 3),
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

_A_AND_B_EXCHANGED = np.array((1, 0, 2, 6, 7, 8, 3, 4, 5, *range(9, 17)))
"""Columns of a contact's row with the bodies, and the points on them, exchanged."""
_NORMAL_AND_FRICTION = np.array((9, 10, 11, 14, 15, 16))


def as_contacts(rows: NDArray[np.float64]) -> NDArray[np.void]:
    """Return (n,) of CONTACT_DTYPE from (n, 17)."""
    return _as_table(rows, CONTACT_DTYPE)


def take_contacts(
    rows: NDArray[np.float64], body: int, other: int | None = None
) -> NDArray[np.float64]:
    """Return the rows, (n, 17), of one body's contacts, turned so that it is body a.

    Args:
        rows: (n, 17), as for :func:`as_contacts`.
        body: Number of the body.
        other: Number of the other body; None for any.
    """
    is_a, is_b = rows[:, 0] == body, rows[:, 1] == body
    if other is not None:
        is_a &= rows[:, 1] == other
        is_b &= rows[:, 0] == other
    taken = rows[is_a | is_b]
    turned = taken[:, 0] != body
    exchanged = taken[turned][:, _A_AND_B_EXCHANGED]
    # Without negative zeros.
    exchanged[:, _NORMAL_AND_FRICTION] = 0.0 - exchanged[:, _NORMAL_AND_FRICTION]
    taken[turned] = exchanged
    return taken


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
