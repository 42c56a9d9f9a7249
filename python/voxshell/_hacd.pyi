"""
HACD of Bullet's extras, to compare with: voxshell_studies.convex_parts.
"""

from typing import Annotated

import numpy
from numpy.typing import NDArray


def decompose(vertices: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], faces: Annotated[NDArray[numpy.uint32], dict(shape=(None, 3), order='C', device='cpu', writable=False)], *, clusters: int, hull_vertices: int, concavity: float) -> list[Annotated[NDArray[numpy.float64], dict(shape=(None, 3))]]:
    """
    The points of convex hulls that stand for a closed mesh.

    Args:
        vertices: (n, 3) float64, any unit.
        faces: (m, 3) uint32.
        clusters: How many hulls at least.
        hull_vertices: Of a hull, at most.
        concavity: Left at most, where the mesh's size is 1000.
    """
