"""Poses in which two bodies overlap slightly."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from voxshell.query.queries import collide

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.model.model import Model


def find_poses_between(
    model: Model, count: int, least_depth: float, most_depth: float, seed: int
) -> NDArray[np.float64]:
    """Return ``world_from_body``, (count, 4, 4), of a body that moves slightly into another one.

    Args:
        model: The model of both bodies; the first is at the world's origin.
        count: Number of poses.
        least_depth: Smallest displacement after the first touch, meters; negative moves back.
        most_depth: Largest displacement, likewise.
        seed: Seed of orientations, directions and depths.
    """
    from trimesh.transformations import random_rotation_matrix

    rng = np.random.default_rng(seed)
    poses = np.zeros((count, 4, 4))
    middle = model.bounds.mean(axis=0)
    reach = 2.0 * float(np.linalg.norm(np.ptp(model.bounds, axis=0)))
    for pose in poses:
        pose[:] = random_rotation_matrix(rng.random(3))
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        # The centers lie on a line along the direction.
        origin = middle - pose[:3, :3] @ middle
        near, far = 0.0, reach
        for _ in range(24):
            distance = 0.5 * (near + far)
            pose[:3, 3] = origin + distance * direction
            near, far = (
                (distance, far)
                if collide(model, model, None, pose, shell="a")
                else (near, distance)
            )
        depth = rng.uniform(least_depth, most_depth)
        pose[:3, 3] = origin + (far - depth) * direction
    return poses
