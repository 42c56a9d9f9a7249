"""Poses for tests of worlds."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation


def pose_of(position: ArrayLike, rotation: Rotation | None = None) -> NDArray[np.float64]:
    """Returns a (4, 4) pose; without a rotation, the axes are the world's."""
    pose = np.eye(4)
    pose[:3, 3] = position
    if rotation is not None:
        pose[:3, :3] = rotation.as_matrix()
    return pose
