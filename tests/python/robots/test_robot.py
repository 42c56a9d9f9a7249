"""Robots in a world: targets, positions, and what they refuse."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
import voxshell as vx

pytestmark = pytest.mark.filterwarnings("ignore::voxshell.RobotWarning")

INERTIAL = (
    '<inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>'
    "</inertial>"
)
ROBOT = f"""<robot name="tester"><link name="base"/>
<link name="arm">{INERTIAL}</link><link name="slide">{INERTIAL}</link>
<link name="finger">{INERTIAL}</link><link name="thumb">{INERTIAL}</link>
<link name="tool"/><link name="cargo">{INERTIAL}</link>
<joint name="turn" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
  <limit effort="50" velocity="2"/></joint>
<joint name="lift" type="prismatic"><parent link="arm"/><child link="slide"/><origin xyz="1 0 0"/>
  <axis xyz="0 0 1"/><limit lower="0" upper="0.3" effort="80" velocity="1"/></joint>
<joint name="grip" type="prismatic"><parent link="slide"/><child link="finger"/><axis xyz="1 0 0"/>
  <limit lower="-0.1" upper="0.1" effort="30" velocity="1"/><mimic joint="lift" multiplier="0.5" offset="-0.05"/>
  </joint>
<joint name="pinch" type="prismatic"><parent link="finger"/><child link="thumb"/><axis xyz="0 1 0"/>
  <limit lower="-0.1" upper="0.1" effort="30" velocity="1"/><mimic joint="grip" multiplier="-1"/></joint>
<joint name="mount" type="fixed"><parent link="thumb"/><child link="tool"/><origin xyz="0 0 0.1"/></joint>
<joint name="free" type="floating"><parent link="base"/><child link="cargo"/><origin xyz="9 0 0"/></joint>
</robot>"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "tester.urdf"
    path.write_text(ROBOT)
    return path


@pytest.fixture
def world() -> vx.World:
    return vx.World(gravity=(0, 0, 0))


@pytest.fixture
def robot(world: vx.World, path: Path) -> vx.Robot:
    return vx.load_urdf(world, path)


def test_wrong_names_of_parts_are_answered_with_those_that_there_are(robot):
    with pytest.raises(KeyError, match=r"robot 'tester' has no link 'amr': did you mean 'arm'\?"):
        robot.links["amr"]
    with pytest.raises(
        KeyError, match="robot 'tester' has no moving joint 'mount'; it has 'turn', "
    ):
        robot.joints["mount"]
    with pytest.raises(KeyError, match="robot 'tester' has no ball joint 'a'; it has none"):
        robot.ball_joints["a"]


def test_present_positions_hold_the_robot_where_it_is(world, robot):
    robot.set_positions({"turn": 0.4, "lift": 0.2})
    held = dict(robot.positions)
    robot.set_targets(robot.positions)
    world.step(200)
    assert robot.positions == pytest.approx(held, abs=1e-6)
    assert held == pytest.approx({"turn": 0.4, "lift": 0.2, "grip": 0.05, "pinch": -0.05})


def test_present_positions_are_valid_while_joints_move_and_when_they_press_on_limits(world, robot):
    weight = robot.links["slide"].body
    for push in (0.0, -500.0):
        robot.set_targets({"turn": 3.0, "lift": 0.3})
        for _ in range(40):
            world.step(5, before=lambda _, push=push: weight.apply_force((0, 0, push)))
            robot.set_targets(robot.positions)
            robot.set_targets({"turn": 3.0, "lift": 0.3 if push == 0.0 else 0.0})
    assert -1e-3 < robot.positions["lift"] < 1e-3


@pytest.mark.parametrize(("target", "held"), [(-1e-17, 0.0), (0.3 + 1e-9, 0.3), (0.3009, 0.3)])
def test_a_target_beyond_a_limit_by_what_a_simulation_errs_is_the_limit(world, robot, target, held):
    robot.set_targets({"lift": target})
    world.step(400)
    assert robot.positions["lift"] == pytest.approx(held, abs=1e-6)


def test_targets_beyond_limits_are_refused_with_the_digits_that_tell(robot):
    with pytest.raises(
        vx.SettingsError, match=r"^positions\['lift'\] must be within .* 0 to 0\.3 m, not 0\.302 m$"
    ):
        robot.set_targets({"lift": 0.302})
    with pytest.raises(vx.SettingsError, match=r" 0 to 0\.3, not 0\.30000002$"):
        robot.joints["lift"].set_target_position(0.30000002, max_force=1.0)
    robot.joints["lift"].set_target_position(math.nextafter(0.3, 1.0), max_force=1.0)


def test_joints_that_mimic_others_may_be_named_where_these_put_them(world, robot):
    robot.set_targets({"pinch": -0.07, "grip": 0.07, "lift": 0.24})
    world.step(400)
    reached = {name: robot.positions[name] for name in ("lift", "grip", "pinch")}
    assert reached == pytest.approx({"lift": 0.24, "grip": 0.07, "pinch": -0.07}, abs=1e-6)


@pytest.mark.parametrize(
    ("targets", "message"),
    [
        ({"lift": 0.24, "grip": 0.1}, "'grip' mimics another joint, 'lift', whose target puts it at 0.07, not at 0.1: leave it out"),
        ({"lift": 0.24, "pinch": 0.05}, "'pinch' mimics another joint, 'grip': drive that one"),
        ({"grip": 0.05}, "'grip' mimics another joint, 'lift': drive that one"),
    ],
)  # fmt: skip
def test_other_positions_of_joints_that_mimic_are_refused(robot, targets, message):
    with pytest.raises(vx.SettingsError, match=re.escape(message)):
        robot.set_targets(targets)


@pytest.mark.parametrize(
    "wrong",
    [{"lift": 9.0}, {"lift": math.nan}, {"lift": "up"}, {"grip": 0.09}, {"elbow": 0.0}, {7: 0.0}],
)
def test_of_refused_targets_none_is_set(world, robot, wrong):
    with pytest.raises(vx.SettingsError):
        robot.set_targets({"turn": 1.0, **wrong})
    with pytest.raises(vx.SettingsError):
        robot.set_targets({"turn": 1.0}, max_force=-1.0)
    with pytest.raises(vx.SettingsError):
        robot.set_target_velocities({"turn": 1.0, "grip": 1.0})
    with pytest.raises(vx.SettingsError):
        robot.set_target_velocities({"turn": 1.0, "lift": math.inf})
    world.step(20)
    assert abs(robot.positions["turn"]) < 0.05  # 0.2 with that target


def test_targets_are_refused_without_an_effort_before_any_is_set(world, path):
    path.write_text(path.read_text().replace('effort="80"', ""))
    robot = vx.load_urdf(world, path)
    with pytest.raises(vx.SettingsError, match="no effort for joint 'lift'; pass max_force"):
        robot.set_targets({"turn": 1.0, "lift": 0.1})
    world.step(20)
    assert abs(robot.positions["turn"]) < 0.05  # 0.2 with that target


def test_positions_and_velocities_are_read_only(robot):
    for numbers in (robot.positions, robot.velocities):
        with pytest.raises(TypeError, match="does not support item assignment"):
            numbers["lift"] = 0.1


def test_joints_are_put_at_positions_at_rest(world, robot):
    robot.set_target_velocities({"turn": 2.0, "lift": 0.5})
    cargo = robot.links["cargo"].body
    cargo.linear_velocity = (0, 0, 1)
    world.step(50)
    assert robot.velocities["turn"] > 1.0
    robot.set_positions({"turn": 9.0, "lift": 0.25})
    assert robot.positions == pytest.approx(
        {"turn": 9.0, "lift": 0.25, "grip": 0.075, "pinch": -0.075}, abs=1e-9
    )
    assert robot.velocities == pytest.approx(dict.fromkeys(robot.joints, 0.0), abs=1e-12)
    turned = vx.pose(axis_angle=((0, 0, 1), 9.0))
    np.testing.assert_allclose(
        robot.links["tool"].pose, turned @ vx.pose((1.075, -0.075, 0.35)), atol=1e-9
    )
    assert cargo.linear_velocity[2] == pytest.approx(1.0)  # no joint holds it
    world.step(20)
    assert 9.0 < robot.positions["turn"] < 9.2  # the motor goes on from there


def test_joints_that_are_not_named_keep_their_positions_and_the_base_its_pose(world, path):
    place = vx.pose((1, 2, 3), axis_angle=((1, 0, 0), 0.5))
    robot = vx.load_urdf(world, path, pose=place, positions={"turn": 0.3})
    robot.set_positions({"lift": 0.1})
    assert robot.positions["turn"] == pytest.approx(0.3)
    assert robot.positions["lift"] == pytest.approx(0.1)
    arm = vx.pose(axis_angle=((0, 0, 1), 0.3)) @ vx.pose((1, 0, 0.1))
    np.testing.assert_allclose(robot.links["slide"].pose, place @ arm, atol=1e-9)
    robot.set_positions({"grip": 0.0})  # one that mimics, until its motor moves it
    assert robot.positions["grip"] == pytest.approx(0.0, abs=1e-9)


def test_a_free_robot_is_put_at_positions_where_it_is(world, path):
    path.write_text(path.read_text().replace('<link name="base"/>', f'<link name="base">{INERTIAL}</link>'))  # fmt: skip
    robot = vx.load_urdf(world, path, fixed_base=False)
    base = robot.links["base"].body
    base.linear_velocity, base.angular_velocity = (1, 0, 0), (0, 0, 1)
    world.step(100)
    before = base.pose
    robot.set_positions({"turn": -1.0})
    np.testing.assert_allclose(base.pose, before, atol=1e-12)
    assert not base.linear_velocity.any()
    np.testing.assert_allclose(
        robot.links["arm"].pose, before @ vx.pose(axis_angle=((0, 0, 1), -1.0)), atol=1e-9
    )


def test_a_model_of_mujoco_is_put_at_positions(world, tmp_path):
    """With a joint whose zero is not where the file has it, and a body with two joints."""
    model = tmp_path / "model.xml"
    geom = '<geom type="capsule" fromto="0 0 0 1 0 0" size="0.02"/>'
    model.write_text(
        '<mujoco><compiler angle="radian"/><worldbody><body name="arm" pos="0 0 1">'
        f'<joint name="yaw" axis="0 0 1" ref="0.2"/><joint name="pitch" axis="0 1 0"/>{geom}'
        f'<body name="hand" pos="1 0 0"><joint name="ball" type="ball"/>{geom}</body></body>'
        "</worldbody></mujoco>"
    )
    robot = vx.load_mjcf(world, model, self_collision=False)
    there = {"yaw": 1.2, "pitch": -0.3}
    robot.set_positions(there)
    assert robot.positions == pytest.approx(there)
    expected = vx.load_mjcf(world, model, positions=there, self_collision=False)
    for name, link in robot.links.items():
        np.testing.assert_allclose(link.pose, expected.links[name].pose, atol=1e-9)


@pytest.mark.parametrize(
    ("positions", "message"),
    [
        ({"elbow": 0.1}, "positions names 'elbow', but the joints of robot 'tester' that turn or slide are"),
        ({"turn": 1.0, "lift": 0.4}, "limits, 0 to 0.3 m"),
        ({"turn": math.inf}, "must be finite"),
    ],
)  # fmt: skip
def test_wrong_positions_are_refused_before_any_is_set(robot, positions, message):
    before = {name: link.pose.tolist() for name, link in robot.links.items()}
    with pytest.raises(vx.SettingsError, match=re.escape(message)):
        robot.set_positions(positions)
    assert {name: link.pose.tolist() for name, link in robot.links.items()} == before
    with pytest.raises(vx.InputTypeError, match="positions must map the names of joints"):
        robot.set_positions([0.1])


def test_targets_that_move_are_followed_without_lag(world, robot):
    speeds = {"turn": 1.0, "lift": 0.1}
    errors = []

    def before(world):
        now = {name: speed * world.time for name, speed in speeds.items()}
        robot.set_targets(now, velocities=speeds)

    def after(world):
        errors.extend(speeds[name] * world.time - robot.positions[name] for name in speeds)

    world.step(200, before=before)
    world.step(200, after, before=before)
    assert np.abs(errors).max() < 1e-6


def test_velocities_of_targets_need_positions(robot):
    with pytest.raises(vx.SettingsError, match="velocities names 'lift', but positions does not"):
        robot.set_targets({"turn": 0.1}, velocities={"lift": 0.1})
    with pytest.raises(vx.InputTypeError, match="velocities must map the names of joints"):
        robot.set_targets({"turn": 0.1}, velocities=[0.1])


CHAIN = f"""<robot name="chain"><link name="base">{INERTIAL}</link>
<link name="one">{INERTIAL.replace("<mass", '<origin xyz="0.2 0.1 0"/><mass')}</link>
<link name="two">{INERTIAL}</link><link name="plate"/>
<link name="three">{INERTIAL.replace("<mass", '<origin xyz="0 0.3 0.1"/><mass')}</link>
<link name="four">{INERTIAL}</link><link name="five">{INERTIAL}</link>
<joint name="a" type="revolute"><parent link="base"/><child link="one"/>
  <origin xyz="0.1 0.2 0.3" rpy="0.3 0.2 0.1"/><axis xyz="1 2 3"/>
  <limit lower="-3" upper="3" effort="50" velocity="9"/></joint>
<joint name="b" type="prismatic"><parent link="one"/><child link="two"/>
  <origin xyz="0.5 0 0.1" rpy="0 1 0"/><axis xyz="0 1 1"/>
  <limit lower="-1" upper="1" effort="50" velocity="9"/></joint>
<joint name="rigid" type="fixed"><parent link="two"/><child link="plate"/>
  <origin xyz="0 0 0.4" rpy="1 0 0"/></joint>
<joint name="c" type="continuous"><parent link="plate"/><child link="three"/>
  <origin xyz="0.1 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="d" type="prismatic"><parent link="three"/><child link="four"/>
  <origin xyz="0 0.2 0"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="50" velocity="9"/>
  <mimic joint="b" multiplier="-2" offset="0.1"/></joint>
<joint name="e" type="revolute"><parent link="four"/><child link="five"/>
  <origin xyz="0.3 0 0"/><axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="50" velocity="9"/></joint>
</robot>"""
POSITIONS = {"a": 0.7, "b": 0.2, "c": -1.3, "e": 0.4}
VELOCITIES = {"a": 1.5, "b": -0.3, "c": 2.0, "e": -0.7}


@pytest.fixture
def chain(world: vx.World, tmp_path: Path) -> vx.Robot:
    path = tmp_path / "chain.urdf"
    path.write_text(CHAIN)
    return vx.load_urdf(world, path, fixed_base=False)


def test_velocities_that_joints_are_given_move_links_as_positions_do(world, chain):
    chain.set_positions(POSITIONS)
    chain.set_velocities(VELOCITIES)
    given = VELOCITIES | {"d": 0.6}
    assert dict(chain.velocities) == pytest.approx(given, abs=1e-12)
    found = {
        body: (body.velocity_at(body.position), body.angular_velocity) for body in chain.bodies
    }
    h = 1e-6
    poses = []
    for sign in (-1, 1):
        chain.set_positions(
            {name: POSITIONS[name] + sign * h * VELOCITIES[name] for name in POSITIONS}
        )
        poses.append({body: body.pose for body in chain.bodies})
    for body, (linear, angular) in found.items():
        before, after = poses[0][body], poses[1][body]
        np.testing.assert_allclose((after - before)[:3, 3] / (2 * h), linear, atol=1e-8)
        turn = after[:3, :3] @ before[:3, :3].T
        spin = np.array((turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]))
        np.testing.assert_allclose(spin / (4 * h), angular, atol=1e-8)
    assert np.abs(found[chain.links["five"].body][0]).max() > 1.0


def test_a_root_in_motion_takes_its_links_along(world, chain):
    chain.set_positions(POSITIONS)
    base = chain.links["base"].body
    base.linear_velocity, base.angular_velocity = (1.0, 2.0, 3.0), (0.1, 0.2, 0.3)
    chain.set_velocities(dict.fromkeys(POSITIONS, 0.0))
    for body in chain.bodies:
        np.testing.assert_allclose(
            body.linear_velocity, base.velocity_at(body.center_of_mass), atol=1e-12
        )
        np.testing.assert_allclose(body.angular_velocity, base.angular_velocity, atol=1e-12)


def test_joints_that_are_not_named_keep_their_velocities(world, chain):
    chain.set_positions(POSITIONS)
    chain.set_velocities(VELOCITIES)
    upper = [chain.links[name].body.linear_velocity for name in ("base", "one", "two")]
    chain.set_velocities({"c": -4.0})
    assert dict(chain.velocities) == pytest.approx(VELOCITIES | {"c": -4.0, "d": 0.6}, abs=1e-12)
    for name, before in zip(("base", "one", "two"), upper, strict=True):
        np.testing.assert_array_equal(chain.links[name].body.linear_velocity, before)


def test_joints_move_on_with_the_velocities_that_they_are_given(world, chain):
    chain.set_positions(POSITIONS)
    chain.set_velocities(VELOCITIES)
    momentum = sum(body.mass * body.linear_velocity for body in chain.bodies)
    world.step()
    assert dict(chain.velocities) == pytest.approx(VELOCITIES | {"d": 0.6}, abs=0.02)
    after = sum(body.mass * body.linear_velocity for body in chain.bodies)
    np.testing.assert_allclose(after, momentum, atol=1e-6)


def test_a_joint_held_at_its_limit_by_the_one_that_it_mimics_gets_no_velocity(world, robot):
    robot.set_positions({"lift": 0.3})
    assert robot.positions["grip"] == pytest.approx(0.1)
    robot.set_velocities({"lift": 0.2})
    assert robot.velocities["grip"] == pytest.approx(0.1)  # 0.1 m is where the leader puts it
    robot.set_positions({"lift": 0.0})
    robot.set_velocities({"turn": 1.0})
    assert robot.velocities["turn"] == pytest.approx(1.0)
    assert robot.velocities["lift"] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("velocities", "message"),
    [
        ({"trun": 1.0}, r"velocities names 'trun', but the joints of robot 'tester' that turn or"),
        ({"mount": 1.0}, "velocities names 'mount'"),
        ({"turn": math.inf}, r"velocities\['turn'\] must be finite"),
        ([1.0], "velocities must map the names of joints to numbers"),
    ],
)
def test_wrong_velocities_are_refused_before_any_is_set(robot, velocities, message):
    with pytest.raises((vx.SettingsError, vx.InputTypeError), match=message):
        robot.set_velocities(velocities)
    assert set(robot.velocities.values()) == {0.0}
