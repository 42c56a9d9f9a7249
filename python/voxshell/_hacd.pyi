"""
HACD from Bullet's extras, a baseline for voxshell_studies.convex_parts.
"""

from typing import Annotated

import numpy
from numpy.typing import NDArray


def decompose(vertices: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], faces: Annotated[NDArray[numpy.uint32], dict(shape=(None, 3), order='C', device='cpu', writable=False)], *, clusters: int, hull_vertices: int, concavity: float) -> list[Annotated[NDArray[numpy.float64], dict(shape=(None, 3))]]:
    """
    Return the points of convex hulls that approximate a closed mesh.

    Args:
        vertices: (n, 3) float64, any unit.
        faces: (m, 3) uint32.
        clusters: Smallest number of hulls.
        hull_vertices: Largest number of vertices of a hull.
        concavity: Largest remaining concavity, for a mesh of size 1000.
    """
