"""Choice of flat or smooth shading."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_SHARP_COSINE = 0.82  # 35 degrees between neighboring faces
_SHARP_SHARE = 0.2
"""Fraction of the area in faces with a sharp edge; areas make a few long faces count."""


def is_faceted(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> bool:
    """Return whether a mesh has sharp edges, which smooth shading would blur.

    Args:
        vertices: (n, 3).
        faces: (m, 3) int.

    Example:
        >>> import numpy as np
        >>> is_faceted(np.eye(3), np.array([[0, 1, 2], [0, 2, 1]]))
        True
    """
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    normals /= np.maximum(areas[:, None], 1e-300)
    edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    owner = np.repeat(np.arange(len(faces)), 3)
    order = np.lexsort(edges.T)
    edges, owner = edges[order], owner[order]
    shared = (edges[1:] == edges[:-1]).all(axis=1)
    first, second = owner[1:][shared], owner[:-1][shared]
    sharp = np.einsum("ij,ij->i", normals[first], normals[second]) < _SHARP_COSINE
    edged = np.unique([first[sharp], second[sharp]])
    return bool(areas[edged].sum() > _SHARP_SHARE * areas.sum())
