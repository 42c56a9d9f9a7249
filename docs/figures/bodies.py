"""A box and a torus turned against every grid, with their exact distances."""

from collections.abc import Callable

import numpy as np
import trimesh

HALF = np.array([0.05, 0.04, 0.03])
MAJOR, MINOR = 0.04, 0.02
TURN = trimesh.transformations.rotation_matrix(0.6, (1.0, 2.0, 3.0))


def box_distance(points: np.ndarray) -> np.ndarray:
    """Signed distances of points (n, 3)."""
    beyond = np.abs(points @ TURN[:3, :3]) - HALF
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
    return outside + np.minimum(beyond.max(axis=1), 0.0)


def torus_distance(points: np.ndarray) -> np.ndarray:
    """Signed distances of points (n, 3)."""
    x, y, z = (points @ TURN[:3, :3]).T
    return np.hypot(np.hypot(x, y) - MAJOR, z) - MINOR


def make_bodies() -> dict[str, tuple[trimesh.Trimesh, Callable[[np.ndarray], np.ndarray]]]:
    """Mesh and distance of each; the torus' facets are within a micrometer of it."""
    torus = trimesh.creation.torus(MAJOR, MINOR, major_sections=512, minor_sections=256)
    return {
        "box": (trimesh.creation.box(2.0 * HALF).apply_transform(TURN), box_distance),
        "torus": (torus.apply_transform(TURN), torus_distance),
    }
