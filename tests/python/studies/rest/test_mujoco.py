from __future__ import annotations

import itertools

import numpy as np
import pytest
import trimesh
from voxshell.model.mass_properties import MassProperties
from voxshell_studies.rest.mujoco import MuJoCoFall


def test_mujoco_lets_a_box_fall_and_lie():
    pytest.importorskip("mujoco", reason="of voxshell-studies[peers]")
    corners = np.array(list(itertools.product((-0.1, 0.1), repeat=3)))
    matter = MassProperties(1.0, np.zeros(3), np.eye(3) * 0.2**2 / 6.0)
    pose = trimesh.transformations.rotation_matrix(0.3, (1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    pose[2, 3] = 0.2
    fall = MuJoCoFall(corners, matter, 1000.0, pose)
    turning = np.array([fall.step() for _ in range(2000)])
    assert (turning[:50] < 1e-12).all()
    assert turning.max() > 1.0
    assert turning[-1] < 1e-3
