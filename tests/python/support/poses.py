"""Poses for tests."""

from __future__ import annotations

import numpy as np
import trimesh
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation


def pose_of(position: ArrayLike, rotation: Rotation | None = None) -> NDArray[np.float64]:
    """Returns a (4, 4) pose; without a rotation, the axes are the world's."""
    pose = np.eye(4)
    pose[:3, 3] = position
    if rotation is not None:
        pose[:3, :3] = rotation.as_matrix()
    return pose


def moved(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> NDArray[np.float64]:
    """Returns a (4, 4) pose with the world's axes."""
    return pose_of((x, y, z))


def turned(axis: tuple[float, float, float], angle: float) -> NDArray[np.float64]:
    """Returns a (4, 4) pose at the world's origin, turned by radians."""
    return trimesh.transformations.rotation_matrix(angle, axis)
