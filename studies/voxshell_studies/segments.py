"""The segmented traverse: whether its time depends on the level."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from voxshell.base.arguments import as_integer, as_positive
from voxshell.errors import SettingsError
from voxshell.measuring.timing import pinned
from voxshell.simulation.world import World

from voxshell_studies.motion import tabulate
from voxshell_studies.part import Part
from voxshell_studies.scenes.bunny import BunnySettings, build_block, compute_pose
from voxshell_studies.timing import STAGES, time_poses

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from voxshell.simulation.body import Body

    from voxshell_studies.part import Columns, Tables

GROUND_HALF_EXTENTS = (0.6, 0.6, 0.05)
"""Side of the ground, meters; the bunny rolls off in no orientation."""

LEVELS = (1, 2, 3, 4, 5)
POSES_OF = 4
"""The level whose poses are used to time all others once more."""

RECORDED_EVERY, RECORDED_STEPS = 2, 300
"""Levels of the falls that are shown."""

TIMES = ("narrow_phase", *STAGES)


@dataclass(frozen=True)
class SegmentsSettings(BunnySettings):
    """Settings of the segmented traverse.

    Attributes:
        height: Initial height of the lowest vertex, meters.
        rate: Steps per second.
        first_step, last_step: Range of steps whose times count, as published.
        repeats: Runs of each case; a step's time is the median over these identical runs.
    """

    height: float = 0.5
    rate: float = 200.0
    first_step: int = 200
    last_step: int = 600
    repeats: int = 5

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("height", "rate"):
            as_positive(getattr(self, name), name)
        for name in ("first_step", "last_step", "repeats"):
            as_integer(getattr(self, name), name, 1, 1_000_000)
        if self.last_step <= self.first_step:
            raise SettingsError("last_step must be after first_step")


def plan(settings: SegmentsSettings) -> list[Part]:
    """Return a part for each orientation, with all levels, and one for the replay."""
    shown = Part("shown", record_levels, {"settings": settings})
    return [shown] + [
        Part(
            f"orientation-{orientation}-{shell}",
            time_levels,
            {"settings": settings, "orientation": orientation, "shell": shell},
            timed=True,
            cost=1e-4 * len(LEVELS) * settings.repeats * settings.last_step,
        )
        for orientation in range(settings.orientations)
        for shell in ("coarse", "fine")
    ]


def time_levels(
    settings: SegmentsSettings, orientation: int, shell: Literal["fine", "coarse"]
) -> Tables:
    """Time the narrow phase and its parts, seconds, in each level's fall and in equal poses."""
    settings.build_model(shell)
    build_block(GROUND_HALF_EXTENTS, settings.voxel_size)
    with pinned():
        # Levels alternate, so that other load on the machine affects all alike.
        runs = [
            {level: _drop(settings, orientation, shell, level) for level in LEVELS}
            for _ in range(settings.repeats)
        ]
        poses = runs[0][POSES_OF].poses[settings.first_step :]
        replays = [
            {level: _replay(settings, shell, level, poses) for level in LEVELS}
            for _ in range(settings.repeats)
        ]
    return {
        "steps": _collect(
            {level: [run[level].timings for run in runs] for level in LEVELS},
            np.arange(1, settings.last_step + 1),
            contacts={level: runs[0][level].contacts for level in LEVELS},
        ),
        "same_poses": _collect(
            {level: [replay[level] for replay in replays] for level in LEVELS},
            np.arange(settings.first_step + 1, settings.last_step + 1),
        ),
    }


def record_levels(settings: SegmentsSettings) -> Tables:
    """Return the fine bunny's upright fall at level N: "N_poses" and "N_contacts"."""
    start = compute_pose(settings.build_mesh(), 0, settings.height)
    tables: dict[str, Columns] = {}
    for level in LEVELS:
        world, _ = _build_world(settings, "fine", level, start, 9.81)
        recorder = world.record(every=RECORDED_EVERY)
        world.step(min(RECORDED_STEPS, settings.last_step))
        for name, columns in tabulate(recorder.recording()).items():
            tables[f"{level}_{name}"] = columns
    return tables


@dataclass(frozen=True, eq=False)
class _Run:
    timings: NDArray[np.float64]
    contacts: NDArray[np.int64]
    poses: NDArray[np.float64]


def _collect(
    timings: dict[int, list[NDArray[np.float64]]],
    steps: NDArray[np.int64],
    contacts: dict[int, NDArray[np.int64]] | None = None,
) -> Columns:
    """Return medians over repeats, seconds, level after level."""
    medians = np.concatenate([np.median(timings[level], axis=0) for level in LEVELS])
    columns = {
        "level": np.repeat(LEVELS, len(steps)),
        "step": np.tile(steps, len(LEVELS)),
        **{name: medians[:, i] for i, name in enumerate(TIMES)},
    }
    if contacts is not None:
        columns["contacts"] = np.concatenate([contacts[level] for level in LEVELS])
    return columns


def _build_world(
    settings: SegmentsSettings,
    shell: Literal["fine", "coarse"],
    level: int,
    pose: NDArray[np.float64],
    gravity: float,
) -> tuple[World, Body]:
    world = World(
        shell="fewest",
        gravity=(0.0, 0.0, -gravity),
        time_step=1.0 / settings.rate,
        sleeping=False,
        contact="segmented",
        level=level,
    )
    below = np.eye(4)
    below[2, 3] = -GROUND_HALF_EXTENTS[2]
    world.add(
        build_block(GROUND_HALF_EXTENTS, settings.voxel_size), mass=0.0, pose=below, name="ground"
    )
    body = world.add(
        settings.build_model(shell),
        mass=settings.mass,
        pose=pose,
        inertia=settings.mass_properties,
        name="bunny",
    )
    return world, body


def _drop(
    settings: SegmentsSettings, orientation: int, shell: Literal["fine", "coarse"], level: int
) -> _Run:
    start = compute_pose(settings.build_mesh(), orientation, settings.height)
    world, body = _build_world(settings, shell, level, start, 9.81)
    contacts = np.zeros(settings.last_step, np.int64)
    poses = np.zeros((settings.last_step, 4, 4))
    for step in range(settings.last_step):
        world.step()
        contacts[step] = len(world.contacts())
        poses[step] = body.pose
    return _Run(_as_columns(world.timings), contacts, poses)


def _replay(
    settings: SegmentsSettings,
    shell: Literal["fine", "coarse"],
    level: int,
    poses: NDArray[np.float64],
) -> NDArray[np.float64]:
    world, body = _build_world(settings, shell, level, poses[0], 0.0)
    return _as_columns(time_poses(world, body, poses))


def _as_columns(timings: NDArray[np.void]) -> NDArray[np.float64]:
    return np.stack([timings[name] for name in TIMES], axis=1)
