"""Rims of the openings of a mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_MOST_POINTS = 1000
"""Points of a rim that are compared with one another; of longer rims, as many are taken evenly."""


def measure_widest_rim(vertices: NDArray[np.float64], faces: NDArray[np.uint32]) -> float:
    """Return the largest distance between two points of one rim, meters; 0 if there is none.

    A rim consists of edges of one triangle each that hang together.

    Args:
        vertices: (n, 3), meters; equal ones count as one.
        faces: (m, 3), indices of vertices.

    Example:
        >>> corners = np.array([(0, 0, 0), (3, 0, 0), (0, 4, 0)], float)
        >>> measure_widest_rim(corners, np.array([(0, 1, 2)], np.uint32))
        5.0
    """
    # Most meshes share vertices, so that few edges remain to be compared by place.
    edges = _find_single(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]))
    used, ends = np.unique(edges, return_inverse=True)
    places, merged = np.unique(vertices[used], axis=0, return_inverse=True)
    edges = _find_single(merged.reshape(-1)[ends.reshape(-1, 2)])
    if not len(edges):
        return 0.0
    labels = _label_rims(len(places), edges.T)
    # Boxes of the rims; the one of a rim is at its label.
    low, high = places.copy(), places.copy()
    np.minimum.at(low, labels, places)
    np.maximum.at(high, labels, places)
    rim = places[labels == np.linalg.norm(high - low, axis=1).argmax()]
    rim = rim[:: -(-len(rim) // _MOST_POINTS)]
    return max(float(np.linalg.norm(rim - point, axis=1).max()) for point in rim)


def _find_single(edges: NDArray[Any]) -> NDArray[np.int64]:
    """Return the edges, (n, 2), either way around, that occur once and have two different ends."""
    low, high = edges.min(axis=1).astype(np.int64), edges.max(axis=1)
    count = int(high.max(initial=0)) + 1
    keys = np.sort((low * count + high)[low != high])
    occurs_once = (np.diff(keys, prepend=-1) != 0) & (np.diff(keys, append=-1) != 0)
    return np.stack(np.divmod(keys[occurs_once], count), axis=1)


def _label_rims(count: int, ends: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return a number for each point, equal for points that edges connect: that of one of the points."""
    labels = np.arange(count)
    while True:
        low = labels[ends].min(axis=0)
        joined = labels.copy()
        for end in ends:
            np.minimum.at(joined, labels[end], low)
        joined = joined[joined]
        if (joined == labels).all():
            return labels
        labels = joined
