"""Robots that people share: those of the package pybullet, where it is installed."""

from __future__ import annotations

import warnings
from pathlib import Path

import voxshell as vx

REFUSED = {
    "biped/biped2d_pybullet.urdf": "<limit lower=",
    "kuka_iiwa/model_for_sdf.urdf": "is missing",
    "plane_implicit.urdf": "has a <plane>",
    "quadruped/microtaur/microtaur.urdf": "rpy=",
    "racecar/racecar_differential.urdf": "scale=",
    "torus_deform.urdf": "it has no <link>",
    "toys/concave_box.urdf": "has a <cdf>",
}
"""Files with a fault, and what the error says; tools/try_robots.py tries more packages."""


def test_every_robot_of_pybullet_loads_or_has_a_fault(pybullet_data):
    found = {}
    paths = [it for it in sorted(pybullet_data.rglob("*.urdf")) if "random_urdfs" not in it.parts]
    assert len(paths) > 90
    for path in paths:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", vx.RobotWarning)
            warnings.simplefilter("ignore", vx.MeshWarning)
            try:
                vx.load_urdf(vx.World(), path, mesh_as="hull")
            except vx.RobotError as error:
                found[path.relative_to(pybullet_data).as_posix()] = str(error)
    assert found.keys() == REFUSED.keys()
    for name, text in REFUSED.items():
        assert text in found[name]


def test_a_link_says_what_it_is_part_of(tmp_path: Path):
    path = tmp_path / "door.urdf"
    path.write_text(
        '<robot name="door"><link name="wall"/><link name="leaf"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial><collision><geometry>'
        '<box size="1 1 1"/></geometry></collision></link><joint name="turn" type="continuous">'
        '<parent link="wall"/><child link="leaf"/><axis xyz="0 0 1"/></joint></robot>'
    )
    robot = vx.load_urdf(vx.World(), path)
    assert repr(robot.links["wall"]) == "Link('wall', fixed to the world)"
    assert repr(robot.links["leaf"]) == f"Link('leaf', part of {robot.links['leaf'].body!r})"
