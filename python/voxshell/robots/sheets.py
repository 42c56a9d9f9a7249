"""Flat collision meshes, which become thin sheets."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from voxshell.model.meshes import Mesh

if TYPE_CHECKING:
    from numpy.typing import NDArray

_FLAT = 3e-5
"""Thickness of a mesh below which it lies in a plane, in diameters: files may have few digits."""

_OF_SIDE, _THICKEST = 1.0 / 200.0, 0.005
"""Thickness of a sheet: in its longest sides, and at most, meters."""


class Sheet(NamedTuple):
    """A mesh in a plane.

    Attributes:
        mesh: Its triangles, each once, all facing along the normal.
        normal: (3,), unit length.
        thickness: That it gets, meters; half of it lies on each side.
    """

    mesh: Mesh
    normal: NDArray[np.float64]
    thickness: float

    def find_points(self) -> NDArray[np.float64]:
        """Return points whose convex hull is that of the thick sheet, (n, 3) meters."""
        half = 0.5 * self.thickness * self.normal
        return np.concatenate([self.mesh.vertices - half, self.mesh.vertices + half])


def find_sheet(mesh: Mesh, thickness: float | None = None) -> Sheet | None:
    """Return a mesh that lies in a plane as a sheet; None if it has a volume, or is a line.

    Args:
        mesh: The mesh, meters.
        thickness: That of the sheet, meters; by default a 200th of its longest side, at most 5 mm.

    Example:
        >>> import numpy as np
        >>> corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0.0)])
        >>> both_sides = Mesh(corners, np.array([(0, 1, 2), (0, 2, 1)], np.uint32))
        >>> sheet = find_sheet(both_sides)
        >>> len(sheet.mesh.faces), sheet.thickness
        (1, 0.005)
    """
    if len(mesh.faces) == 0:
        return None
    # Equal places get one index: files repeat the corners of triangles.
    vertices, places = np.unique(mesh.vertices, axis=0, return_inverse=True)
    faces = places.ravel()[mesh.faces]
    used = vertices[np.unique(faces)]
    _, spread, axes = np.linalg.svd(used - used.mean(axis=0), full_matrices=False)
    if len(spread) < 3 or not spread[1] > _FLAT * spread[0] >= spread[2]:
        return None
    normal = axes[2]
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    up = np.cross(b - a, c - a) @ normal > 0.0
    if _is_closed(faces):
        faces = faces[up]  # its sides may have other triangles
    else:
        faces = np.where(up[:, None], faces, faces[:, ::-1])
        _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
        faces = faces[np.sort(first)]
    if thickness is None:
        thickness = min(_OF_SIDE * float(np.ptp(used, axis=0).max()), _THICKEST)
    return Sheet(Mesh(vertices, faces.astype(np.uint32)), normal, thickness)


def _is_closed(faces: NDArray[np.integer]) -> bool:
    """Return whether each edge is passed as often in one direction as in the other.

    An edge may have four triangles, as those of a flattened box have, which trimesh calls open.
    """
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges = edges[edges[:, 0] != edges[:, 1]]
    lower, upper = edges.min(axis=1), edges.max(axis=1)
    _, which = np.unique(np.column_stack([lower, upper]), axis=0, return_inverse=True)
    sums = np.bincount(which.ravel(), weights=np.where(edges[:, 0] < edges[:, 1], 1.0, -1.0))
    return not sums.any()
