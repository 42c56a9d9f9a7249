"""Elements that URDF does not have: unexpanded macros are refused, and others doubted."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path

import pytest
import voxshell as vx

INERTIAL = (
    '<inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/>'
    "</inertial>"
)
BALL = '<collision><geometry><sphere radius="0.1"/></geometry></collision>'
JOINT = '<joint name="j" type="continuous"><parent link="a"/><child link="b"/>{}</joint>'


@pytest.fixture
def load(tmp_path: Path) -> Callable[..., list[str]]:
    def load(top: str = "", link: str = "", joint: str = "") -> list[str]:
        """The warnings about a robot of two links, with more elements at each place."""
        path = tmp_path / "robot.urdf"
        path.write_text(
            f'<robot name="tester">\n{top}\n<link name="a"/>\n<link name="b">{INERTIAL}{BALL}\n{link}</link>\n'
            f"{JOINT.format(joint)}</robot>"
        )
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            vx.load_urdf(vx.World(), path)
        assert len(caught) <= 1
        return [str(it.message) for it in caught]

    return load


@pytest.mark.parametrize(
    ("places", "text"),
    [
        ({"link": "<colision/>"}, "<colision>, did you mean <collision>? (link 'b' in line 5)"),
        ({"link": "<inertia/>"}, "<inertia>, did you mean <inertial>? (link 'b' in line 5)"),
        ({"link": "<Visual/>"}, "<Visual>, did you mean <visual>? (link 'b' in line 5)"),
        ({"link": "<inertial><mas/></inertial>"}, "<mas>, did you mean <mass>? (link 'b' in line"),
        ({"link": "<collision><geom/></collision>"}, "<geom>, did you mean <geometry>? (link 'b' in line 5)"),
        ({"joint": "<limits/>"}, "<limits>, did you mean <limit>? (joint 'j' in line 6)"),
        ({"top": "<links/>"}, "<links>, did you mean <link>? (the robot in line 2)"),
        ({"top": "<wings/>"}, "<wings> (the robot in line 2)"),
    ],
)  # fmt: skip
def test_unknown_elements_are_named_with_the_name_that_was_meant(load, places, text):
    [said] = load(**places)
    assert f"has unknown elements, which are not read: {text}" in said
    assert said.endswith("; correct or remove them")


def test_one_line_names_all_unknown_elements(load):
    [said] = load(link="<colision/>\n<colision/>", joint="<wings/>")
    assert said.endswith(
        "unknown elements, which are not read: <colision>, did you mean <collision>? (link 'b' in line 5, link 'b' in line 6), "
        "<wings> (joint 'j' in line 7); correct or remove them"
    )


def test_extensions_of_other_programs_are_not_doubted(load):
    assert not load(
        top='<material name="m"/><gazebo><wings/></gazebo><transmission name="t"><joint name="j"/></transmission>'
        "<ros2_control><joint><wings/></joint></ros2_control><mujoco/><sensor/><drake:joint/>",
        link="<contact/><verbose/><sensor/><gazebo/><drake:proximity/><visual><wings/></visual>",
        joint="<safety_controller/><calibration/><dynamics/><axis xyz='0 0 1'/>",
    )


@pytest.mark.parametrize(
    ("places", "owner"),
    [
        ({"top": '<xacro:include filename="x"/>'}, "robot.urdf:2: the robot has <xacro:include>"),
        ({"link": "<xacro:box_inertia/>"}, "robot.urdf:5: link 'b' has <xacro:box_inertia>"),
        ({"joint": "<axis/><xacro:if/>"}, "robot.urdf:6: joint 'j' has <xacro:if>"),
        ({"link": "<visual><geometry><xacro:mesh/></geometry></visual>"}, "has <xacro:mesh>"),
    ],
)
def test_macros_that_are_not_expanded_are_refused(load, places, owner):
    with pytest.raises(vx.RobotError, match=owner) as refusal:
        load(**places)
    assert "not expanded; run xacro " in str(refusal.value)
