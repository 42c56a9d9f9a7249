"""Keyframes, in which all joints begin."""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np
import pytest
import voxshell as vx

BALL = "<geom size='0.02' pos='0 0 -0.3'/>"
QPOS = "1 2 3 0 2 0 0  0.4  -0.1  1 1 0 0  0.7"
MODEL = (
    "<worldbody>",
    f"<body name='free' pos='0 0 9'><freejoint/>{BALL}",
    f"<body name='arm' pos='0 1 0'><joint name='turn' axis='0 1 0' pos='0 0 0.2'/>{BALL}</body></body>",
    f"<frame pos='0 3 0'><body name='cart' euler='0 0 90'><joint name='slide' type='slide'/>{BALL}",
    f"<body name='welded' pos='1 0 0'>{BALL}",
    f"<body name='swing'><joint name='ball' type='ball' pos='0 0 0.5'/>{BALL}</body></body></body></frame>",
    f"<body name='door' pos='4 0 0'><joint name='hinge' range='-10 30' ref='5'/>{BALL}</body></worldbody>",
    f"<keyframe><key qpos='{QPOS}'/><key name='home' qpos='{QPOS}' qvel='{'0 ' * 12}'/><key name='rest'/>",
)
END = "</keyframe>"


def load(path, **options: Any) -> vx.Robot:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", vx.RobotWarning)
        return vx.load_mjcf(vx.World(), path, **options)


def test_all_joints_begin_at_the_keyframe(write):
    robot = load(write(*MODEL, END), keyframe="home")
    limit = math.radians(30)
    expected = {"turn": 0.4, "slide": -0.1, "hinge": limit}
    assert robot.positions == pytest.approx(expected, abs=1e-9)
    free = vx.pose((1, 2, 3), wxyz=(0, 1, 0, 0))
    np.testing.assert_allclose(robot.links["free"].pose, free, atol=1e-9)
    anchor = vx.pose((0, 1, 0.2)) @ vx.pose(axis_angle=((0, 1, 0), 0.4))
    np.testing.assert_allclose(
        robot.links["arm"].pose, free @ anchor @ vx.pose((0, 0, -0.2)), atol=1e-9
    )
    swing = vx.pose((1, 0, 0.5)) @ vx.pose(axis_angle=((1, 0, 0), math.pi / 2))
    np.testing.assert_allclose(
        robot.links["swing"].pose,
        robot.links["cart"].pose @ swing @ vx.pose((0, 0, -0.5)),
        atol=1e-9,
    )


def test_links_are_where_mujoco_has_them(write):
    mujoco: Any = pytest.importorskip("mujoco", reason="compares with the package mujoco")
    path = write(*MODEL, END)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 1)
    data.qpos[-1] = math.radians(30)  # we begin at the limit
    mujoco.mj_kinematics(model, data)
    robot = load(path, keyframe="home")
    for name in ("free", "arm", "cart", "welded", "swing", "door"):
        body = data.body(name)
        np.testing.assert_allclose(robot.links[name].pose[:3, 3], body.xpos, atol=1e-9)
        np.testing.assert_allclose(robot.links[name].pose[:3, :3].ravel(), body.xmat, atol=1e-9)


def test_given_positions_win_and_a_limit_is_warned_of(write):
    path = write(*MODEL, END)
    robot = load(path, keyframe="home", positions={"turn": -0.2, "hinge": 0.1})
    assert robot.positions == pytest.approx({"turn": -0.2, "slide": -0.1, "hinge": 0.1})
    with pytest.warns(vx.RobotWarning, match=r"begin at the nearest limit \('hinge'\)"):
        vx.load_mjcf(vx.World(), path, keyframe="home")


def test_a_keyframe_without_qpos_is_that_of_the_model(write):
    path = write(*MODEL, END)
    assert load(path, keyframe="rest").positions == load(path).positions


def test_wrong_keyframes_are_refused(write):
    path = write(*MODEL, "<key name='short' qpos='1 2'/>", END)
    with pytest.raises(vx.RobotError, match=r'has <key qpos="1 2">; give 14 finite numbers'):
        load(path, keyframe="short")
    with pytest.raises(vx.SettingsError, match="with a name are 'home', 'rest', 'short'"):
        load(path, keyframe="work")
    with pytest.raises(vx.InputTypeError, match="keyframe must be a string"):
        load(path, keyframe=1)
    nothing = QPOS.replace("0 2 0 0", "0 0 0 0")
    path = write(*MODEL, f"<key name='nothing' qpos='{nothing}'/>", END)
    with pytest.raises(vx.RobotError, match="which has no direction"):
        load(path, keyframe="nothing")
