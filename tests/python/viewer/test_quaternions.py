from __future__ import annotations

import numpy as np
from trimesh.transformations import rotation_matrix
from voxshell.viewer.quaternions import as_steady, rotations_as_wxyz


def test_signs_of_quaternions_do_not_jump():
    turns = [rotation_matrix(angle, (1, 2, 3))[:3, :3] for angle in np.linspace(0.0, 9.0, 50)]
    steady = as_steady(rotations_as_wxyz(np.array(turns)))
    assert np.einsum("ij,ij->i", steady[1:], steady[:-1]).min() > 0.9
