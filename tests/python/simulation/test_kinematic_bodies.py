"""Kinematic bodies carry and hit what is in their way as their motion says."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import trimesh
import voxshell as vx
from poses import at


@cache
def make_box(*extents: float) -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.box(extents))


@pytest.mark.parametrize("plate", ["box", "model"])
def test_kinematic_body_takes_along_what_lies_on_it(brick, plate):
    slab = vx.Box((0.5, 0.5, 0.03))
    if plate == "model":
        slab = vx.Model.from_mesh(trimesh.creation.box(extents=(1, 1, 0.06)), voxel_size=0.01)
    world = vx.World()
    carrier = world.add(slab, motion="kinematic", pose=at(z=-0.03))
    parcel = world.add(brick, pose=at(z=0.031), friction=1.0)
    world.step(50)

    def push(world):
        carrier.pose = carrier.pose @ at(x=0.4 * world.time_step)

    world.step(300, before=push)
    np.testing.assert_allclose(carrier.linear_velocity, (0.4, 0, 0), atol=1e-9)
    np.testing.assert_allclose(parcel.linear_velocity, (0.4, 0, 0), atol=5e-3)
    assert parcel.pose[2, 3] == pytest.approx(0.03, abs=1e-3)
    world.step(2)
    np.testing.assert_allclose(carrier.linear_velocity, 0.0)


@pytest.mark.parametrize("rate", [120, 100, 60])
@pytest.mark.parametrize(("size", "tray"), [(0.1, 0.01), (0.1, 0.002), (0.005, 0.002)])
def test_cargo_stays_on_a_tray_that_starts_to_rise(rate, size, tray):
    """It closes on the cargo by more than the rest margin a step, and by less than CCD begins at."""
    for cargo in (vx.Box((size / 2, size / 2, size / 2)), make_box(size, size, size)):
        world = vx.World(time_step=1 / rate)
        slab = make_box(4 * size, 4 * size, tray)
        lift = world.add(slab, motion="kinematic", pose=at(z=-tray / 2))
        body = world.add(cargo, pose=at(z=size / 2))
        world.step(rate // 5)
        for step in range(1, 2 * rate):
            height = 0.05 * (1 - np.cos(2 * np.pi * step / rate))
            lift.pose = at(z=height - tray / 2)
            world.step()
            assert body.position[2] == pytest.approx(height + size / 2, abs=5e-5)


@pytest.mark.parametrize("rate", [1000, 200, 60, 30])
def test_cargo_stays_on_a_lift_that_goes_up_and_down(rate):
    world = vx.World(time_step=1 / rate)
    cube = make_box(0.1, 0.1, 0.1)
    slab = make_box(1.0, 1.0, 0.1)
    lift = world.add(slab, motion="kinematic", pose=at(z=-0.05))
    cargo = world.add(cube, pose=at(z=0.05))
    for step in range(1, 2 * rate):
        height = 0.2 * np.sin(5.0 * step / rate)  # falls with half of gravity at most
        lift.pose = at(z=height - 0.05)
        world.step()
        assert cargo.position[2] == pytest.approx(height + 0.05, abs=1e-4)


@cache
def make_disk() -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.cylinder(radius=0.5, height=0.1, sections=64))


def ride_a_turntable(rate, fraction, drive):
    """The distance of cargo from the axis after 6 s; it begins at 0.3 m.

    The turntable comes to that fraction of the spin at which the cargo slides.
    """
    friction = 0.1
    spin = fraction * np.sqrt(friction * 9.81 / 0.3)
    world = vx.World(time_step=1 / rate)
    motion = "kinematic" if drive == "pose" else "dynamic"
    table = world.add(make_disk(), motion=motion, mass=5.0, pose=at(z=-0.05), friction=1.0)
    cargo = world.add(
        make_box(0.06, 0.06, 0.02), mass=0.5, pose=at(x=0.3, z=0.01), friction=friction
    )
    axle = world.add_joint(vx.HingeJoint(axis=(0, 0, 1)), None, table) if drive == "motor" else None
    angle = 0.0
    for step in range(1, 6 * rate + 1):
        now = spin * min(step / rate / 3, 1)
        angle += now / rate
        if axle is None:
            table.pose = vx.pose((0, 0, -0.05), axis_angle=((0, 0, 1), angle))
        else:
            axle.set_target_velocity(now, max_force=1e3)
        world.step()
    return np.hypot(*cargo.position[:2])


@pytest.mark.parametrize("drive", ["pose", "motor"])
@pytest.mark.parametrize("rate", [1000, 200, 60, 30])
def test_cargo_stays_on_a_turntable_up_to_the_spin_at_which_it_slides(rate, drive):
    within = 1e-5 if rate >= 200 else 1e-3
    for fraction in (0.4, 0.95):
        assert ride_a_turntable(rate, fraction, drive) == pytest.approx(0.3, abs=within)
    assert ride_a_turntable(rate, 1.05, drive) > 0.4


@pytest.mark.parametrize("rate", [1000, 200, 60, 30])
def test_a_ball_goes_round_on_a_turntable_at_two_sevenths_of_its_spin(rate):
    """A solid ball that rolls; its circle may have any center (Burns 1981)."""
    spin, distance, radius = 4.0, 0.3, 0.03
    speed = 2 / 7 * spin * distance
    world = vx.World(time_step=1 / rate)
    table = world.add(vx.Box((1, 1, 0.05)), motion="kinematic", pose=at(z=-0.05), friction=1.0)
    ball = world.add(vx.Sphere(radius), mass=0.1, pose=at(x=distance, z=radius), friction=1.0)
    ball.linear_velocity = (0, speed, 0)
    ball.angular_velocity = ((spin * distance - speed) / radius, 0, 0)
    path = [ball.position[:2]]
    for step in range(1, 5 * rate + 1):
        table.pose = vx.pose((0, 0, -0.05), axis_angle=((0, 0, 1), spin * step / rate))
        world.step()
        path.append(ball.position[:2])
    x, y = np.array(path).T
    assert np.unwrap(np.arctan2(y, x))[-1] == pytest.approx(5 * 2 / 7 * spin, rel=1e-3)
    np.testing.assert_allclose(np.hypot(x, y), distance, atol=2e-4)


@cache
def make_ball() -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.icosphere(4, radius=0.03))


@pytest.mark.parametrize("rate", [1000, 200, 60, 30])
@pytest.mark.parametrize("speed", [1.0, 20.0])
def test_a_kinematic_paddle_hits_what_it_moves_across(rate, speed):
    world = vx.World(gravity=(0, 0, 0), time_step=1 / rate)
    paddle = world.add(make_box(0.02, 0.3, 0.3), motion="kinematic", pose=at(x=-0.1))
    ball = world.add(make_ball())
    for step in range(1, rate // 4):
        paddle.pose = at(x=-0.1 + speed * step / rate)
        world.step()
    np.testing.assert_allclose(ball.linear_velocity, (speed, 0, 0), atol=1e-3 * speed)


@pytest.mark.parametrize("is_new", [True, False])
def test_a_placed_kinematic_body_hits_nothing_in_between(is_new):
    world = vx.World(gravity=(0, 0, 0))
    ball = world.add(vx.Sphere(0.05))
    board = world.add(vx.Box((0.01, 0.2, 0.2)), motion="kinematic", pose=at(x=-0.3))
    if not is_new:
        board.pose = at(x=-0.2)
        world.step()
    board.place(at(x=0.3))
    np.testing.assert_array_equal(board.position, (0.3, 0, 0))
    world.step(2)
    np.testing.assert_array_equal(board.position, (0.3, 0, 0))
    np.testing.assert_array_equal(board.linear_velocity, 0.0)
    np.testing.assert_array_equal(ball.linear_velocity, 0.0)
    for step in range(30):  # moves again, at 2 m/s
        board.pose = at(x=0.29 - 0.01 * step)
        world.step()
    assert ball.linear_velocity[0] == pytest.approx(-2.0, abs=0.01)


def test_kinematic_velocity_is_of_the_last_pose_set(brick):
    world = vx.World()
    body = world.add(brick, motion="kinematic")
    body.pose = at(x=5.0)
    body.pose = at(x=0.01)
    world.step()
    np.testing.assert_allclose(body.linear_velocity, (0.01 * 200.0, 0, 0), atol=1e-9)
    turned = trimesh.transformations.rotation_matrix(0.01, (0, 0, 1)) @ at(x=0.01)
    body.pose = turned
    world.step()
    np.testing.assert_allclose(body.angular_velocity, (0, 0, 2.0), atol=1e-6)
    assert body.mass == 0.0
