"""Rest: how calmly the bunny lies, in many orientations, with every way to make contacts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from voxshell._arguments import as_positive
from voxshell.body import Body
from voxshell.comparison_shapes import ConvexHull
from voxshell.experiments.part import Part
from voxshell.scenes.bunny import BunnySettings, build_block, compute_pose
from voxshell.scenes.drop import BULLET_MARGIN, BULLET_SOLVER
from voxshell.shapes import Plane
from voxshell.world import World

if TYPE_CHECKING:
    from voxshell.experiments.part import Tables

Ground = Literal["voxels", "plane"]
Shell = Literal["fine", "coarse", "hull"]
"""A shell of ours, or Bullet's own hull of the bunny, for comparison."""
Mode = Literal["auto", "regular", "segmented"]

GROUNDS: tuple[Ground, ...] = ("voxels", "plane")
SHELLS: tuple[Shell, ...] = ("fine", "coarse")
"""Ours."""
MODES: tuple[Mode, ...] = ("auto", "regular", "segmented")
BLOCK_HALF_EXTENTS = (0.5, 0.5, 0.05)
"""Of the ground of voxels, metres."""

WINDOW_SECONDS = 0.25
"""In which angular speed and depth are looked at: at its end, "after 2 s" has passed."""


@dataclass(frozen=True)
class RestSettings(BunnySettings):
    """Settings of rest.

    Attributes:
        height: Of the lowest vertex at the start, metres.
        rate: Steps a second.
        settle_seconds: After the first contact, until rest is looked at.
        drift_seconds: After that, over which drift is measured.
    """

    orientations: int = 20
    height: float = 0.05
    rate: float = 200.0
    settle_seconds: float = 2.0
    drift_seconds: float = 10.0

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("height", "rate", "settle_seconds", "drift_seconds"):
            as_positive(getattr(self, name), name)


def plan(settings: RestSettings) -> list[Part]:
    """A part for each ground, shell and mode."""
    steps = settings.rate * (settings.settle_seconds + settings.drift_seconds)
    return [
        Part(
            f"{ground}-{shell}-{mode}",
            run_rests,
            {"settings": settings, "ground": ground, "shell": shell, "mode": mode},
            cost=3e-5 * steps * settings.orientations,
        )
        for ground, shell, mode in [
            *((ground, shell, mode) for ground in GROUNDS for shell in SHELLS for mode in MODES),
            ("plane", "hull", "auto"),
        ]
    ]


def run_rests(settings: RestSettings, ground: Ground, shell: Shell, mode: Mode) -> Tables:
    """Every orientation: turning and depth once settled, drift after, and whether it falls asleep."""
    rows = [
        (orientation, *_lie(settings, ground, shell, mode, orientation))
        for orientation in range(settings.orientations)
    ]
    names = ("orientation", "angular_speed", "depth", "drift", "end_angular_speed", "asleep")
    return {"runs": dict(zip(names, np.array(rows, dtype=np.float64).T, strict=True))}


def _lie(
    settings: RestSettings, ground: Ground, shell: Shell, mode: Mode, orientation: int
) -> tuple[float, float, float, float, bool]:
    world, body = _build_world(settings, ground, shell, mode, orientation, sleeping=False)
    # The fall takes sqrt(2 h / g) seconds.
    settle = settings.settle_seconds + np.sqrt(2.0 * settings.height / 9.81)
    window = round(WINDOW_SECONDS * settings.rate)
    world.step(round(settle * settings.rate) - window)
    turning = depth = 0.0
    for _ in range(window):
        world.step()
        turning = max(turning, float(np.linalg.norm(body.angular_velocity)))
        depth = max(depth, float(world.contacts()["depth"].max(initial=0.0)))
    start = body.pose[:3, 3]
    drift = end = 0.0
    steps = round(settings.drift_seconds * settings.rate)
    for step in range(steps):
        world.step()
        drift = max(drift, float(np.linalg.norm(body.pose[:3, 3] - start)))
        if step >= steps - window:
            end = max(end, float(np.linalg.norm(body.angular_velocity)))
    world, body = _build_world(settings, ground, shell, mode, orientation, sleeping=True)
    world.step(round((settle + settings.drift_seconds) * settings.rate))
    return turning, depth, drift, end, body.sleeping


def _build_world(
    settings: RestSettings,
    ground: Ground,
    shell: Shell,
    mode: Mode,
    orientation: int,
    *,
    sleeping: bool,
) -> tuple[World, Body]:
    world = World(
        time_step=1.0 / settings.rate,
        contact=mode,
        sleeping=sleeping,
        **(BULLET_SOLVER if shell == "hull" else {}),
    )
    if ground == "plane":
        world.add(Plane(), mass=0.0)
    else:
        pose = np.eye(4)
        pose[2, 3] = -BLOCK_HALF_EXTENTS[2]
        world.add(build_block(BLOCK_HALF_EXTENTS, settings.voxel_size), mass=0.0, pose=pose)
    body = world.add(
        ConvexHull.sampled(settings.build_mesh().vertices, margin=BULLET_MARGIN)
        if shell == "hull"
        else settings.build_model(shell),
        mass=settings.mass,
        pose=compute_pose(settings.build_mesh(), orientation, settings.height),
        inertia=settings.mass_properties,
    )
    return world, body
