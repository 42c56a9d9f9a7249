"""Convex parts of bodies as tables, which are stored with a part's data and drawn later."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from voxshell_studies.part import Columns


def tabulate_hulls(bodies: Mapping[str, Sequence[NDArray[np.float64]]]) -> Columns:
    """Return the points of some bodies' convex parts.

    Args:
        bodies: (n, 3) points of each part, meters, body frame, by the body's name.

    Returns:
        Columns "body", "part" (its number in the body) and "x", "y", "z", with a row for each
        point.

    Example:
        >>> table = tabulate_hulls({"gear": [np.zeros((4, 3)), np.ones((5, 3))]})
        >>> [len(points) for points in read_hulls(table, "gear")], read_hulls(table, "bolt")
        ([4, 5], [])
    """
    hulls = [(name, i, hull) for name, parts in bodies.items() for i, hull in enumerate(parts)]
    counts = [len(hull) for *_, hull in hulls]
    points = np.concatenate([np.empty((0, 3)), *(hull for *_, hull in hulls)])
    return {
        "body": np.repeat(np.array([name for name, *_ in hulls], np.str_), counts),
        "part": np.repeat(np.array([number for _, number, _ in hulls], np.int64), counts),
        **{axis: points[:, i] for i, axis in enumerate("xyz")},
    }


def read_hulls(table: Columns, body: str) -> list[NDArray[np.float64]]:
    """Return the convex parts of a body from :func:`tabulate_hulls`, (n, 3) each."""
    mine = table["body"] == body
    points = np.stack([table[axis][mine] for axis in "xyz"], axis=1)
    numbers = table["part"][mine]
    return [points[numbers == number] for number in sorted(set(numbers.tolist()))]
