"""Motion of a scene's kinematic bodies, which have constant velocities."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from voxshell.base.poses import pose as make_pose

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from voxshell.scenes.body_settings import BodySettings
    from voxshell.scenes.scene_file import Scene
    from voxshell.simulation.world import World


def make_mover(scene: Scene, world: World) -> Callable[[World], None] | None:
    """Return what moves the kinematic bodies before each step, or None if all of them stay.

    Args:
        scene: The scene.
        world: The scene's world as built, at time 0.
    """
    moving = [
        (body, settings)
        for body, settings in zip(world.bodies, scene.bodies.values(), strict=True)
        if body.motion == "kinematic" and settings.moves_by_itself
    ]

    def move(world: World) -> None:
        end_of_step = world.time + world.time_step
        for body, settings in moving:
            body.pose = compute_pose(settings, end_of_step)

    return move if moving else None


def compute_pose(body: BodySettings, time: float) -> NDArray[np.float64]:
    """Return ``world_from_body``, (4, 4), of a kinematic body at a time in seconds.

    It follows from the start alone, so that steps add up no rounding errors.
    """
    spin = np.array(body.angular_velocity)
    turn = make_pose(axis_angle=(spin, float(np.linalg.norm(spin)) * time))
    pose = body.pose
    pose[:3, :3] = turn[:3, :3] @ pose[:3, :3]
    pose[:3, 3] += np.array(body.linear_velocity) * time
    return pose
