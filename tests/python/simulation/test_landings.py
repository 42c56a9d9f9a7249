"""Bodies that move too little in a step to pass anything still land on the surface, not in it."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import trimesh
import voxshell as vx
from trimesh.transformations import random_rotation_matrix


@cache
def make_box(*extents: float) -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.box(extents))


AXES = np.array((0.08, 0.05, 0.03))  # m, half of an ellipsoid's


def land_ellipsoid(rate: int, height: float, placement: int) -> float:
    """Let an ellipsoid fall on a slab, and return how deep it is at most, in meters."""
    random = np.random.default_rng(placement)
    pose = random_rotation_matrix(random.random(3))
    pose[2, 3] = AXES.max() + height * random.uniform(0.9, 1.1)
    world = vx.World(time_step=1 / rate)
    world.add(make_box(2.0, 2.0, 0.1), mass=0, pose=(0, 0, -0.05))
    mesh = trimesh.creation.icosphere(4, 1.0).apply_scale(AXES)
    body = world.add(vx.Model.from_mesh(mesh), mass=0.1, pose=pose)
    deepest = 0.0
    for _ in range(round((np.sqrt(2.2 * (height + AXES.max()) / 9.81) + 0.1) * rate)):
        world.step()
        deepest = max(deepest, np.linalg.norm(AXES * body.pose[2, :3]) - body.pose[2, 3])
    return deepest


@pytest.mark.parametrize("rate", [200, 60, 30])
def test_bodies_that_a_blow_turns_stay_out_of_the_ground(rate: int):
    depths = [land_ellipsoid(rate, 0.05, placement) for placement in range(6)]
    # 0.75, 2.3 and 3.7 mm while the planes of contacts stayed as they were.
    assert np.median(depths) < 4e-4


@pytest.mark.parametrize("placement", [2, 13])
def test_bodies_that_would_be_as_deep_without_turning_stay_out_of_flat_ground(placement: int):
    # 2.2 and 3.8 mm while only a change of the depth counted.
    assert land_ellipsoid(60, 0.3, placement) < 1e-3


@pytest.mark.parametrize("rate", [1000, 200, 60])
@pytest.mark.parametrize(
    "shape", [vx.Cylinder(0.02, 0.1), vx.Cylinder(0.04, 0.1), vx.Cone(0.04, 0.1)]
)
def test_round_shapes_that_land_flat_stand(shape: vx.Cylinder | vx.Cone, rate: int):
    for height in (0.1, 0.4):
        world = vx.World(time_step=1 / rate)
        world.add(vx.Plane(), mass=0, friction=1)
        body = world.add(shape, mass=0.5, pose=(0, 0, 0.05 + height), friction=1)
        world.step(2 * rate)
        assert body.pose[2, 2] > np.cos(np.radians(1))
        assert np.hypot(*body.position[:2]) < 1e-3


@pytest.mark.parametrize("rate", [1000, 500, 200, 60])
@pytest.mark.parametrize("side", [0.1, 1.0])
@pytest.mark.parametrize("ground", ["slab", "plane"])
def test_cubes_land_no_deeper_than_a_500th_of_their_side(ground: str, side: float, rate: int):
    corners = trimesh.creation.box((side, side, side)).vertices
    cube = make_box(side, side, side)
    slab = make_box(10 * side, 10 * side, side)
    deepest = 0.0
    for placement in range(6):
        random = np.random.default_rng(placement)
        pose = np.eye(4) if placement % 2 else random_rotation_matrix(random.random(3))
        pose[2, 3] = random.uniform(1.2, 3.6) * side
        world = vx.World(time_step=1 / rate)
        if ground == "slab":
            world.add(slab, mass=0, pose=(0, 0, -0.5 * side))
        else:
            world.add(vx.Plane(), mass=0)
        body = world.add(cube, mass=1000 * side**3, pose=pose)
        for _ in range(round((np.sqrt(0.8 * side) + 0.1) * rate)):
            world.step()
            heights = corners @ body.pose[2, :3] + body.pose[2, 3]
            deepest = max(deepest, -heights.min())
    assert deepest <= side / 500
