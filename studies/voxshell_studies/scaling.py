"""Growth of the narrow phase's time with points and voxels, and of a step's time with bodies."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from voxshell.base.arguments import as_integer, as_positive
from voxshell.errors import SettingsError
from voxshell.measuring.timing import pinned
from voxshell.model.model import Model
from voxshell.simulation.world import World

from voxshell_studies import crowd
from voxshell_studies.crowd import Engine, list_engines, time_bodies
from voxshell_studies.part import Part
from voxshell_studies.scenes.bunny import BunnySettings, build_block, compute_pose
from voxshell_studies.timing import time_poses

if TYPE_CHECKING:
    from voxshell_studies.part import Tables

BLOCK_HALF_EXTENTS = (0.3, 0.3, 0.05)
"""Meters."""

_SECONDS_A_STEP = {"default": 1.5e-3, "uniform": 3e-4, "hulls": 5e-4, "mujoco": 5e-4}
"""Approximate time of a part for each body, seconds."""


@dataclass(frozen=True)
class ScalingSettings(BunnySettings):
    """Settings of the scaling.

    Attributes:
        points: Numbers of points of the shells, ascending.
        voxel_sizes: Voxel sizes of body and ground, meters, descending.
        depth: Depth of the bunny's lowest vertex in the ground, meters.
        shift: Displacement along the ground between steps, back and forth, meters.
        steps: Number of timed steps of each.
        bodies: Numbers of bodies in heaps, ascending.
        poured: Duration of pouring before, seconds.
    """

    orientations: int = 4
    points: tuple[int, ...] = (1_000, 4_000, 16_000, 64_000, 256_000, 1_000_000)
    voxel_sizes: tuple[float, ...] = (0.008, 0.004, 0.002, 0.001)
    depth: float = 0.0005
    shift: float = 0.0001
    steps: int = 400
    bodies: tuple[int, ...] = (10, 30, 100, 300)
    poured: float = 2.0

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("depth", "shift", "poured"):
            as_positive(getattr(self, name), name)
        as_integer(self.steps, "steps", 10, 1_000_000)
        if len(self.points) < 2 or sorted(set(self.points)) != list(self.points):
            raise SettingsError(f"points must be at least two, ascending, not {self.points}")
        if not self.voxel_sizes or min(self.voxel_sizes) <= 0.0:
            raise SettingsError(f"voxel_sizes must be above 0, not {self.voxel_sizes}")
        if not self.bodies or sorted(set(self.bodies)) != list(self.bodies):
            raise SettingsError(f"bodies must be ascending, not {self.bodies}")
        for count in self.bodies:
            as_integer(count, "bodies", 1, 10_000)


def plan(settings: ScalingSettings) -> list[Part]:
    """Return parts over points, over voxel sizes, and for each engine and number of bodies."""
    parts = [
        Part("points", time_points, {"settings": settings}, timed=True, cost=10.0),
        Part("voxels", time_voxels, {"settings": settings}, timed=True, cost=5.0),
    ]
    for engine in list_engines():
        for count in settings.bodies:
            arguments = {"engine": engine, "count": count, "seconds": settings.poured}
            cost = _SECONDS_A_STEP[engine] * count * (crowd.RATE * settings.poured + 200.0)
            parts.append(
                Part(name_crowd(engine, count), time_bodies, arguments, timed=True, cost=cost)
            )
    return parts


def name_crowd(engine: Engine, count: int) -> str:
    """Return the name of the part that times a number of bodies."""
    return f"{count}-bodies-{engine}"


def time_points(settings: ScalingSettings) -> Tables:
    """Return medians over steps and orientations, seconds, for each number of points."""
    return _time(settings, [(points, settings.voxel_size) for points in settings.points])


def time_voxels(settings: ScalingSettings) -> Tables:
    """Return the same for each voxel size, with the fine shell's points."""
    return _time(settings, [(settings.fine_points, size) for size in settings.voxel_sizes])


def _time(settings: ScalingSettings, cases: list[tuple[int, float]]) -> Tables:
    rows = []
    for points, voxel_size in cases:
        mesh = settings.build_mesh()
        start = time.perf_counter()
        model = Model.from_mesh(mesh, voxel_size=voxel_size, target_points=points, cache=False)
        built = time.perf_counter() - start
        for orientation in range(settings.orientations):
            seconds = _lie(settings, model, voxel_size, orientation)
            rows.append(
                (
                    len(model.shell),
                    voxel_size,
                    orientation,
                    np.median(seconds),
                    built,
                    model.field.nbytes,
                )
            )
    names = ("points", "voxel_size", "orientation", "seconds", "build_seconds", "field_bytes")
    return {"times": dict(zip(names, np.array(rows, dtype=np.float64).T, strict=True))}


def _lie(
    settings: ScalingSettings, model: Model, voxel_size: float, orientation: int
) -> np.ndarray:
    """Return seconds of the narrow phase in steps in which the bunny lies in the block."""
    world = World(shell="fewest", gravity=(0.0, 0.0, 0.0), sleeping=False)
    below = np.eye(4)
    below[2, 3] = -BLOCK_HALF_EXTENTS[2]
    world.add(build_block(BLOCK_HALF_EXTENTS, voxel_size), mass=0.0, pose=below)
    pose = compute_pose(settings.build_mesh(), orientation, -settings.depth)
    body = world.add(model, mass=settings.mass, pose=pose)
    poses = np.repeat(pose[None], settings.steps + 10, axis=0)
    poses[:, 0, 3] += settings.shift * (np.arange(len(poses)) % 2)
    with pinned():
        return time_poses(world, body, poses)["narrow_phase"][10:]
