from __future__ import annotations

import numpy as np
import pytest
from voxshell.base.rotations import (
    CORRECTED,
    determinant,
    entries_of,
    nearest_rotation,
    orthonormal_errors,
    rotation_from_xyzw,
    xyzw_from_rotation,
)


def quaternions(count: int) -> np.ndarray:
    drawn = np.random.default_rng(7).normal(size=(count, 4))
    return drawn / np.linalg.norm(drawn, axis=1, keepdims=True)


def as_matrix(entries: tuple) -> np.ndarray:
    return np.array(entries).reshape(3, 3)


def test_quaternions_are_found_again_and_turn_as_they_say():
    for x, y, z, w in quaternions(500):
        rotation = as_matrix(rotation_from_xyzw(x, y, z, w))
        point = np.array([0.3, -0.2, 0.9])
        vector = np.array([x, y, z])
        turned = point + 2.0 * np.cross(vector, np.cross(vector, point) + w * point)
        assert rotation @ point == pytest.approx(turned, abs=1e-14)
        found = xyzw_from_rotation(rotation)
        assert found == pytest.approx(np.array([x, y, z, w]) * np.sign(w), abs=1e-14)
        assert found[3] >= 0.0


@pytest.mark.parametrize("axis", range(3))
def test_half_turns_keep_their_axis(axis: int):
    quaternion = np.zeros(4)
    quaternion[axis] = 1.0
    rotation = as_matrix(rotation_from_xyzw(*quaternion))
    assert np.abs(xyzw_from_rotation(rotation)).tolist() == quaternion.tolist()


def test_the_length_of_a_quaternion_does_not_matter():
    x, y, z, w = quaternions(1)[0]
    short, long = rotation_from_xyzw(x, y, z, w), rotation_from_xyzw(*(8.0 * quaternions(1)[0]))
    assert np.array(short) == pytest.approx(np.array(long), abs=1e-15)


def test_many_rotations_have_the_bits_of_each():
    drawn = quaternions(50)
    many = rotation_from_xyzw(*drawn.T)
    for index, quaternion in enumerate(drawn):
        assert [entry[index] for entry in many] == list(rotation_from_xyzw(*quaternion))


def test_the_nearest_rotation_is_the_polar_factor():
    random = np.random.default_rng(8)
    for x, y, z, w in quaternions(100):
        off = as_matrix(rotation_from_xyzw(x, y, z, w))
        off = off + random.uniform(-0.3, 0.3, (3, 3)) * CORRECTED
        found = as_matrix(nearest_rotation(entries_of(off)))
        left, _, right = np.linalg.svd(off)
        assert found == pytest.approx(left @ right, abs=1e-14)
        assert max(orthonormal_errors(entries_of(found))) < 1e-15 * 10
        assert determinant(entries_of(found)) == pytest.approx(1.0, abs=1e-14)
