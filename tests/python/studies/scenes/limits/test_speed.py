"""Scenes that time steps."""

from __future__ import annotations

from voxshell_studies.limits import LimitsSettings, plan
from voxshell_studies.scenes.limits import SCENES, speed


def test_scenes_that_time_run_alone():
    timed = {part.arguments["name"] for part in plan(LimitsSettings()) if part.timed}
    assert timed == {scene.name for scene in speed.SCENES}


def test_a_time_is_positive():
    assert SCENES["two bunnies of 0.2 m spin at 30 rad/s beside each other"].run(30.0, 0) > 0.0
