"""Robots as pybullet reads them: the same joints, masses and places of links, where it is installed."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest
import voxshell as vx

FILES = (
    "franka_panda/panda.urdf",
    "humanoid/humanoid.urdf",
    "kuka_iiwa/model_free_base.urdf",
    "laikago/laikago_toes.urdf",
    "mini_cheetah/mini_cheetah.urdf",
    "quadruped/minitaur.urdf",
    "r2d2.urdf",
    "racecar/racecar.urdf",
    "xarm/xarm6_robot.urdf",
)
"""Of pybullet's data, each link with a mass: pybullet gives 1 kg to those without, and we their volume's."""


@pytest.mark.parametrize("name", FILES)
def test_links_are_where_pybullet_has_them(name):
    bullet = pytest.importorskip("pybullet", reason="compares with the package pybullet")
    path = Path(pytest.importorskip("pybullet_data").getDataPath(), name)
    client = bullet.connect(bullet.DIRECT)
    try:
        other = bullet.loadURDF(str(path), flags=bullet.URDF_USE_INERTIA_FROM_FILE)
        joints = range(bullet.getNumJoints(other))
        mass = sum(bullet.getDynamicsInfo(other, joint)[0] for joint in (-1, *joints))
        facts = [bullet.getJointInfo(other, joint) for joint in joints]
        states = [bullet.getLinkState(other, joint) for joint in joints]
        turns = [np.reshape(bullet.getMatrixFromQuaternion(it[5]), (3, 3)) for it in states]
    finally:
        bullet.disconnect(client)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", vx.RobotWarning)
        warnings.simplefilter("ignore", vx.MeshWarning)
        robot = vx.load_urdf(vx.World(), path, mesh_as="hull", fixed_base=False)
    moving = {it[1].decode() for it in facts if it[2] != bullet.JOINT_FIXED}
    assert {*robot.joints, *robot.ball_joints} == moving
    assert len(robot.links) == len(facts) + 1
    assert sum(body.mass for body in robot.bodies) == pytest.approx(mass, rel=1e-6)
    for fact, state, turn in zip(facts, states, turns, strict=True):
        pose = robot.links[fact[12].decode()].pose
        np.testing.assert_allclose(pose[:3, 3], state[4], atol=1e-5)
        np.testing.assert_allclose(pose[:3, :3], turn, atol=1e-5)
