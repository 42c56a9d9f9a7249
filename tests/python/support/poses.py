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


def at(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> NDArray[np.float64]:
    """Returns a (4, 4) pose with the world's axes."""
    return pose_of((x, y, z))


def lift(height: float, rotation: NDArray[np.float64] | None = None) -> NDArray[np.float64]:
    """Returns a (4, 4) pose above the world's origin; `rotation` is (3, 3)."""
    pose = at(z=height)
    if rotation is not None:
        pose[:3, :3] = rotation
    return pose


def turned(axis: tuple[float, float, float], angle: float) -> NDArray[np.float64]:
    """Returns a (4, 4) pose at the world's origin, turned by radians."""
    return trimesh.transformations.rotation_matrix(angle, axis)


def random_poses(count: int, reach: float) -> NDArray[np.float64]:
    """Returns (count, 4, 4) poses, of any orientation, at most `reach` from the origin along each axis."""
    rng = np.random.default_rng(18)
    poses = np.stack(
        [trimesh.transformations.random_rotation_matrix(rng.random(3)) for _ in range(count)]
    )
    poses[:, :3, 3] = rng.uniform(-reach, reach, (count, 3))
    return poses
