"""Simulation of a scene, with motion and contacts as arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell.recording import BodyTrack, ContactTrack, Recording
from voxshell.scenes.kinematic_motion import make_mover
from voxshell.simulation.body_shapes import mesh_of
from voxshell.simulation.tables import CONTACT_DTYPE, compute_forces

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from voxshell.scenes.scene_file import Scene
    from voxshell.simulation.world import World


@dataclass(frozen=True, eq=False)
class SceneRun:
    """The results of a run, frame by frame; the first frame is the start.

    Attributes:
        times: (frames,) seconds.
        names: The bodies' names, in the order of the arrays.
        poses: (frames, bodies, 4, 4) ``world_from_body``.
        linear_velocities, angular_velocities: (frames, bodies, 3), m/s of the center of mass,
            rad/s.
        contacts: For each frame an array as from :meth:`voxshell.World.contacts`.
        timings: For all steps, as :attr:`voxshell.World.timings`.
    """

    times: NDArray[np.float64]
    names: tuple[str, ...]
    poses: NDArray[np.float64]
    linear_velocities: NDArray[np.float64]
    angular_velocities: NDArray[np.float64]
    contacts: list[NDArray[np.void]]
    timings: NDArray[np.void]


def run_scene(scene: Scene, world: World, progress: Callable[[float], object]) -> SceneRun:
    """Run a world for the duration of its scene.

    Args:
        scene: The scene.
        world: The scene's world as built.
        progress: Called repeatedly with the completed fraction, 0 to 1.

    Raises:
        SettingsError: Bullet cannot follow this gravity with this time step; the message names file
            and line.
    """
    steps, every = scene.world.steps, scene.outputs.every
    move = make_mover(scene, world)
    poses, linear, angular, contacts = [], [], [], []

    def take() -> None:
        poses.append([body.pose for body in world.bodies])
        linear.append([body.linear_velocity for body in world.bodies])
        angular.append([body.angular_velocity for body in world.bodies])
        contacts.append(world.contacts())

    take()
    for step in range(1, steps + 1):
        with scene.naming("scene"):
            world.step(before=move)
        if step % every == 0:
            take()
        if step % 16 == 0:
            progress(step / steps)
    return SceneRun(
        times=np.arange(len(poses), dtype=np.float64) * (every * world.time_step),
        names=tuple(body.name for body in world.bodies),
        poses=np.array(poses),
        linear_velocities=np.array(linear),
        angular_velocities=np.array(angular),
        contacts=contacts,
        timings=world.timings,
    )


def make_recording(scene: Scene, world: World, run: SceneRun) -> Recording:
    """Return a recording of the run."""
    tracks = []
    for index, (body, settings) in enumerate(zip(world.bodies, scene.bodies.values(), strict=True)):
        mesh = mesh_of(body.shape)
        color = settings.color
        assert color is None or len(color) == 3
        faces = mesh.faces.astype(np.int64)
        tracks.append(BodyTrack(body.name, mesh.vertices, faces, color, run.poses[:, index]))
    dynamic = [body.number for body in world.bodies if body.motion == "dynamic"]
    frames = [
        (
            frame["point_b"],
            frame["normal"],
            frame["depth"],
            compute_forces(frame, dynamic, world.time_step),
        )
        for frame in run.contacts
    ]
    time_step = scene.outputs.every * world.time_step
    return Recording(time_step, tuple(tracks), ContactTrack.from_frames(frames))


def tabulate_poses(run: SceneRun) -> dict[str, NDArray[np.generic]]:
    """Return a row for each frame and body: time, name, position, quaternion and velocities."""
    from trimesh.transformations import quaternion_from_matrix

    frames, bodies = run.poses.shape[:2]
    quaternions = np.array([quaternion_from_matrix(pose) for pose in run.poses.reshape(-1, 4, 4)])
    columns: dict[str, NDArray[np.generic]] = {
        "time": np.repeat(run.times, bodies),
        "body": np.tile(np.array(run.names), frames),
    }
    for axis, name in enumerate("xyz"):
        columns[name] = run.poses[:, :, axis, 3].ravel()
    for place, name in enumerate(("qw", "qx", "qy", "qz")):
        columns[name] = quaternions[:, place]
    for prefix, array in (("v", run.linear_velocities), ("w", run.angular_velocities)):
        for axis, name in enumerate("xyz"):
            columns[prefix + name] = array[:, :, axis].ravel()
    return columns


def tabulate_contacts(run: SceneRun) -> dict[str, NDArray[np.generic]]:
    """Return a row for each frame and contact: time, bodies, points, normal, depth and impulses."""
    rows = np.concatenate([np.empty(0, CONTACT_DTYPE), *run.contacts])
    names = np.array(run.names)
    columns: dict[str, NDArray[np.generic]] = {
        "time": np.repeat(run.times, [len(frame) for frame in run.contacts]),
        "body_a": names[rows["body_a"]],
        "body_b": names[rows["body_b"]],
    }
    for name in ("point_a", "point_b", "normal", "friction"):
        for axis, letter in enumerate("xyz"):
            columns[f"{name}_{letter}"] = rows[name][:, axis]
    return columns | {"depth": rows["depth"], "impulse": rows["impulse"]}
