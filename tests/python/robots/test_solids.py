from __future__ import annotations

import numpy as np
import pytest
from voxshell.model.mass_properties import MassProperties
from voxshell.robots.description import Primitive
from voxshell.robots.solids import add_up, bound_moments, is_sound, weigh_primitive

SHAPES = {
    "box": (0.2, 0.4, 0.6),
    "sphere": (0.3,),
    "ellipsoid": (0.1, 0.2, 0.3),
    "cylinder": (0.1, 0.5),
    "capsule": (0.1, 0.5),
}


def is_inside(kind, sizes, points):
    x, y, z = points.T
    match kind:
        case "box":
            return (np.abs(points) < np.array(sizes) / 2).all(axis=1)
        case "sphere":
            return (points**2).sum(axis=1) < sizes[0] ** 2
        case "ellipsoid":
            return ((points / sizes) ** 2).sum(axis=1) < 1
        case "cylinder":
            return (x**2 + y**2 < sizes[0] ** 2) & (np.abs(z) < sizes[1] / 2)
        case _:
            beyond = np.maximum(np.abs(z) - sizes[1] / 2, 0)
            return x**2 + y**2 + beyond**2 < sizes[0] ** 2


@pytest.mark.parametrize("kind", SHAPES)
def test_formulas_agree_with_sums_over_points(kind):
    sizes = SHAPES[kind]
    step = 0.01
    axis = np.arange(-0.4 + step / 2, 0.4, step)
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    points = points[is_inside(kind, sizes, points)]
    matter = weigh_primitive(Primitive(kind, sizes), 1000.0)
    mass = 1000.0 * step**3
    assert matter.mass == pytest.approx(mass * len(points), rel=0.02)
    spread = mass * points.T @ points
    np.testing.assert_allclose(
        np.diag(matter.inertia), np.trace(spread) - np.diag(spread), rtol=0.03
    )


def test_a_plane_weighs_nothing():
    assert weigh_primitive(Primitive("plane", ()), 1.0).mass == 0.0


def test_two_halves_are_the_whole():
    half = weigh_primitive(Primitive("box", (0.5, 0.2, 0.1)), 1000.0)
    left, right = np.eye(4), np.eye(4)
    left[0, 3], right[0, 3] = 1.0, 1.5
    whole = add_up([(half, left), (half, right)])
    expected = weigh_primitive(Primitive("box", (1.0, 0.2, 0.1)), 1000.0)
    assert whole.mass == pytest.approx(expected.mass)
    np.testing.assert_allclose(whole.center_of_mass, (1.25, 0, 0), atol=1e-12)
    np.testing.assert_allclose(whole.inertia, expected.inertia, atol=1e-12)


def test_parts_turn_with_their_places():
    rod = MassProperties(1.0, np.zeros(3), np.diag([1.0, 2.0, 3.0]))
    turned = np.eye(4)
    turned[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    np.testing.assert_allclose(np.diag(add_up([(rod, turned)]).inertia), (2, 1, 3))


def test_an_inertia_is_sound_if_it_can_be_inverted():
    assert is_sound(np.diag([1e-7, 1.0, 1.0]))
    assert not is_sound(np.diag([1e-9, 1.0, 1.0]))
    assert not is_sound(np.diag([-1.0, 1.0, 1.0]))


def test_an_inertia_that_no_body_has_is_reduced():
    possible = np.diag([1.0, 2.0, 3.0])
    assert bound_moments(possible) is possible
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    bounded = bound_moments(turn @ np.diag([1.0, 2.0, 100.0]) @ turn.T)
    np.testing.assert_allclose(turn.T @ bounded @ turn, possible, atol=1e-12)
