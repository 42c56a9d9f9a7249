from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import voxshell as vx
from voxshell.robots.starts import as_starts

LINK = (
    '<link name="{}"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" '
    'iyz="0"/></inertial></link>'
)
JOINT = (
    '<joint name="{0}" type="{1}"><parent link="{2}"/><child link="{3}"/><origin xyz="{4}"/>'
    '<axis xyz="0 0 1"/>{5}</joint>'
)
LIMIT = '<limit lower="{}" upper="{}" effort="50" velocity="1"/>'


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    """Turns at the origin and 1 m along x, and slides up at 2 m; a finger mimics the slide."""
    path = tmp_path / "arm.urdf"
    path.write_text(
        '<robot name="arm"><link name="base"/>'
        + "".join(map(LINK.format, ("upper", "lower", "lift", "finger", "thumb", "tool")))
        + JOINT.format("shoulder", "continuous", "base", "upper", "0 0 0", "")
        + JOINT.format("elbow", "revolute", "upper", "lower", "1 0 0", LIMIT.format(-6.2, 6.2))
        + JOINT.format("slide", "prismatic", "lower", "lift", "1 0 0", LIMIT.format(0, 0.5))
        + JOINT.format(
            "finger", "prismatic", "lift", "finger", "0 0 0",
            LIMIT.format(-0.3, 0.3) + '<mimic joint="thumb" multiplier="-2" offset="0.1"/>',
        )
        + JOINT.format(
            "thumb", "prismatic", "lift", "thumb", "0 0 0",
            LIMIT.format(-1, 1) + '<mimic joint="slide" multiplier="0.5"/>',
        )
        + JOINT.format("flange", "fixed", "lift", "tool", "0 0 0.1", "")
        + "</robot>"
    )  # fmt: skip
    return path


MODEL = """<mujoco><worldbody><body name="arm" pos="0 0 1">
<joint name="hinge" axis="0 0 1" range="-90 200" ref="10"/>
<geom type="capsule" fromto="0 0 0 1 0 0" size="0.02"/>
<body name="hand" pos="1 0 0"><joint name="ball" type="ball"/><geom size="0.05" pos="0.1 0 0"/></body>
</body></worldbody></mujoco>"""


@pytest.fixture
def model(tmp_path: Path) -> Path:
    path = tmp_path / "model.xml"
    path.write_text(MODEL)
    return path


def test_joints_begin_where_they_are_told(arm):
    world = vx.World(gravity=(0, 0, 0))
    starts = {"shoulder": 0.5, "elbow": -0.7, "slide": 0.3}
    robot = vx.load_urdf(world, arm, pose=(0, 0, 5), positions=starts)
    assert robot.positions == pytest.approx(starts | {"thumb": 0.15, "finger": -0.2})
    elbow = np.array((math.cos(0.5), math.sin(0.5), 5))
    np.testing.assert_allclose(robot.links["lower"].pose[:3, 3], elbow, atol=1e-12)
    tool = elbow + np.array((math.cos(-0.2), math.sin(-0.2), 0.4))
    np.testing.assert_allclose(robot.links["tool"].pose[:3, 3], tool, atol=1e-12)
    world.step(100)  # those that mimic others have nothing to catch up on
    assert robot.positions == pytest.approx(starts | {"thumb": 0.15, "finger": -0.2}, abs=1e-6)


def test_joints_that_are_not_named_begin_as_without_positions(arm):
    world = vx.World()
    assert vx.load_urdf(world, arm, positions={}).positions == pytest.approx(
        dict.fromkeys(("shoulder", "elbow", "slide", "thumb", "finger"), 0.0)
    )
    robot = vx.load_urdf(world, arm, pose=(9, 0, 0), positions={"elbow": 1.0})
    assert robot.positions["elbow"] == pytest.approx(1.0)
    assert robot.positions["shoulder"] == robot.positions["finger"] == 0.0


def test_joints_that_mimic_others_begin_within_their_limits_or_where_they_are_told(arm):
    robot = vx.load_urdf(vx.World(), arm, positions={"slide": 0.5})
    assert robot.positions["thumb"] == pytest.approx(0.25)
    assert robot.positions["finger"] == pytest.approx(-0.3)
    robot = vx.load_urdf(vx.World(), arm, positions={"slide": 0.5, "thumb": 0.0})
    assert robot.positions["finger"] == pytest.approx(0.1)


@pytest.mark.parametrize("angle", [4.0, -5.5, 6.2])
def test_angles_beyond_half_a_turn_count(arm, angle):
    """They would read as the same angle less a turn, and limits would be elsewhere."""
    world = vx.World(gravity=(0, 0, 0))
    starts = {"shoulder": 3 * angle, "elbow": angle}
    robot = vx.load_urdf(world, arm, positions=starts)
    for _ in range(2):
        for name, start in starts.items():
            assert robot.positions[name] == pytest.approx(start, abs=1e-6)
        world.step(20)
    robot.set_targets({"elbow": 0.5 * angle})
    world.step(2000)
    assert robot.positions["elbow"] == pytest.approx(0.5 * angle, abs=1e-2)


def test_a_robot_begins_where_another_ended(arm):
    world = vx.World()
    robot = vx.load_urdf(world, arm, positions={"shoulder": 9.0, "slide": 0.2})
    world.step(200)  # the slide falls on its limit
    ended = robot.positions
    assert vx.load_urdf(vx.World(), arm, positions=ended).positions == pytest.approx(ended)


def test_joints_of_mujoco_begin_in_radians_at_their_own_zero(model):
    robot = vx.load_mjcf(vx.World(), model)
    assert robot.positions["hinge"] == pytest.approx(math.radians(10))
    robot = vx.load_mjcf(vx.World(), model, positions={"hinge": math.radians(190)})
    assert robot.positions["hinge"] == pytest.approx(math.radians(190))
    # The file has the arm along x at ref, 10 degrees: half a turn before.
    np.testing.assert_allclose(robot.links["hand"].pose[:3, 3], (-1, 0, 1), atol=1e-9)


@pytest.mark.parametrize(
    ("positions", "message"),
    [
        (
            {"elbo": 1.0, "flange": 2.0, "elbow": 0.0},
            r"^positions names 'elbo', 'flange', but the joints of .*arm\.urdf that turn or slide are "
            "'shoulder', 'elbow', 'slide', 'finger', 'thumb'$",
        ),
        (
            {"elbow": -6.3},
            r"^positions\['elbow'\] must be within the joint's limits, -6.2 to 6.2 rad "
            r"\(.*arm\.urdf:1\), not -6.3 rad$",
        ),
        ({"slide": 0.51}, r"limits, 0 to 0\.5 m .*, not 0\.51 m$"),
        ({"slide": math.nan}, r"^positions\['slide'\] must be finite, not nan$"),
        ({"slide": "up"}, r"^positions\['slide'\] must be a number, not 'up'$"),
    ],
)
def test_wrong_positions_are_refused(arm, positions, message):
    world = vx.World()
    with pytest.raises(vx.SettingsError, match=message):
        vx.load_urdf(world, arm, positions=positions)
    assert world.bodies == ()


def test_positions_are_by_name():
    assert as_starts(None) == {}
    assert as_starts({"a": 1}) == {"a": 1.0}
    with pytest.raises(vx.InputTypeError, match="positions must map the names of joints to num"):
        as_starts([1.0, 2.0])  # pyright: ignore[reportArgumentType]


def test_wrong_positions_of_a_model_are_refused(model):
    with pytest.raises(vx.SettingsError, match=r"names 'ball', but .*model\.xml .* are 'hinge'$"):
        vx.load_mjcf(vx.World(), model, positions={"ball": 1.0})
    with pytest.raises(vx.SettingsError, match=r"limits, -1.5708 to 3.49066 rad .* not 190 rad"):
        vx.load_mjcf(vx.World(), model, positions={"hinge": 190})
