from __future__ import annotations

import gc

import numpy as np
import pytest
import trimesh
import voxshell as vx
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

SAGITTA = 1.5e-4
"""Meters by which the ball's facets lie within its sphere, at most."""


def test_what_it_says_of_its_grid(cube: vx.Model):
    field = cube.field
    assert field.voxel_size == 0.05
    assert isinstance(field.shape, tuple)
    assert len(field.shape) == 3
    assert 0 < field.nbytes < 4 * 41**3
    assert field.interpolation_error == pytest.approx(np.sqrt(0.75) * 0.05, rel=0.01)
    far_corner = field.origin + field.voxel_size * (np.array(field.shape) - 1)
    assert np.all(field.origin <= cube.bounds[0] - 0.39)
    assert np.all(far_corner >= cube.bounds[1] + 0.39)
    assert "0.05 m" in repr(field)


def test_what_it_says_of_its_sign(cube: vx.Model):
    assert cube.field.sign_method == "closed"
    assert cube.field.sign_confidence == 1.0
    mesh = trimesh.creation.icosphere(3)
    with pytest.warns(vx.MeshWarning, match=r"3 open edges, the first near \["):
        holed = vx.Model.from_mesh((mesh.vertices, mesh.faces[1:]), resolution=20)
    assert holed.field.sign_method == "winding"
    assert 0.5 < holed.field.sign_confidence <= 1.0
    assert holed.field.sample([[0, 0, 0], [0, 0, 2]]) == pytest.approx([-1.0, 1.0], abs=0.1)


def test_it_cannot_be_changed(cube: vx.Model):
    with pytest.raises(AttributeError):
        cube.field.voxel_size = 1.0  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(AttributeError):
        cube.field.extra = 1.0  # pyright: ignore[reportAttributeAccessIssue]


def test_distances_are_true_within_the_bound(cube: vx.Model):
    rng = np.random.default_rng(0)
    points = rng.uniform(-0.68, 0.68, (20_000, 3))
    exact = vx.Box((0.5, 0.5, 0.5)).sample(points)
    assert np.count_nonzero(exact < 0) > 5_000
    error = np.abs(cube.field.sample(points) - exact)
    assert error.max() <= cube.field.interpolation_error
    assert np.median(error) < 1e-6  # linear away from edges and from the inside's ridges


def test_gradients_are_slopes_of_the_distance(ball: vx.Model):
    rng = np.random.default_rng(1)
    points = rng.uniform(-0.135, 0.135, (2_000, 3))  # within the grid
    step = 1e-4
    slopes = np.stack(
        [
            (ball.field.sample(points + shift) - ball.field.sample(points - shift)) / (2 * step)
            for shift in step * np.eye(3)
        ],
        axis=1,
    )
    gradients = ball.field.gradient(points)
    off = np.abs(slopes - gradients).max(axis=1)
    # Where a difference reaches across a face between cells, slopes are those of two cells.
    assert np.quantile(off, 0.85) < 2e-3
    assert np.all(np.sum(points * gradients, axis=1) > 0)


def test_nodes_near_the_surface_are_exact(ball: vx.Model):
    nodes = np.argwhere(np.ones(ball.field.shape, dtype=bool))
    points = ball.field.origin + ball.field.voxel_size * nodes
    exact = np.linalg.norm(points, axis=1) - 0.1
    near = np.abs(exact) < 0.1 * ball.field.voxel_size
    assert np.count_nonzero(near) > 500
    # A quantum, and how far the mesh is from the sphere.
    off = np.abs(ball.field.sample(points[near]) - exact[near])
    assert off.max() < ball.field.voxel_size / 256 + SAGITTA


def test_a_field_outlives_its_model():
    model = vx.Model.from_mesh(trimesh.creation.box(), resolution=20)
    field = model.field
    points = np.random.default_rng(2).uniform(-1, 1, (100, 3))
    before = field.sample(points)
    del model
    gc.collect()
    np.testing.assert_array_equal(field.sample(points), before)


@pytest.mark.parametrize("method", ["sample", "gradient"])
def test_points_of_any_layout_and_type_are_taken(ball: vx.Model, method: str):
    call = getattr(ball.field, method)
    points = np.array([[0.0, 0.0, 1.0], [1.0, 2.0, 3.0], [0.0, 0.0, 0.0]])
    expected = call(points)
    assert expected.shape == ((3,) if method == "sample" else (3, 3))
    assert expected.dtype == np.float64
    assert expected.flags.writeable  # a new array each time
    for same in (points.tolist(), np.asfortranarray(points), points.astype(np.int8)):
        np.testing.assert_array_equal(call(same), expected)
    assert len(call(np.empty((0, 3)))) == 0


@pytest.mark.parametrize("method", ["sample", "gradient"])
@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([0.0, 0.0, 0.0], r"\(n, 3\) numbers, not \[0.0, 0.0, 0.0\]$"),
        ([[0.0, 0.0]], r"of shape \(1, 2\)"),
        (np.zeros((2, 2, 3)), r"of shape \(2, 2, 3\)"),
        (0.0, "not 0.0$"),
        (None, "not None$"),
        ("points", "not 'points'$"),
        ([[0, 0, "a"]], "<U"),
        ([[0, 0, 1j]], "complex"),
        ([[0, 0, 0], [0, np.nan, 0]], "row 1 of 2"),
        ([[0, 0, 0], [0, 0, 0], [np.inf, 0, 0]], "row 2 of 3"),
        ([[0, 0, 1e300]], "within 1e15 m; row 0"),
    ],
)
def test_wrong_points_are_refused(ball: vx.Model, method: str, points, message: str):
    for field in (ball.field, vx.Plane(), vx.Box((1, 1, 1)), vx.Sphere(1)):
        with pytest.raises(vx.SettingsError, match=message):
            getattr(field, method)(points)


@given(hnp.arrays(np.float64, (3, 3), elements=st.floats(-1e15, 1e15)))
@settings(max_examples=200, deadline=None)
def test_any_finite_point_has_a_distance(ball, points):
    for field in (ball.field, vx.Plane((1, 1, 1)), vx.Box((1, 1, 1)), vx.Sphere(1)):
        assert np.all(np.isfinite(field.sample(points)))
        assert np.all(np.isfinite(field.gradient(points)))
