"""Steps of a world, timed at given poses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from voxshell.simulation.body import Body
    from voxshell.simulation.world import World


STAGES = ("query", "reduction", "manifold")
"""Stages of a model's narrow phase, as columns of :attr:`voxshell.World.timings`."""


def time_poses(
    world: World,
    body: Body,
    poses: NDArray[np.float64],
    velocities: NDArray[np.float64] | None = None,
) -> NDArray[np.void]:
    """Return times of steps in which a body starts from given poses.

    Args:
        world: A world, without gravity if the body is to be at rest.
        body: A body of the world.
        poses: (n, 4, 4) ``world_from_body``.
        velocities: (n, 2, 3) linear, m/s, and angular, rad/s, world frame, at these poses; at rest
            by default.

    Returns:
        (n,) as :attr:`voxshell.World.timings`.
    """
    before = len(world.timings)
    if velocities is None:
        velocities = np.zeros((len(poses), 2, 3))
    for pose, (linear, angular) in zip(poses, velocities, strict=True):
        body.pose = pose
        body.linear_velocity, body.angular_velocity = linear, angular
        world.step()
    return world.timings[before:]
