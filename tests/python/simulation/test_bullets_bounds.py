"""Beyond Bullet's bounds, bodies stayed where they were or fell through the ground, and nobody was told."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import numpy as np
import pytest
import voxshell as vx
from voxshell.scenes.scene_file import read_scene
from voxshell.scenes.scene_world import build_world

TURN = np.array([[0.0, -0.6, 0.8, 0], [1, 0, 0, 0], [0, 0.8, 0.6, 0], [0, 0, 0, 1]])


def above(height: float) -> np.ndarray:
    pose = np.eye(4)
    pose[2, 3] = height
    return pose


def test_a_body_too_large_to_move_is_refused():
    world = vx.World()
    with pytest.raises(
        vx.SettingsError, match=r"'moon' .*diagonal of 1.38564e\+06 m.* 500000 m; scale"
    ):
        world.add(vx.Box((4e5, 4e5, 4e5)), name="moon")
    assert world.bodies == ()
    world.step()
    world.add(vx.Box((4e5, 4e5, 4e5)), mass=0, name="ground")


@pytest.mark.parametrize("sleeping", [True, False])
def test_the_largest_bodies_move_in_any_pose(sleeping: bool):
    world = vx.World(sleeping=sleeping)
    half = 0.999 * 5e5 / (2.0 * 3.0**0.5)
    body = world.add(vx.Box((half, half, half)), pose=np.eye(4))
    for pose in (np.eye(4), TURN):
        body.pose = pose
        body.linear_velocity = (0, 0, 0)
        world.step(20)
        assert body.pose[2, 3] == pytest.approx(-0.5 * 9.81 * 0.1**2, rel=0.1)


def test_gravity_that_takes_bodies_out_of_the_simulation_is_refused():
    message = r"^gravity moves bodies by 2.5e\+15 m in the first step .* at most 100000 m"
    with pytest.raises(vx.SettingsError, match=message):
        vx.World(gravity=(0, 0, -1e20))


@pytest.mark.parametrize("rate", [200, 1000.0])
def test_a_rate_as_the_time_step_is_refused_as_one(rate: float):
    """The message spoke of gravity."""
    message = rf"^time_step is {rate:g} s, .* at most 100000 m; .* pass time_step=1/{rate:g}$"
    with pytest.raises(vx.SettingsError, match=message):
        vx.World(time_step=rate)


@pytest.mark.parametrize("rate", [60, 100, 1.5])
def test_a_rate_as_the_time_step_is_warned_of_where_bullet_could_follow(rate: float):
    """It was silent."""
    message = (
        rf"^time_step is {rate:g} s, .* for {rate:g} steps a second, pass time_step=1/{rate:g}$"
    )
    with pytest.warns(vx.AccuracyWarning, match=message):
        vx.World(time_step=rate)


@pytest.mark.parametrize(("time_step", "rate"), [(0.1, "10"), (0.3, "3.33"), (1.0, "1")])
def test_few_steps_a_second_are_warned_of(time_step: float, rate: str):
    message = (
        f"^time_step is {time_step:g} s, only {re.escape(rate)} steps a second, .* such as 1/200"
    )
    with pytest.warns(vx.AccuracyWarning, match=message):
        vx.World(time_step=time_step)


@pytest.mark.parametrize("time_step", [1 / 1000, 1 / 30, 1 / 20])
def test_usual_steps_are_not_warned_of(time_step: float):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        vx.World(time_step=time_step)


def test_long_steps_without_gravity_are_simulated():
    with pytest.warns(vx.AccuracyWarning, match="time_step is 1000 s"):
        world = vx.World(gravity=(0, 0, 0), time_step=1000.0)
    body = world.add(vx.Sphere(1.0))
    body.linear_velocity = (1, 0, 0)
    world.step(3)
    assert body.pose[0, 3] == pytest.approx(3000.0)


def test_a_body_that_moves_too_far_in_a_step_is_told_of_once():
    world = vx.World(gravity=(0, 0, 0))
    body = world.add(vx.Sphere(1.0), name="ball")
    body.linear_velocity = (1e9, 0, 0)
    with pytest.warns(
        vx.AccuracyWarning, match=r"'ball' moves by 5e\+06 m a step, more than 100000"
    ):
        world.step()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        world.step()


def test_a_body_that_bullet_stops_is_told_of():
    """It stood still under a large force, and nothing said so."""
    world = vx.World(gravity=(0, 0, 0))
    body = world.add(vx.Sphere(1.0), mass=1.0, name="ball")
    body.apply_force((1e12, 0, 0))
    with pytest.warns(vx.AccuracyWarning, match=r"'ball' moves by 1e\+06 m a step"):
        world.step()


def test_a_simulation_that_diverges_is_an_error():
    world = vx.World(gravity=(0, 0, 0), solver="nncg")
    body = world.add(vx.Sphere(1.0), mass=1e-3, name="ball")
    before = world.save_state()
    body.apply_torque((1e308, 0, 0))
    steps = []
    with pytest.raises(vx.SimulationError, match=r"'ball' is no longer finite.*'coulomb'"):
        world.step(5, steps.append)
    assert not steps
    lost_at = world.time
    with pytest.raises(vx.SimulationError, match="diverged"):
        world.step(5)
    assert world.time == lost_at + world.time_step, "it goes on after the step that failed"
    world.restore_state(before)
    assert world.time == 0.0
    world.step(5)
    assert np.isfinite(body.pose).all()


def test_a_body_too_heavy_for_any_contact_is_refused():
    """It fell through the ground."""
    world = vx.World()
    with pytest.raises(vx.SettingsError, match=r"mass of 'sun' is 1e\+20 kg.* above 1e\+15 kg"):
        world.add(vx.Sphere(1.0), mass=1e20, name="sun")


def test_a_body_too_light_to_have_an_inverse_mass_is_refused():
    with pytest.raises(vx.SettingsError, match=r"mass of 'dust' is .*; use at least 1e-100 kg"):
        vx.World().add(vx.Sphere(1.0), mass=1e-320, name="dust")


@pytest.mark.parametrize("solver", ["coulomb", "sequential_impulse"])
def test_the_heaviest_bodies_rest(solver):
    world = vx.World(solver=solver)
    world.add(vx.Plane(), mass=0)
    body = world.add(vx.Box((0.1, 0.1, 0.1)), mass=1e15, pose=above(0.101))
    world.step(200)
    assert body.pose[2, 3] == pytest.approx(0.1, abs=1e-3)


@pytest.mark.parametrize("size", [0.005, 0.1, 10.0, 500.0])
@pytest.mark.parametrize("mass", [1e-6, 1.0, 1e6])
def test_what_people_simulate_is_not_warned_of(size: float, mass: float):
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    body = world.add(vx.Sphere(size / 2), mass=mass, pose=above(0.501 * size))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        world.step(200)
    assert body.pose[2, 3] == pytest.approx(0.5 * size, rel=0.01)


@pytest.mark.parametrize(
    ("scene", "message"),
    [
        ("gravity = [0, 0, -1e20]", "first step"),
        ("", r"'a' .*diagonal of"),
    ],
)
def test_scene_files_are_held_to_the_bounds(tmp_path: Path, scene: str, message: str):
    path = tmp_path / "scene.toml"
    path.write_text(f"[scene]\n{scene}\n[bodies.a]\nshape = 'sphere'\nradius = 1e6\nmass = 1\n")
    with pytest.raises(vx.SettingsError, match=message):
        build_world(read_scene(path), lambda *_: None)


def test_robots_are_held_to_the_bounds(tmp_path: Path):
    path = tmp_path / "robot.urdf"
    path.write_text(
        '<robot name="r"><link name="l"><inertial><mass value="1e20"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
        '<collision><geometry><sphere radius="1"/></geometry></collision></link></robot>'
    )
    with pytest.raises(vx.RobotError, match=r"robot.urdf: mass of 'r/l' is 1e\+20 kg"):
        vx.load_urdf(vx.World(), path, fixed_base=False)
