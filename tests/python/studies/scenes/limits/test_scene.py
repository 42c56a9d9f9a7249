"""How scenes of limits put bodies into worlds."""

from __future__ import annotations

import math

import pytest
from voxshell.model.shapes import Plane, Sphere
from voxshell_studies.scenes.everyday import forms
from voxshell_studies.scenes.limits.scene import fallen_way, open_world, put


def test_coefficients_are_those_of_a_pair():
    world = open_world(200.0)
    ground = put(world, forms.PLANE, friction=0.3, restitution=0.2)
    ball = put(world, Sphere(0.1), mass=1.0, friction=0.3, restitution=0.2)
    assert isinstance(ground.shape, Plane)
    assert ground.friction * ball.friction == pytest.approx(0.3)
    assert ground.restitution * ball.restitution == pytest.approx(0.2)


def test_only_what_is_driven_is_kinematic():
    world = open_world(60.0)
    assert put(world, forms.box(0.1, 0.1, 0.1), driven=True).motion == "kinematic"
    assert put(world, forms.box(0.1, 0.1, 0.1)).motion == "static"
    moving = put(world, forms.box(0.1, 0.1, 0.1), mass=2.0, velocity=(1.0, 0.0, 0.0))
    assert moving.motion == "dynamic"
    assert moving.linear_velocity[0] == 1.0


@pytest.mark.parametrize("rate", [1000.0, 30.0])
def test_a_free_body_falls_as_far_as_said(rate):
    world = open_world(rate)
    ball = put(world, Sphere(0.1), mass=1.0)
    world.step(round(0.5 * rate))
    assert math.isclose(-ball.position[2], fallen_way(rate, 0.5), rel_tol=1e-9)
