from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import voxshell as vx
from voxshell.scenes.kinematic_motion import make_mover
from voxshell.scenes.scene_file import read_scene
from voxshell.scenes.scene_run import SceneRun, run_scene
from voxshell.scenes.scene_world import build_world

GROUND = '[bodies.ground]\nshape = "plane"\n'
PLATE = (
    '[bodies.plate]\nshape = "box"\nhalf_extents = [1, 0.5, 0.05]\nmotion = "kinematic"\n'
    "position = [1, 2, 3]\n"
)


def run(folder: Path, text: str) -> SceneRun:
    path = folder / "scene.toml"
    path.write_text(f"[scene]\nduration = 1.0\nrate = 100\n{text}")
    scene = read_scene(path)
    return run_scene(scene, build_world(scene, lambda *_: None), lambda _: None)


def test_a_kinematic_body_keeps_its_velocities(tmp_path: Path):
    keys = "rotation_vector = [0, 0, 0.4]\nlinear_velocity = [0.5, 0, -0.1]\n"
    result = run(tmp_path, f"{PLATE}{keys}angular_velocity = [0, 0, 2]\n")
    for frame, time in ((0, 0.0), (1, 0.01), (100, 1.0)):
        place = (1 + 0.5 * time, 2, 3 - 0.1 * time)
        exact = vx.pose(place, axis_angle=((0, 0, 1), 0.4 + 2 * time))
        np.testing.assert_allclose(result.poses[frame, 0], exact, atol=1e-12)
    np.testing.assert_allclose(result.linear_velocities[1:, 0], [(0.5, 0, -0.1)] * 100, atol=1e-9)
    np.testing.assert_allclose(result.angular_velocities[1:, 0], [(0, 0, 2)] * 100, atol=1e-9)


@pytest.mark.parametrize("spin", [0.0, 0.5])
def test_what_lies_on_a_kinematic_body_goes_with_it(tmp_path: Path, spin: float):
    cargo = (
        '[bodies.cargo]\nshape = "box"\nhalf_extents = [0.05, 0.05, 0.05]\n'
        "position = [1.3, 2, 3.1]\nfriction = 1\n"
    )
    velocity = f"linear_velocity = [0.2, 0, 0]\nangular_velocity = [0, 0, {spin}]\n"
    result = run(tmp_path, PLATE + velocity + cargo)
    end = (1.2 + 0.3 * math.cos(spin), 2 + 0.3 * math.sin(spin), 3.1)
    np.testing.assert_allclose(result.poses[-1, 1][:3, 3], end, atol=0.01)


def test_nothing_moves_kinematic_bodies_without_velocities(tmp_path: Path):
    path = tmp_path / "scene.toml"
    path.write_text(GROUND + PLATE + '[bodies.ball]\nshape = "sphere"\nradius = 1\nlinear_velocity = [1, 0, 0]\n')  # fmt: skip
    scene = read_scene(path)
    assert make_mover(scene, build_world(scene, lambda *_: None)) is None
