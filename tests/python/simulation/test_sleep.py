"""Which bodies sleep, and what wakes them."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
import voxshell as vx

RATES = [1000, 200, 60, 30]


def build_world(rate: int = 200) -> vx.World:
    return vx.World(time_step=1.0 / rate)


def put_to_sleep(world: vx.World, *bodies: vx.Body) -> None:
    for _ in range(20):
        world.step(round(0.5 / world.time_step))
        if all(body.sleeping for body in bodies):
            return
    pytest.fail("the bodies do not fall asleep")


@pytest.mark.parametrize("rate", RATES)
def test_a_body_that_slides_without_friction_goes_on(rate):
    """Bullet put it to sleep after two seconds below 0.8 m/s."""
    world = build_world(rate)
    world.add(vx.Plane(), mass=0, friction=0)
    body = world.add(vx.Box((0.05, 0.05, 0.05)), mass=1, pose=(0, 0, 0.05), friction=0)
    body.linear_velocity = (0.3, 0, 0)
    world.step(5 * rate)
    assert not body.sleeping
    assert body.position[0] == pytest.approx(1.5, rel=0.01)


def test_a_pendulum_does_not_stop_at_its_turning_point():
    world = build_world()
    bob = world.add(vx.Sphere(0.05), mass=1, pose=(5 * math.sin(0.087), 0, -5 * math.cos(0.087)))
    world.add_joint(vx.HingeJoint(axis=(0, 1, 0)), None, bob, world_from_joint=np.eye(4))
    farthest = 0.0
    for _ in range(10):
        world.step(200)
        assert not bob.sleeping
        farthest = min(farthest, bob.position[0])
    assert farthest < -0.3


@pytest.mark.parametrize("rate", RATES)
def test_a_sleeper_whose_support_is_knocked_away_falls_to_the_ground(rate):
    """It woke with its support, and slept again in midair as soon as that had left."""
    world = build_world(rate)
    world.add(vx.Plane(), mass=0)
    box = vx.Box((0.05, 0.05, 0.05))
    lower = world.add(box, mass=1, pose=(0, 0, 0.05))
    upper = world.add(box, mass=1, pose=(0, 0, 0.15))
    put_to_sleep(world, lower, upper)
    lower.linear_velocity = (8.0, 0, 0)
    world.step(2 * rate)
    assert lower.position[0] > 0.5
    assert upper.position[2] == pytest.approx(0.05, abs=2e-3)


def change_pose(world: vx.World, support: vx.Body) -> None:
    support.pose = (0, 0, -1.05)


def change_tilt(world: vx.World, support: vx.Body) -> None:
    support.pose = vx.pose((0, 0, -0.1), euler=(0, 0.5, 0))


def change_mask(world: vx.World, support: vx.Body) -> None:
    support.mask = 0


def change_group(world: vx.World, support: vx.Body) -> None:
    support.group = 0


@pytest.mark.parametrize("change", [change_pose, change_tilt, change_mask, change_group])
def test_changing_what_carries_a_sleeper_wakes_it(change):
    world = build_world()
    support = world.add(vx.Box((0.5, 0.5, 0.05)), mass=0, pose=(0, 0, -0.05))
    body = world.add(vx.Box((0.05, 0.05, 0.05)), mass=1, pose=(0, 0, 0.05))
    put_to_sleep(world, body)
    change(world, support)
    assert not body.sleeping
    world.step(100)
    assert body.position[2] < 0.03


@pytest.mark.parametrize("joint", [vx.FixedJoint(), vx.PointJoint()])
def test_a_sleeper_follows_the_kinematic_body_that_it_is_joined_to(joint):
    world = build_world()
    base = world.add(vx.Box((0.1, 0.1, 0.1)), motion="kinematic", pose=(0, 0, 1))
    arm = world.add(vx.Box((0.05, 0.05, 0.05)), mass=1, pose=(0, 0, 0.8))
    world.add_joint(joint, base, arm, world_from_joint=vx.pose((0, 0, 0.9)))
    put_to_sleep(world, arm)
    for step in range(200):
        base.position = (0.001 * step, 0, 1)
        world.step()
    assert arm.position[0] == pytest.approx(0.2, abs=0.02)


def test_taking_the_friction_from_a_slope_lets_a_sleeper_slide():
    world = build_world()
    slope = world.add(vx.Plane((-math.sin(0.3), 0, math.cos(0.3))), mass=0)
    start = vx.pose((-0.05 * math.sin(0.3), 0, 0.05 * math.cos(0.3)), euler=(0, -0.3, 0))
    body = world.add(vx.Box((0.05, 0.05, 0.05)), mass=1, pose=start, friction=1)
    put_to_sleep(world, body)
    slope.friction = 0
    before = body.position
    world.step(100)
    moved = math.dist(before, body.position)
    assert moved == pytest.approx(0.5 * 9.81 * math.sin(0.3) * 0.25, rel=0.05)


@pytest.mark.parametrize("micrometers", [1, 5, 50])
def test_a_body_stays_where_it_is_put(micrometers):
    """Friction remembered where it lay, and pulled it back by up to some micrometers."""
    world = build_world()
    world.add(vx.Model.from_mesh(trimesh.creation.box((1, 1, 0.1))), mass=0, pose=(0, 0, -0.05))
    cube = vx.Model.from_mesh(trimesh.creation.box((0.1, 0.1, 0.1)))
    body = world.add(cube, mass=1, pose=(0, 0, 0.05))
    world.step(100)
    goal = body.position[0] + 1e-6 * micrometers
    body.position = (goal, *body.position[1:])
    world.step(100)
    assert body.position[0] == pytest.approx(goal, abs=2e-7)


@pytest.mark.parametrize("ground", ["plane", "slab"])
def test_a_sleeper_weighs_what_it_weighed(ground):
    """Its contacts had 1.18 times the force."""
    world = vx.World()
    if ground == "plane":
        world.add(vx.Plane(), mass=0)
    else:
        world.add(trimesh.creation.box((0.5, 0.5, 0.1)), mass=0, pose=(0, 0, -0.05))
    bodies = [
        world.add(trimesh.creation.box((0.1, 0.1, 0.1)), mass=1, pose=(0, 0, 0.05 + 0.1 * i))
        for i in range(2)
    ]
    world.step(700)
    assert all(body.sleeping for body in bodies)
    forces = world.contacts()["impulse"] / world.time_step
    assert forces.sum() == pytest.approx(3 * 9.81, rel=1e-3)
