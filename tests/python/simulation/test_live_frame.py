"""What is read of a world for its view: forces and energies."""

from __future__ import annotations

import pytest
import voxshell as vx
from live_worlds import make_world, read_frame
from voxshell.simulation.live_frame import take_frame


def test_forces_on_a_resting_body_carry_it_whichever_body_of_the_pair_it_is():
    for ground_first in (True, False):
        world = vx.World(sleeping=False)
        add_ground = lambda world=world: world.add(vx.Box((1, 1, 0.1)), mass=0, pose=(0, 0, -0.1))  # noqa: E731
        if ground_first:
            add_ground()
        world.add(vx.Box((0.1, 0.1, 0.1)), mass=3.0, pose=(0, 0, 0.1))
        if not ground_first:
            add_ground()
        world.step(400)
        assert read_frame(world).forces.sum(axis=0) == pytest.approx((0, 0, 3.0 * 9.81), abs=0.3)


def test_the_energy_of_a_tumbling_fall_is_kept():
    world = vx.World(time_step=1 / 1000)
    box = world.add(vx.Box((0.1, 0.2, 0.3)), mass=2.0)
    box.angular_velocity = (3.0, 1.0, 0.2)
    box.linear_velocity = (1.0, 0.0, 2.0)
    before = read_frame(world)
    world.step(300)
    after = read_frame(world)
    assert abs(after.potential - before.potential) > 1.0
    assert after.kinetic + after.potential == pytest.approx(
        before.kinetic + before.potential,
        abs=0.04,  # steps of a fall lose m g^2 t dt / 2
    )


def test_bodies_that_are_not_dynamic_have_no_energy():
    world = vx.World()
    world.add(vx.Sphere(0.1), mass=0, pose=(0, 0, 2))
    mover = world.add(vx.Sphere(0.1), motion="kinematic", pose=(0, 0, 4))
    mover.pose = (0.01, 0, 4)
    world.step()
    frame = read_frame(world)
    assert (frame.kinetic, frame.potential) == (0.0, 0.0)
    world.add(vx.Sphere(0.1), mass=2.0, pose=(0, 0, 3)).linear_velocity = (0.0, 4.0, 0.0)
    frame = read_frame(world)
    assert frame.kinetic == pytest.approx(16.0)
    assert frame.potential == pytest.approx(2.0 * 9.81 * 3.0)


def test_a_removed_body_is_left_out():
    world, bodies = make_world()
    world.remove(bodies[0])
    frame = read_frame(world)
    assert bodies[0] not in frame.bodies
    assert frame.poses[1] == pytest.approx(bodies[1].pose)


def test_a_body_that_another_thread_removes_while_a_frame_is_read_gives_no_frame():
    world, bodies = make_world()

    class Racing(list):
        def __iter__(self):
            """Lists all bodies, and then one is gone."""
            yield from list.__iter__(self)
            world.remove(bodies[1])

    listed = Racing(world.bodies)
    assert take_frame(world._simulation, listed, world.gravity, world.time_step) is None
