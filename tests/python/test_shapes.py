from __future__ import annotations

import numpy as np
import pytest
import voxshell as vx

SHAPES = {
    "plane": lambda: vx.Plane(normal=(1, 2, 2), offset=0.5),
    "box": lambda: vx.Box(half_extents=(0.3, 0.5, 0.8)),
    "sphere": lambda: vx.Sphere(radius=0.7),
}


def exact_distance(shape: vx.Field, p: np.ndarray) -> np.ndarray:
    if isinstance(shape, vx.Plane):
        return p @ shape.normal - shape.offset
    if isinstance(shape, vx.Sphere):
        return np.linalg.norm(p, axis=1) - shape.radius
    assert isinstance(shape, vx.Box)
    beyond = np.abs(p) - shape.half_extents
    return np.linalg.norm(np.maximum(beyond, 0), axis=1) + np.minimum(beyond.max(axis=1), 0)


@pytest.mark.parametrize("kind", SHAPES)
def test_distances_are_exact_and_gradients_their_slopes(kind: str):
    shape = SHAPES[kind]()
    rng = np.random.default_rng(2)
    points = rng.uniform(-1.0, 1.0, (5_000, 3))
    distances = shape.sample(points)
    assert 0.05 < np.mean(distances < 0) < 0.95
    np.testing.assert_allclose(distances, exact_distance(shape, points), atol=1e-6)
    gradients = shape.gradient(points)
    np.testing.assert_allclose(np.linalg.norm(gradients, axis=1), 1.0, atol=1e-6)
    step = 1e-6
    forward = exact_distance(shape, points + step * gradients)
    off = np.abs(forward - exact_distance(shape, points) - step)
    assert np.mean(off < 1e-3 * step) > 0.99  # all but those beside a ridge


def test_where_a_shape_has_no_single_gradient_it_still_gives_one():
    np.testing.assert_array_equal(vx.Sphere(1.0).gradient([[0, 0, 0]]), [[0, 0, 1]])
    np.testing.assert_array_equal(vx.Box((1, 1, 1)).gradient([[0, 0, 0]]), [[1, 0, 0]])
    np.testing.assert_array_equal(vx.Box((1, 1, 1)).gradient([[0.5, -0.5, 0.5]]), [[1, 0, 0]])


def test_a_plane_keeps_its_normal_at_unit_length():
    for scale in (1.0, 1e-300, 1e300):
        plane = vx.Plane(normal=(0.0, 3.0 * scale, 4.0 * scale), offset=2.0)
        np.testing.assert_allclose(plane.normal, (0.0, 0.6, 0.8), rtol=1e-15)
        assert plane.offset == 2.0  # metres along the unit normal, whatever was given
    np.testing.assert_array_equal(vx.Plane().normal, (0, 0, 1))
    assert vx.Plane().offset == 0.0


def test_what_shapes_say_of_themselves():
    assert repr(SHAPES["box"]()) == "Box(half_extents=(0.3, 0.5, 0.8))"
    assert repr(SHAPES["sphere"]()) == "Sphere(radius=0.7)"
    assert repr(vx.Plane()) == "Plane(normal=(0.0, 0.0, 1.0), offset=0)"
    box = vx.Box((1, 2, 3))
    box.half_extents[0] = 9.0  # a copy
    np.testing.assert_array_equal(box.half_extents, (1, 2, 3))


def test_shapes_cannot_be_changed():
    with pytest.raises(AttributeError):
        SHAPES["sphere"]().radius = 2.0  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(AttributeError):
        SHAPES["plane"]().normal = (1, 0, 0)  # pyright: ignore[reportAttributeAccessIssue]


@pytest.mark.parametrize("radius", [0, -1, np.nan, np.inf, 1e300, None, "1", [1, 2], 1j])
def test_a_wrong_radius_is_refused(radius):
    with pytest.raises(vx.SettingsError, match="radius"):
        vx.Sphere(radius)


@pytest.mark.parametrize(
    "half_extents",
    [(1, 1), (1, 1, 0), (1, -1, 1), (1, 1, np.nan), (1, 1, 1e300), 1.0, None, "box", [(1, 1, 1)]],
)
def test_wrong_half_extents_are_refused(half_extents):
    with pytest.raises(vx.SettingsError, match="half_extents"):
        vx.Box(half_extents)


@pytest.mark.parametrize("normal", [(0, 0, 0), (1, 0), (np.nan, 0, 1), (np.inf, 0, 0), None, "z"])
def test_a_wrong_normal_is_refused(normal):
    with pytest.raises(vx.SettingsError, match="normal"):
        vx.Plane(normal)


@pytest.mark.parametrize("offset", [np.nan, np.inf, 1e300, None, "1"])
def test_a_wrong_offset_is_refused(offset):
    with pytest.raises(vx.SettingsError, match="offset"):
        vx.Plane(offset=offset)
