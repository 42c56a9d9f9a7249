from __future__ import annotations

import math

import numpy as np
import pytest
import voxshell as vx
from voxshell.robots.mjcf.compiler import Compiler, read_compiler, turn_z_to

HALF = math.sqrt(0.5)
TURNED = {  # of an element: what x, y and z become
    "quat='2 0 0 2'": ((0, 1, 0), (-1, 0, 0), (0, 0, 1)),
    "axisangle='0 0 3 90'": ((0, 1, 0), (-1, 0, 0), (0, 0, 1)),
    "euler='90 90 0'": ((0, 1, 0), (0, 0, 1), (1, 0, 0)),
    "xyaxes='0 2 0 -3 1 0'": ((0, 1, 0), (-1, 0, 0), (0, 0, 1)),
    "zaxis='2 0 0'": ((0, 0, -1), (0, 1, 0), (1, 0, 0)),
    "zaxis='0 0 -1'": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
}


@pytest.mark.parametrize("text", TURNED)
def test_rotations_have_five_forms(element, text):
    pose = Compiler().read_pose(element(f"<body pos='1 2 3' {text}/>"))
    np.testing.assert_allclose(pose[:3, :3].T, TURNED[text], atol=1e-12)
    assert pose[:3, 3].tolist() == [1, 2, 3]


def test_capitals_turn_about_fixed_axes(element):
    body = element("<body euler='90 90 0'/>")
    fixed = Compiler(euler_sequence="XYZ").read_pose(body)
    np.testing.assert_allclose(
        fixed[:3, :3], vx.pose(euler=np.radians([90, 90, 0]))[:3, :3], atol=1e-12
    )
    turned = Compiler(euler_sequence="yxz", unit=1.0).read_pose(
        element("<body euler='0.1 0.2 0.3'/>")
    )
    steps = [vx.pose(axis_angle=(axis, angle)) for axis, angle in (((0, 1, 0), 0.1), ((1, 0, 0), 0.2), ((0, 0, 1), 0.3))]  # fmt: skip
    np.testing.assert_allclose(turned, steps[0] @ steps[1] @ steps[2], atol=1e-12)


def test_later_settings_replace_earlier_ones(read):
    file = read(
        "<compiler angle='radian' meshdir='a' boundmass='1' settotalmass='-1'/>",
        "<compiler assetdir='b' autolimits='false' inertiafromgeom='true' inertiagrouprange='1 2'/>",
    )
    settings = read_compiler(file.sections("compiler"))
    assert settings == Compiler(
        unit=1.0, mesh_folder="b", least_mass=1.0, limits_by_range=False,
        inertia_from_geoms="true", groups=(1.0, 2.0),
    )  # fmt: skip


@pytest.mark.parametrize(
    "text",
    ["coordinate='global'", "angle='turn'", "eulerseq='xyw'", "boundmass='x'", "autolimits='1'"],
)
def test_wrong_settings_are_refused(read, text):
    with pytest.raises(vx.RobotError, match=r"model\.xml:1: the robot has "):
        read_compiler(read(f"<compiler {text}/>").sections("compiler"))


def test_z_is_turned_the_short_way():
    turn = turn_z_to(np.array([HALF, 0, HALF]))
    np.testing.assert_allclose(turn @ [0, 0, 1], [HALF, 0, HALF], atol=1e-12)
    np.testing.assert_allclose(turn @ [0, 1, 0], [0, 1, 0], atol=1e-12)
