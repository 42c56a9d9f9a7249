"""Bodies that begin deep in each other, at default settings: they part by the shortest way, without speed."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import trimesh
import voxshell as vx
from scipy.spatial.transform import Rotation

MESHES = {
    "cube": trimesh.creation.box((0.1, 0.1, 0.1)),
    "plate": trimesh.creation.box((0.2, 0.15, 0.01)),
    "ball": trimesh.creation.icosphere(3, 0.05),
    "torus": trimesh.creation.torus(0.05, 0.015),
}
SHORTEST = {
    "cube": 0.1,
    "plate": 0.01,
    "ball": 0.0996,
    "torus": 0.03,
}  # m, ways out of a body's own place


@cache
def build(name: str) -> vx.Model:
    return vx.Model.from_mesh(MESHES[name])


def depth_between(model, a, b):
    return vx.contacts(model, model, np.linalg.inv(b.pose) @ a.pose).depths.max(initial=0.0)


def run(model, offset, rate=200, turn=None):
    world = vx.World(time_step=1 / rate, gravity=(0, 0, 0))
    pose = np.eye(4)
    if turn is not None:
        pose[:3, :3] = Rotation.from_rotvec(turn).as_matrix()
    other = pose.copy()
    other[:3, 3] = offset
    a = world.add(model, pose=pose)
    b = world.add(model, pose=other)
    world.step(max(rate, 60))  # each takes a fifth of the depth that is left
    return a, b


@pytest.mark.parametrize("rate", [200, 30])
@pytest.mark.parametrize(
    "offset", [(0, 0, 0), (1e-6, 0, 0), (1e-3, 0, 0), (0.0006, 0.00064, 0.00048)], ids=str
)
@pytest.mark.parametrize("name", MESHES)
def test_bodies_in_nearly_the_same_place_part_by_the_shortest_way(name, offset, rate):
    model = build(name)
    a, b = run(model, offset, rate)
    assert depth_between(model, a, b) < 1e-4
    assert np.linalg.norm(a.pose[:3, 3] - b.pose[:3, 3]) < 1.1 * SHORTEST[name] + 1e-3
    assert np.linalg.norm([a.linear_velocity, b.linear_velocity]) < 1e-3


@pytest.mark.parametrize("turn", [None, (0.3, 0.2, 0.1)], ids=["level", "aslant"])
@pytest.mark.parametrize("offset", [(0.02, 0, 0), (0, 0.03, 0), (0.02, 0.02, 0)], ids=str)
@pytest.mark.parametrize("name", MESHES)
def test_bodies_that_overlap_by_most_of_their_size_part(name, offset, turn):
    model = build(name)
    a, b = run(model, offset, turn=turn)
    assert depth_between(model, a, b) < 2e-4
    assert np.linalg.norm([a.linear_velocity, b.linear_velocity]) < 1e-3


def test_a_ball_in_the_wall_of_a_room_leaves_the_wall_not_the_room():
    outer = trimesh.creation.box((4, 4, 2))
    inner = trimesh.creation.box((3.8, 3.8, 1.8))
    inner.invert()
    room = vx.Model.from_mesh(trimesh.util.concatenate([outer, inner]))
    ball = vx.Model.from_mesh(trimesh.creation.icosphere(3, 0.1))
    world = vx.World(gravity=(0, 0, 0))
    world.add(room, mass=0)
    pose = np.eye(4)
    pose[:3, 3] = (1.94, 0.3, 0.1)
    body = world.add(ball, pose=pose)
    world.step(200)
    x, y, z = body.pose[:3, 3]
    assert x == pytest.approx(1.8, abs=5e-3)
    assert (y, z) == pytest.approx((0.3, 0.1), abs=5e-3)


@pytest.mark.parametrize(
    "shape", [vx.Box((0.05, 0.05, 0.05)), vx.Sphere(0.05), vx.Cylinder(0.05, 0.1)]
)
def test_a_model_leaves_a_shape_in_whose_place_it_is(shape):
    model = build("cube")
    world = vx.World(gravity=(0, 0, 0))
    body = world.add(model)
    other = world.add(shape, mass=1)
    world.step(200)
    distance = np.linalg.norm(body.pose[:3, 3] - other.pose[:3, 3])
    assert 0.099 < distance < 0.103
