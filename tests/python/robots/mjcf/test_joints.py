from __future__ import annotations

import math
import warnings

import numpy as np
import pytest
import voxshell as vx

BALL = "<geom size='0.1' pos='0 0 -1'/>"


@pytest.fixture
def load(write):
    def load(joint: str, compiler: str = "", inside: str = BALL, gravity=(0, 0, 0)):
        body = f"<body name='arm' pos='0 0 3'>{joint}{inside}</body>"
        path = write(f"<compiler {compiler}/><worldbody>{body}</worldbody>")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", vx.RobotWarning)
            return vx.load_mjcf(vx.World(gravity=gravity), path)

    return load


def test_hinges_and_slides_have_axis_limits_and_losses(load):
    robot = load("<joint name='a' axis='0 2 0' range='-90 45' damping='3 1' frictionloss='2'/>")
    kind = robot.joints["a"].kind
    assert isinstance(kind, vx.HingeJoint)
    assert kind.limits == pytest.approx((-math.pi / 2, math.pi / 4))
    assert (kind.damping, kind.friction) == (3.0, 2.0)
    robot = load("<joint name='a' type='slide' range='-90 45'/>")
    assert robot.joints["a"].kind.limits == (-90.0, 45.0)


def test_hinges_and_slides_have_springs(load):
    kind = load("<joint name='a' stiffness='4' springref='90'/>").joints["a"].kind
    assert (kind.stiffness, kind.spring_position) == (4.0, pytest.approx(math.pi / 2))
    kind = load("<joint name='a' type='slide' stiffness='4' springref='0.2'/>").joints["a"].kind
    assert (kind.stiffness, kind.spring_position) == (4.0, 0.2)
    assert load("<joint name='a' stiffness='-4'/>").joints["a"].kind.stiffness == 0.0
    assert load("<joint name='a' armature='0.3'/>").joints["a"].kind.armature == 0.3


def test_limits_need_a_range_and_consent(load):
    for text, compiler, limited in (
        ("range='0 1'", "", True),
        ("range='0 1'", "autolimits='false'", False),
        ("range='0 1' limited='true'", "autolimits='false'", True),
        ("range='0 1' limited='false'", "", False),
        ("range='0 0'", "", False),
    ):
        kind = load(f"<joint name='a' {text}/>", compiler).joints["a"].kind
        assert (kind.limits is not None) == limited, text
    with pytest.raises(vx.RobotError, match=r"joint 'a' has <joint range=\"1 0\">"):
        load("<joint name='a' range='1 0' limited='true'/>")


@pytest.mark.parametrize("kind", ["hinge", "slide"])
def test_positions_are_those_of_mujoco(load, kind):
    joint = f"<joint name='a' type='{kind}' axis='0 1 0' pos='0 0 0.5' ref='0.3'/>"
    robot = load(joint, "angle='radian'")
    assert robot.positions["a"] == pytest.approx(0.3)
    np.testing.assert_allclose(robot.links["arm"].pose, vx.pose((0, 0, 3)), atol=1e-9)
    robot.set_targets({"a": 0.5}, max_force=1000.0)
    robot._world.step(400)
    moved = 0.5 - 0.3
    expected = vx.pose((0, moved, 3))
    if kind == "hinge":
        anchor = vx.pose((0, 0, 3.5))
        expected = anchor @ vx.pose(axis_angle=((0, 1, 0), moved)) @ vx.pose((0, 0, -0.5))
    np.testing.assert_allclose(robot.links["arm"].pose, expected, atol=2e-3)


def test_a_position_beyond_the_limits_begins_at_the_nearest(load, write):
    robot = load("<joint name='a' range='0.5 1' axis='0 1 0'/>", "angle='radian'")
    assert robot.positions["a"] == pytest.approx(0.5)
    robot._world.step(20)
    assert robot.positions["a"] == pytest.approx(0.5, abs=1e-3)
    path = write(f"<worldbody><body><joint name='a' range='5 9'/>{BALL}</body></worldbody>")
    with pytest.warns(vx.RobotWarning, match=r"begin at the nearest limit \('a'\)"):
        vx.load_mjcf(vx.World(), path)


def test_ball_joints_turn_about_a_point(load):
    robot = load("<joint name='a' type='ball' pos='0 0 1'/>", gravity=(0, 1, -9.81))
    assert list(robot.ball_joints) == ["a"]
    robot._world.step(20)
    pose = robot.links["arm"].pose
    np.testing.assert_allclose(pose @ [0, 0, 1, 1], [0, 0, 4, 1], atol=1e-3)
    assert pose[1, 3] > 1e-3


def test_the_strength_of_a_joint_is_its_actuator_force(load):
    robot = load("<joint name='a' actuatorfrcrange='-3 5'/>")
    robot.set_targets({"a": 0.1})
    with pytest.raises(vx.SettingsError, match="no effort for joint 'a'"):
        load("<joint name='a'/>").set_targets({"a": 0.1})


@pytest.mark.parametrize(
    "text",
    [
        "type='screw'",
        "axis='0 0 0'",
        "damping='-1'",
        "armature='-1'",
        "limited='maybe'",
        "range='0'",
        "ref='x'",
    ],
)
def test_wrong_joints_are_refused(load, text):
    with pytest.raises(vx.RobotError, match=r"model\.xml:1: joint 'a' has "):
        load(f"<joint name='a' {text}/>")


@pytest.mark.parametrize("loss", ["damping", "frictionloss", "armature"])
def test_a_loss_below_0_is_refused_with_its_name_and_value(load, loss):
    text = f"joint 'a' has a {loss} of -0.25, below 0, .* correct its sign, or set it to 0"
    with pytest.raises(vx.RobotError, match=text):
        load(f"<joint name='a' {loss}='-0.25'/>")
