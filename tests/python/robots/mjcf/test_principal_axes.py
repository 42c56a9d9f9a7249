from __future__ import annotations

import numpy as np
import pytest
from voxshell.robots.mjcf.principal_axes import find_principal_axes


def test_moments_come_largest_first_with_their_axes():
    rng = np.random.default_rng(3)
    for _ in range(50):
        inertia = rng.normal(size=(3, 3))
        inertia = inertia @ inertia.T * 10.0 ** rng.uniform(-8, 3)
        moments, axes = find_principal_axes(inertia)
        np.testing.assert_allclose(moments, np.linalg.eigvalsh(inertia)[::-1], rtol=1e-6)
        np.testing.assert_allclose(
            axes @ np.diag(moments) @ axes.T, inertia, atol=1e-9 * moments[0]
        )
        assert np.linalg.det(axes) == pytest.approx(1)


def test_axes_stay_where_the_moments_are_sorted():
    moments, axes = find_principal_axes(np.diag([3.0, 2.0, 1.0]))
    assert moments.tolist() == [3, 2, 1]
    np.testing.assert_array_equal(axes, np.eye(3))
    np.testing.assert_array_equal(find_principal_axes(np.eye(3))[1], np.eye(3))
    np.testing.assert_array_equal(find_principal_axes(np.zeros((3, 3)))[1], np.eye(3))


def test_an_inertia_that_is_turned_by_an_eighth_is_turned_back():
    turned = np.array([[2.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.0, 0.0, 0.5]])
    moments, axes = find_principal_axes(turned)
    np.testing.assert_allclose(moments, (3, 1, 0.5))
    np.testing.assert_allclose(np.abs(axes[:, 0]), (0.5**0.5, 0.5**0.5, 0))
