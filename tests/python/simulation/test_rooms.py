"""Bodies in closed rooms that they would cross within a step or two."""

from __future__ import annotations

import itertools
import math
from functools import cache

import numpy as np
import pytest
import trimesh
import voxshell as vx

HALF = 0.05  # of the rooms, meters
WALL = 0.005
MASS = 0.05

MESHES = {
    "ball": trimesh.creation.icosphere(3, 0.015),
    "block": trimesh.creation.box((0.03, 0.02, 0.025)),
    "ring": trimesh.creation.torus(0.015, 0.006),
}


@cache
def build_shape(kind):
    if kind in MESHES:
        return vx.Model.from_mesh(MESHES[kind])
    return {
        "vx.Sphere": vx.Sphere(0.015),
        "vx.Box": vx.Box((0.015, 0.01, 0.0125)),
        "vx.Capsule": vx.Capsule(0.012, 0.02),
        "vx.Cylinder": vx.Cylinder(0.012, 0.03),
        "vx.Cone": vx.Cone(0.012, 0.03),
    }[kind]


@cache
def build_room(kind):
    outer, inner = 2 * (HALF + WALL), 2 * HALF
    if kind == "box":
        walls = trimesh.creation.box([outer] * 3), trimesh.creation.box([inner] * 3)
    else:
        walls = (
            trimesh.creation.cylinder(outer / 2, outer, sections=64),
            trimesh.creation.cylinder(inner / 2, inner, sections=64),
        )
    walls[1].invert()
    return vx.Model.from_mesh(trimesh.util.concatenate(walls))


def add_walls(world, room, restitution):
    """Add a room of one model, or of six boxes that are bodies or parts of one."""
    look = {"motion": "static", "restitution": restitution, "friction": 0.3}
    if room in ("box", "can"):
        world.add(build_room(room), **look)
        return
    parts = []
    for axis, side in itertools.product(range(3), (-1, 1)):
        half, place = [HALF + WALL] * 3, [0.0] * 3
        half[axis] = 0.5 * WALL
        place[axis] = side * (HALF + 0.5 * WALL)
        parts.append((vx.Box(half), tuple(place)))
    if room == "compound":
        world.add(vx.Compound(parts), **look)
        return
    for shape, place in parts:
        world.add(shape, pose=place, **look)


def throw(kind, room, restitution, speed, rate, seed):
    rng = np.random.default_rng(seed)
    world = vx.World(1 / rate, gravity=(0, 0, 0))
    add_walls(world, room, restitution)
    body = world.add(build_shape(kind), mass=MASS, restitution=restitution, friction=0.3)
    way = rng.normal(size=3)
    body.linear_velocity = speed * way / np.linalg.norm(way)
    body.angular_velocity = rng.normal(size=3) * 6 * speed
    return world, body


# Of 6 throws each, up to 6 left their room.
@pytest.mark.parametrize(("rate", "speed"), [(200, 6), (60, 6), (30, 4)])
@pytest.mark.parametrize("restitution", [0, 0.5, 0.9])
@pytest.mark.parametrize(
    ("kind", "room"),
    [
        *itertools.product(("ball", "block", "ring"), ("box", "can")),
        *itertools.product(("ball", "block"), ("boxes", "compound")),
        *itertools.product(("vx.Sphere", "vx.Box"), ("box", "can")),
    ],
)
@pytest.mark.filterwarnings("ignore:.*rad a step:voxshell.AccuracyWarning")
def test_what_is_thrown_in_a_room_stays_there(kind, room, restitution, rate, speed):
    for seed in range(2):
        world, body = throw(kind, room, restitution, speed, rate, seed)
        for _ in range(rate // 5):
            world.step()
            assert np.abs(body.position).max() < HALF
            assert np.linalg.norm(body.linear_velocity) < 1.02 * speed


# It left the room, or ended the step with the speed of a ball that has been stopped.
def bounce(rate):
    """Places and speeds of an elastic ball between two walls."""
    world = vx.World(1 / rate, gravity=(0, 0, 0))
    for side in (-1, 1):
        world.add(
            vx.Box((0.2, 0.2, 0.01)), pose=(0, 0, 0.041 * side), motion="static", restitution=1
        )
    ball = world.add(build_shape("ball"), mass=MASS, restitution=1)
    ball.linear_velocity = (0, 0, 5)
    for _ in range(30):
        world.step()
        yield ball.position, np.linalg.norm(ball.linear_velocity)


@pytest.mark.parametrize("rate", [200, 60, 30])
def test_an_elastic_ball_that_crosses_a_room_several_times_a_step_keeps_its_energy(rate):
    for _, speed in bounce(rate):
        assert speed == pytest.approx(5, rel=2e-4)


DEEPER = pytest.mark.xfail(reason="0.111 mm deep since decision 70", strict=True)


@pytest.mark.parametrize(
    ("rate", "most_deep"), [(200, 1e-5), (60, 5e-5), pytest.param(30, 1e-4, marks=DEEPER)]
)
def test_an_elastic_ball_that_crosses_a_room_several_times_a_step_stays_in_it(rate, most_deep):
    for position, _ in bounce(rate):
        assert abs(position[2]) <= 0.031 - 0.015 + most_deep


# Friction at several walls at once gives such a ball energy. It may not grow from step to step.
@pytest.mark.filterwarnings("ignore:.*rad a step:voxshell.AccuracyWarning")
@pytest.mark.parametrize("room", ["box", "can"])
def test_rough_elastic_bodies_do_not_gain_energy_without_end(room):
    for seed in range(3):
        world, body = throw("ball", room, 1, 4, 30, seed)
        world.step(60)
        assert np.linalg.norm(body.linear_velocity) < 1.3 * 4


def slide_across(kind, room, height, rate, speed, number):
    world = vx.World(1 / rate)
    world.add(build_room(room), motion="static")
    start = (0.01 * math.cos(7 * number), 0.02 * math.sin(3 * number), height - HALF)
    body = world.add(build_shape(kind), mass=MASS, pose=start, friction=0)
    way = 2.4 * number + 0.1
    body.linear_velocity = (speed * math.cos(way), speed * math.sin(way), 0)
    return world, body


# Spheres that touched the floor saw no wall that they did not face at the start of the step: 19 of 20 left the can.
@pytest.mark.parametrize(("rate", "speed"), [(200, 10), (60, 2), (60, 4), (60, 6)])
@pytest.mark.parametrize(
    ("kind", "height"), [("vx.Sphere", 0.015), ("vx.Capsule", 0.022), ("ball", 0.015)]
)
@pytest.mark.parametrize("room", ["box", "can"])
def test_what_slides_across_the_floor_of_a_bin_stays_in_it(room, kind, height, rate, speed):
    for throw_number in range(10):
        world, body = slide_across(kind, room, height, rate, speed, throw_number)
        for _ in range(10):
            world.step()
            assert np.abs(body.position).max() < HALF


# Where their lower corners and rims touched the floor, the upper ones met the wall alone. Of 20, up to 3 left, and 13 were
# deep in a wall.
@pytest.mark.parametrize(("rate", "speed"), [(200, 10), (200, 2), (60, 2), (60, 4)])
@pytest.mark.parametrize(
    ("kind", "height", "most_deep"),
    [("vx.Cylinder", 0.015, 1), ("vx.Cone", 0.015, 3), ("vx.Box", 0.0125, 0)],
)
@pytest.mark.filterwarnings("ignore:.*rad a step:voxshell.AccuracyWarning")
def test_what_slides_on_a_rim_meets_the_wall_with_it(kind, height, rate, speed, most_deep):
    deep = 0
    for throw_number in range(10):
        world, body = slide_across(kind, "box", height, rate, speed, throw_number)
        deepest = 0.0
        for _ in range(10):
            world.step()
            assert np.abs(body.position).max() < HALF
            deepest = max([deepest, *world.contacts()["depth"]])
        deep += deepest > 1e-3
    assert deep <= most_deep


@pytest.mark.filterwarnings("ignore:.*rad a step:voxshell.AccuracyWarning")
def test_a_state_saved_between_rebounds_goes_on_in_the_same_way():
    world, body = throw("ball", "box", 0.9, 6, 60, 1)
    world.step(2)
    state = world.save_state()
    poses = []
    for _ in range(2):
        world.step(4)
        poses.append(body.pose.copy())
        world.restore_state(state)
    assert (poses[0] == poses[1]).all()


@pytest.mark.filterwarnings("ignore:.*rad a step:voxshell.AccuracyWarning")
def test_bodies_can_be_removed_between_rebounds():
    world, body = throw("ball", "box", 0, 6, 60, 1)
    other = world.add(build_shape("block"), mass=MASS, pose=(0.03, 0, 0))
    world.step()
    count = len(world.contacts())
    world.remove(body)
    assert len(world.contacts()) < count
    world.step()
    assert np.isfinite(other.position).all()
