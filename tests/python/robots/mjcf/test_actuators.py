"""The efforts of joints, from the limits of their actuators."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import pytest
import voxshell as vx

BALL = "<geom size='0.1' pos='0 0 -1'/>"


@pytest.fixture
def load(write) -> Callable[..., vx.Robot]:
    def load(actuators: str, joint: str = "", compiler: str = "", defaults: str = "") -> vx.Robot:
        body = f"<body><joint name='a' {joint}/>{BALL}</body><body pos='5 0 0'><joint name='b'/>{BALL}</body>"
        path = write(
            f"<compiler {compiler}/><default>{defaults}</default><worldbody>{body}</worldbody>"
            f"<actuator>{actuators}</actuator>"
        )
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", vx.RobotWarning)
            return vx.load_mjcf(vx.World(), path)

    return load


def effort_of(robot: vx.Robot) -> float | None:
    return robot._described["a"].effort


@pytest.mark.parametrize(
    ("actuator", "effort"),
    [
        ("<position joint='a' kp='9' forcerange='-87 87'/>", 87.0),
        ("<position joint='a' forcerange='-3 5' gear='-2'/>", 10.0),
        ("<position joint='a' ctrlrange='-1 1'/>", None),
        ("<velocity jointinparent='a' forcerange='-3 3'/>", 3.0),
        ("<motor joint='a' ctrlrange='-0.4 0.4' gear='150'/>", 60.0),
        ("<motor joint='a' ctrlrange='-9 9' forcerange='-3 3'/>", 3.0),
        ("<motor joint='a' ctrlrange='-9 9' ctrllimited='false'/>", None),
        ("<motor joint='a' gear='150'/>", None),
        ("<general joint='a' ctrlrange='-1 1' gainprm='40 0 0'/>", 40.0),
        ("<motor joint='a' class='servo' ctrlrange='-1 1'/>", 1.0),
        ("<general joint='a' class='servo' ctrlrange='-1 1'/>", None),
        ("<general joint='a' ctrlrange='-1 1' biastype='affine' biasprm='0 -1'/>", None),
        ("<muscle joint='a' forcerange='-3 3'/>", 3.0),
        ("<motor site='a' forcerange='-3 3'/>", None),
        ("<motor joint='b' forcerange='-3 3'/>", None),
        ("<motor joint='a' forcerange='-3 3'/><motor joint='b'/>", 3.0),
        ("<motor joint='a' forcerange='-3 3'/><motor joint='a' forcerange='-1 1'/>", None),
    ],
)  # fmt: skip
def test_the_strength_of_a_joint_is_that_of_its_only_actuator(load, actuator, effort):
    servo = "<default class='servo'><position kp='30'/></default>"
    assert effort_of(load(actuator, defaults=servo)) == pytest.approx(effort)


def test_actuators_have_the_limits_of_their_class(load):
    actuator = "<position joint='a' class='small'/>"
    small = "<default class='small'><general forcerange='-12 12'/></default>"
    assert effort_of(load(actuator, defaults=small)) == 12.0
    # A class has for all kinds of actuators what it has for one.
    gear = "<motor gear='3'/>"
    assert effort_of(load(actuator, defaults=gear + small)) == 36.0


def test_ranges_limit_if_the_file_says_so(load):
    actuator = "<position joint='a' forcerange='-3 3' {}/>"
    assert effort_of(load(actuator.format(""), compiler="autolimits='false'")) is None
    limited = actuator.format("forcelimited='true'")
    assert effort_of(load(limited, compiler="autolimits='false'")) == 3.0
    assert effort_of(load(actuator.format("forcelimited='false'"))) is None


def test_the_smaller_of_the_limits_of_joint_and_actuator_holds(load):
    actuator = "<position joint='a' forcerange='-3 3'/>"
    assert effort_of(load(actuator, joint="actuatorfrcrange='-9 9'")) == 3.0
    assert effort_of(load(actuator, joint="actuatorfrcrange='-1 1'")) == 1.0
    free = "actuatorfrcrange='-1 1' actuatorfrclimited='false'"
    assert effort_of(load(actuator, joint=free)) == 3.0
    assert effort_of(load(actuator + actuator, joint="actuatorfrcrange='-9 9'")) == 9.0


def test_a_joint_is_driven_with_the_strength_of_its_actuator(load):
    weak, strong = (
        load(f"<position joint='a' forcerange='-{force} {force}'/>", joint="axis='1 0 0'")
        for force in (1, 100)
    )  # it takes 41 N m to hold the ball level
    for robot in (weak, strong):
        robot.set_targets({"a": 1.5})
        robot._world.step(1200)
    assert weak.positions["a"] < 0.5
    assert strong.positions["a"] == pytest.approx(1.5, abs=1e-3)


@pytest.mark.parametrize(
    ("actuators", "message"),
    [
        ("", "the file states no effort for joint 'a'; pass max_force"),
        (
            "<position joint='a' ctrlrange='-1 1'/>",
            "the file has an actuator whose largest force it does not state for joint 'a'; pass max_force",
        ),
        (
            "<motor joint='a' forcerange='-1 1'/>" * 2,
            "the file has 2 actuators, whose forces are not added up, for joint 'a'; pass max_force",
        ),
    ],
)
def test_a_joint_without_a_strength_says_what_the_file_states(load, actuators, message):
    with pytest.raises(vx.SettingsError, match=message):
        load(actuators).set_targets({"a": 0.1})


def test_wrong_actuators_are_refused(load):
    with pytest.raises(vx.RobotError, match="forcerange="):
        load("<motor joint='a' forcerange='x'/>")
    with pytest.raises(vx.RobotError, match="no such class"):
        load("<motor joint='a' class='x'/>")
