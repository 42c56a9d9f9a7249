"""Scenes of driven bodies."""

from __future__ import annotations

from voxshell_studies.scenes.limits import SCENES


def test_a_slow_door_pushes_a_cube_without_entering_it_far():
    scene = SCENES["door of 0.8 m pushes a cube of 0.1 m at 2 rad/s"]
    assert 0.0 <= scene.run(200.0, 0) < 2.0


def test_a_gripper_of_models_holds_its_part():
    scene = SCENES["two kinematic fingers hold a part of 0.5 kg, models"]
    assert abs(scene.run(60.0, 0)) < 0.1
