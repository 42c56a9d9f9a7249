"""Properties of bodies that may change between steps: damping, friction, restitution, groups."""

from __future__ import annotations

import numpy as np
import pytest
import voxshell as vx
from poses import at


def test_damping_is_the_fraction_lost_in_a_second():
    world = vx.World(gravity=(0, 0, 0), sleeping=False)
    body = world.add(vx.Sphere(0.1), linear_damping=0.3)
    body.angular_damping = 0.6
    body.linear_velocity, body.angular_velocity = (1, 0, 0), (0, 1, 0)
    world.step(200)
    assert body.linear_velocity[0] == pytest.approx(0.7, rel=1e-6)
    assert body.angular_velocity[1] == pytest.approx(0.4, rel=1e-6)


def test_friction_and_restitution_can_be_set_at_any_time(brick):
    world = vx.World()
    ground = world.add(vx.Plane(), mass=0, friction=1.0, restitution=1.0)
    body = world.add(brick, pose=at(z=0.0301), friction=0.0)
    body.linear_velocity = (1, 0, 0)
    world.step(50)
    assert body.linear_velocity[0] == pytest.approx(1.0, rel=1e-3)
    body.friction = 0.5
    world.step(50)
    assert body.linear_velocity[0] < 0.1
    assert (ground.friction, body.friction, body.restitution) == (1.0, 0.5, 0.0)


@pytest.mark.parametrize("on", ["ball", "ground"])
def test_rolling_friction_stops_a_ball_at_the_rate_that_its_lever_says(on):
    radius, lever, friction = 0.1, 0.002, 0.5
    world = vx.World()
    ground = world.add(vx.Plane(), mass=0, friction=friction)
    ball = world.add(vx.Sphere(radius), pose=at(z=radius), friction=friction)
    {"ball": ball, "ground": ground}[on].rolling_friction = lever
    ball.linear_velocity, ball.angular_velocity = (0.2, 0, 0), (0, 0.2 / radius, 0)
    world.step(200)
    # The torque lever * friction * m g slows a solid ball, whose inertia about its lowest point is 7/5 m r^2.
    slowed = lever * friction * 9.81 / (1.4 * radius)
    assert ball.linear_velocity[0] == pytest.approx(0.2 - slowed, rel=0.02)
    world.step(600)
    assert ball.linear_velocity[0] == pytest.approx(0.0, abs=1e-6)


def test_spinning_friction_stops_a_ball_at_the_rate_that_its_lever_says():
    radius, lever, friction = 0.1, 0.002, 0.5
    world = vx.World()
    world.add(vx.Plane(), mass=0, friction=friction)
    ball = world.add(
        vx.Sphere(radius),
        pose=at(z=radius),
        friction=friction,
        rolling_friction=lever,
        spinning_friction=lever,
    )
    ball.angular_velocity = (0, 0, 2.0)
    world.step(50)
    # The torque lever * friction * m g slows a solid ball, whose inertia is 2/5 m r^2.
    slowed = 0.25 * lever * friction * 9.81 / (0.4 * radius**2)
    assert ball.angular_velocity[2] == pytest.approx(2.0 - slowed, rel=0.02)
    world.step(200)
    np.testing.assert_allclose(ball.angular_velocity, 0.0, atol=1e-6)
    ball.spinning_friction = 0.0
    ball.angular_velocity = (0, 0, 2.0)
    world.step(50)
    assert (ball.rolling_friction, ball.spinning_friction) == (lever, 0.0)
    assert ball.angular_velocity[2] == pytest.approx(2.0, rel=1e-3)


@pytest.mark.parametrize("apart", ["pair", "groups", "later", "pair from the start"])
def test_bodies_set_apart_pass_through(brick, apart):
    world = vx.World()
    ground = world.add(vx.Plane(), mass=0)
    table = world.add(brick, mass=0, pose=at(z=0.5))
    body = world.add(brick, pose=at(z=0.561), group=2 if apart == "groups" else 1)
    if apart == "groups":
        table.mask = 1
    if apart == "pair from the start":
        world.set_collision(body, table, False)
    world.step(100)
    if apart == "pair":
        assert body.pose[2, 3] > 0.55
        world.set_collision(table, body, False)
    if apart == "later":
        body.group, table.mask = 4, 3
    world.step(300)
    assert body.pose[2, 3] == pytest.approx(0.03, abs=1e-3)
    world.set_collision(ground, body, False)
    world.set_collision(ground, body, True)
    world.step(200)
    assert body.pose[2, 3] == pytest.approx(0.03, abs=1e-3)
