"""Balls that hit each other aslant go off along the line of their centers, and do not begin to spin."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import trimesh
import voxshell as vx
from trimesh.transformations import random_rotation_matrix

RADIUS = 0.05
BLOWS = 8


@cache
def ball() -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.icosphere(subdivisions=3, radius=RADIUS))


@pytest.mark.parametrize(("rate", "speed"), [(1000, 5.0), (200, 5.0), (60, 2.0)])
@pytest.mark.parametrize("restitution", [1.0, 0.5])
def test_the_ball_that_is_hit_leaves_along_the_line_of_centers(
    restitution: float, rate: int, speed: float
) -> None:
    rng = np.random.default_rng(5)
    for _ in range(BLOWS):
        beside = rng.uniform(0.2, 0.8) * 2 * RADIUS
        along = np.sqrt(4 * RADIUS**2 - beside**2)
        world = vx.World(time_step=1 / rate, gravity=(0, 0, 0))
        pose = random_rotation_matrix(rng.random(3))
        pose[:3, 3] = (-along - 0.06 - rng.random() * speed / rate, beside, 0)
        both = {"mass": 1, "restitution": np.sqrt(restitution), "friction": 0}
        first = world.add(ball(), pose=pose, **both)
        second = world.add(ball(), pose=random_rotation_matrix(rng.random(3)), **both)
        first.linear_velocity = (speed, 0, 0)
        world.step(round(0.2 / speed * rate) + 4)
        normal = np.array((along, -beside, 0)) / (2 * RADIUS)
        true = 0.5 * (1 + restitution) * speed * normal[0] * normal
        # A degree and a half: normals of facets that stand for a sphere are off by up to one.
        assert np.linalg.norm(second.linear_velocity - true) < 0.03 * speed
        for body in (first, second):
            assert RADIUS * np.linalg.norm(body.angular_velocity) < 0.1 * speed
