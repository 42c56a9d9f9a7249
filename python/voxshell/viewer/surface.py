"""How a surface is shaded."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_SHARP_COSINE = 0.82  # 35 degrees between neighbouring faces
_SHARP_SHARE = 0.05


def is_faceted(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> bool:
    """Whether a mesh has sharp edges, which smooth shading would smear.

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
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    owner = np.repeat(np.arange(len(faces)), 3)
    order = np.lexsort(edges.T)
    edges, owner = edges[order], owner[order]
    shared = (edges[1:] == edges[:-1]).all(axis=1)
    if not shared.any():
        return False
    cosine = np.einsum("ij,ij->i", normals[owner[1:][shared]], normals[owner[:-1][shared]])
    return bool(np.mean(cosine < _SHARP_COSINE) > _SHARP_SHARE)
