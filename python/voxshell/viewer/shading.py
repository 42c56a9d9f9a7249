"""Choice of flat or smooth shading."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_SHARP_COSINE = 0.82  # 35 degrees between neighboring faces
_SHARP_FRACTION = 0.2
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
    normals = _find_normals(vertices, faces)
    areas = np.linalg.norm(normals, axis=1)
    first, second = (corner // 3 for corner in _find_neighbors(faces))
    sharp = _find_cosines(normals, first, second) < _SHARP_COSINE
    edged = np.unique([first[sharp], second[sharp]])
    return bool(areas[edged].sum() > _SHARP_FRACTION * areas.sum())


def split_creases(
    vertices: NDArray[np.float64], faces: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The same surface with a vertex of its own on each side of a sharp edge, so that smooth shading keeps edges.

    Args:
        vertices: (n, 3).
        faces: (m, 3) int.

    Returns:
        Vertices and faces, in the order of the given faces.

    Example:
        >>> import trimesh
        >>> box = trimesh.creation.box()
        >>> [len(array) for array in split_creases(box.vertices, box.faces)]
        [24, 12]
    """
    normals = _find_normals(vertices, faces)
    first, second = _find_neighbors(faces)
    smooth = _find_cosines(normals, first // 3, second // 3) >= _SHARP_COSINE
    first, second = first[smooth], second[smooth]
    # Corners of neighbors that meet in a vertex become one: at both ends of the edge that they share.
    after = lambda corner: corner - corner % 3 + (corner + 1) % 3  # noqa: E731
    pairs = np.concatenate(
        [np.stack([first, after(second)]), np.stack([after(first), second])], axis=1
    )
    label = np.arange(3 * len(faces))
    while True:
        lower = label.copy()
        for one, other in (pairs, pairs[::-1]):
            np.minimum.at(lower, one, lower[other])
        lower = lower[lower]
        if (lower == label).all():
            break
        label = lower
    kept, corners = np.unique(label, return_inverse=True)
    return vertices[faces.reshape(-1)[kept]], corners.reshape(-1, 3).astype(np.int64)


def find_vertex_normals(
    vertices: NDArray[np.float64], faces: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return unit normals of vertices, (n, 3): means over their faces, weighted with the angles at them.

    Vertices without a face of positive area get +z.

    Args:
        vertices: (n, 3).
        faces: (m, 3) int.

    Example:
        >>> import trimesh
        >>> box = trimesh.creation.box()
        >>> normals = find_vertex_normals(box.vertices, box.faces)
        >>> bool(np.allclose(normals, box.vertices / 0.75**0.5))
        True
    """
    crosses = _find_normals(vertices, faces)
    twice_areas = np.linalg.norm(crosses, axis=1)
    unit = crosses / np.maximum(twice_areas, 1e-300)[:, None]
    corners = vertices[faces]
    along = np.roll(corners, -1, axis=1) - corners
    back = np.roll(corners, 1, axis=1) - corners
    angles = np.arctan2(twice_areas[:, None], np.einsum("fij,fij->fi", along, back))
    sums = np.zeros((len(vertices), 3))
    np.add.at(sums, faces, angles[..., None] * unit[:, None])
    lengths = np.linalg.norm(sums, axis=1)[:, None]
    return np.where(lengths > 1e-9, sums / np.maximum(lengths, 1e-9), (0.0, 0.0, 1.0))


def _find_normals(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
    """(m, 3) of faces, as long as twice their areas."""
    corners = vertices[faces]
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _find_cosines(
    normals: NDArray[np.float64], first: NDArray[np.int64], second: NDArray[np.int64]
) -> NDArray[np.float64]:
    """(k,) of the angles between pairs of faces."""
    unit = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    return np.einsum("ij,ij->i", unit[first], unit[second])


def _find_neighbors(faces: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Of each edge that two faces share, the corner (3 times the face, and 0 to 2) where it begins in each."""
    edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    order = np.lexsort(edges.T)
    shared = (edges[order][1:] == edges[order][:-1]).all(axis=1)
    return order[:-1][shared], order[1:][shared]
