"""Triangle meshes of shapes, to look at and to weigh."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from voxshell.meshes import Mesh
from voxshell.shapes import Box, Plane, Sphere

if TYPE_CHECKING:
    from voxshell.world import Shape

PLANE_EXTENT = 2.0
"""Edge of the square that stands for a plane in pictures, metres."""

_PLANE_THICKNESS = 0.01


def mesh_of(shape: Shape) -> Mesh:
    """The surface of a shape in its body frame. A plane becomes a square plate below its surface."""
    from trimesh import creation
    from trimesh.geometry import align_vectors

    match shape:
        case Box():
            mesh = creation.box(extents=2.0 * shape.half_extents)
        case Sphere():
            mesh = creation.icosphere(subdivisions=4, radius=shape.radius)
        case Plane():
            mesh = creation.box(extents=(PLANE_EXTENT, PLANE_EXTENT, _PLANE_THICKNESS))
            mesh.apply_translation((0.0, 0.0, shape.offset - _PLANE_THICKNESS / 2.0))
            mesh.apply_transform(align_vectors((0.0, 0.0, 1.0), shape.normal))
        case _:
            return shape.mesh
    return Mesh(np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.uint32))
