"""Runs of everyday scenes: an engine makes the steps, and this module records the motion."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np
from voxshell.errors import MissingExtraError

from voxshell_studies.motion import tabulate
from voxshell_studies.scenes.everyday.scene import Track

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell_studies.part import Tables
    from voxshell_studies.scenes.everyday.scene import Engine, Stage

_FRAMES = 30.0
"""Frames per second of recordings."""


class Running(Protocol):
    """A stage in an engine."""

    def step(self) -> bool:
        """Make a step; return False if the state is no longer finite."""
        ...

    def state(
        self, name: str
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Return a body's ``world_from_body``, (4, 4), velocity of its center, and spin, (3,)."""
        ...


def build_running(stage: Stage, engine: Engine, time_step: float, *, smooth: bool) -> Running:
    """Set the stage up in an engine.

    Raises:
        MissingExtraError: The engine is not installed.
    """
    if engine == "mujoco":
        from voxshell_studies.everyday.mujoco import MuJoCoStage

        return MuJoCoStage(stage, time_step, smooth=smooth)
    from voxshell_studies.everyday.worlds import WorldStage

    return WorldStage(stage, engine, time_step)


def run_stage(
    stage: Stage, engine: Engine, rate: float, seconds: float, *, smooth: bool = False
) -> Track:
    """Step a stage, and record every dynamic body after each step.

    Args:
        stage: The bodies and their places.
        engine: The engine.
        rate: Steps per second.
        seconds: Duration; at least one step.
        smooth: True if nothing touches.

    Returns:
        The track; it is NaN after the step in which the engine failed.
    """
    running = build_running(stage, engine, 1.0 / rate, smooth=smooth)
    names = [item.name for item in stage.items if item.moves]
    steps = max(round(seconds * rate), 1)
    poses = {name: np.full((steps + 1, 4, 4), np.nan) for name in names}
    velocities = {name: np.full((steps + 1, 3), np.nan) for name in names}
    spins = {name: np.full((steps + 1, 3), np.nan) for name in names}
    for step in range(steps + 1):
        if step > 0 and not running.step():
            break
        for name in names:
            poses[name][step], velocities[name][step], spins[name][step] = running.state(name)
    return Track(stage, 1.0 / rate, poses, velocities, spins)


def record_stage(stage: Stage, rate: float, seconds: float) -> Tables:
    """Run a stage with models and record it, with at most 30 frames per second.

    Returns:
        The tables of :func:`voxshell_studies.motion.tabulate`, and "frames": "time_step", seconds
        between frames.
    """
    from voxshell_studies.everyday.worlds import WorldStage

    running = WorldStage(stage, "voxshell", 1.0 / rate)
    every = max(round(rate / _FRAMES), 1)
    recorder = running.world.record(every=every)
    for _ in range(round(seconds * rate)):
        running.step()
    return {**tabulate(recorder.recording()), "frames": {"time_step": np.array([every / rate])}}


def is_installed(engine: Engine) -> bool:
    """Return whether the engine is installed."""
    if engine != "mujoco":
        return True
    try:
        from voxshell_studies.everyday.mujoco import import_mujoco

        import_mujoco()
    except MissingExtraError:
        return False
    return True
