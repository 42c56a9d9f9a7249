"""Bodies on joints that rebound, several times within a step, too."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx

BALL, ARM = 0.02, 0.3  # m
RATES = (200.0, 60.0, 30.0)


def make_cradle(count, *, rate, gap, angle, mass=0.1):
    """Balls on hinges, the first of which is raised, and what their energy is."""
    world = vx.World(time_step=1.0 / rate)
    shape = trimesh.creation.icosphere(4, BALL)
    balls = []
    for i in range(count):
        x, a = i * (2 * BALL + gap), angle if i == 0 else 0.0
        pose = (x - ARM * np.sin(a), 0, -ARM * np.cos(a))
        balls.append(world.add(shape, mass=mass, pose=pose, restitution=1, friction=0))
        pin = vx.pose((x, 0, 0))
        world.add_joint(vx.HingeJoint((0, 1, 0)), None, balls[-1], world_from_joint=pin)
    return (
        world,
        balls,
        lambda: sum(b.kinetic_energy + mass * 9.81 * (b.position[2] + ARM) for b in balls),
    )


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("count", [3, 5])
def test_a_cradle_on_hinges_passes_its_blow_on_and_gains_no_energy(rate, count):
    # What semi-implicit steps of a pendulum take and give back.
    wobble = 0.5 / rate * np.sqrt(9.81 / ARM)
    for gap, angle in ((0.0003, 0.3), (0.001, 0.5), (0.002, 0.7)):
        world, balls, energy = make_cradle(count, rate=rate, gap=gap, angle=angle)
        first = energy()
        energies, heights = [], []
        for _ in range(round(2 * rate)):
            world.step()
            energies.append(energy())
            heights.append(balls[-1].position[2] + ARM)
        assert max(energies) <= (1.002 + wobble) * first, (gap, angle)
        if rate >= 60.0:
            assert max(heights) >= 0.98 * ARM * (1 - np.cos(angle)), (gap, angle)


@pytest.mark.parametrize("rate", RATES)
def test_reactions_of_joints_are_those_of_all_blows_of_a_step(rate):
    world, balls, _ = make_cradle(5, rate=rate, gap=0.001, angle=0.5)
    joints = world.joints
    blows = 0.0
    for _ in range(round(2 * rate)):
        before = [ball.linear_velocity for ball in balls]
        world.step()
        contacts = world.contacts()
        for ball, joint, velocity in zip(balls, joints, before, strict=True):
            given = (joint.reaction.force + 0.1 * np.array(world.gravity)) / rate
            for contact in contacts:
                side = (contact["body_a"] == ball.number) - (contact["body_b"] == ball.number) * 1.0
                given = given + side * contact["impulse"] * contact["normal"]
                blows += contact["impulse"]
            change = 0.1 * (ball.linear_velocity - velocity)
            np.testing.assert_allclose(change, given, atol=1e-6)
    assert blows > 0.1


@pytest.mark.parametrize("e", [0.5, 0.8])
@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize(
    "joint", [vx.HingeJoint((0, 1, 0)), vx.PointJoint()], ids=["hinge", "point"]
)
def test_a_chain_that_falls_on_a_slab_gains_no_energy(joint, rate, e):
    for seed in range(2):
        world = vx.World(time_step=1.0 / rate)
        world.add(trimesh.creation.box((5, 5, 0.2)), mass=0, pose=(0, 0, -0.1), restitution=1)
        tilt = np.random.default_rng(seed).uniform(-0.6, 0.6, 3)
        at = vx.pose((0, 0, 0.6), euler=tuple(tilt))
        shape = trimesh.creation.box((0.09, 0.03, 0.03))
        links = []
        for x in np.arange(-0.2, 0.21, 0.1):
            links.append(world.add(shape, mass=0.1, pose=at @ vx.pose((x, 0, 0)), restitution=e))
            if len(links) > 1:
                pin = at @ vx.pose((x - 0.05, 0, 0))
                world.add_joint(joint, links[-2], links[-1], world_from_joint=pin)

        def energy(links=links):
            return sum(b.kinetic_energy + 0.1 * 9.81 * b.center_of_mass[2] for b in links)

        first = energy()
        energies = []
        world.step(round(1.5 * rate), lambda _, seen=energies, energy=energy: seen.append(energy()))
        assert max(energies) <= 1.02 * first, seed


@pytest.mark.parametrize(("length", "angle"), [(0.1, 0.5), (0.25, 1.0), (0.6, 0.7), (1.8, 0.9)])
@pytest.mark.parametrize("is_model", [True, False])
def test_a_flap_on_a_hinge_rebounds_as_high_as_its_restitution_says(is_model, length, angle):
    e, thick = 0.6, 0.04 * length
    world = vx.World(time_step=1e-3)
    slab = trimesh.creation.box((3 * length, 3 * length, 0.2 * length))
    world.add(slab, mass=0, pose=(0, 0, -0.1 * length), restitution=1)
    size = np.array((length, 0.6 * length, thick))
    shape = trimesh.creation.box(size) if is_model else vx.Box(size / 2)
    above = thick / 2 + 1e-4 * length
    start = vx.pose((0, 0, above), euler=(0, -angle, 0)) @ vx.pose((0.55 * length, 0, 0))
    flap = world.add(shape, mass=1, pose=start, restitution=e)
    pin = vx.pose((0, 0, above))
    world.add_joint(vx.HingeJoint((0, -1, 0)), None, flap, world_from_joint=pin)
    heights = []
    world.step(
        round(2000 * np.sqrt(length)), lambda _: heights.append(flap.position[2] - thick / 2)
    )
    rises = np.diff(heights) > 0
    first = int(np.argmax(rises))
    top = heights[first + int(np.argmin(rises[first:]))]
    assert top == pytest.approx(e * e * 0.55 * length * np.sin(angle), rel=0.02)


@pytest.mark.parametrize("rate", RATES)
def test_a_brake_takes_no_more_than_its_force_from_what_rebounds_many_times_a_step(rate):
    world = vx.World(time_step=1.0 / rate, gravity=(0, 0, 0))
    for x in (-0.06, 0.06):
        world.add(trimesh.creation.box((0.05, 0.2, 0.2)), mass=0, pose=(x, 0, 0), restitution=1)
    cart = world.add(trimesh.creation.box((0.05, 0.05, 0.05)), mass=1, restitution=1, friction=0)
    joint = world.add_joint(vx.SliderJoint((1, 0, 0)), None, cart)
    joint.set_target_velocity(0, max_force=2.0)
    cart.linear_velocity = (5, 0, 0)
    steps = round(0.5 * rate)
    world.step(steps)
    assert abs(cart.linear_velocity[0]) >= 5 - 2.0 * 0.5 - 0.01
    assert abs(cart.position[0]) < 0.0101


# Places of the ball a little later than the first rebounded with it, up to 7 mm off its axis: cubes turned by up to
# 1.4 rad/s.
@pytest.mark.parametrize("e", [0.3, 1.0])
@pytest.mark.parametrize("rate", [1000.0, 200.0, 60.0])
def test_a_mallet_does_not_turn_what_it_strikes_in_the_middle(rate, e):
    arm, radius, speed = 0.8, 0.06, 2.5
    head = trimesh.creation.icosphere(4, radius)
    stick = trimesh.creation.box((0.02, 0.02, arm)).apply_translation((0, 0, arm / 2))
    mallet = trimesh.boolean.union([head, stick], engine="manifold")
    for seed in range(3):
        rng = np.random.default_rng(seed)
        world = vx.World(time_step=1.0 / rate, gravity=(0, 0, 0))
        yaw = vx.pose(euler=(0, 0, rng.uniform(0, 2 * np.pi)))
        pivot = vx.pose((0, 0, arm))
        raised = vx.pose(euler=(0, rng.uniform(0.07, 0.2), 0))
        hammer = world.add(
            mallet, mass=3, restitution=1, pose=yaw @ pivot @ raised @ vx.pose((0, 0, -arm))
        )
        axis = yaw[:3, 1]
        world.add_joint(vx.HingeJoint(tuple(axis)), None, hammer, world_from_joint=pivot)
        hammer.angular_velocity = -speed / arm * axis
        hammer.linear_velocity = np.cross(
            hammer.angular_velocity, hammer.center_of_mass - pivot[:3, 3]
        )
        cube = world.add(
            trimesh.creation.box((0.1, 0.1, 0.2)),
            mass=2,
            restitution=e,
            pose=yaw @ vx.pose((radius + 0.05, 0, 0)),
        )
        world.step(round(0.15 * rate))
        assert np.linalg.norm(cube.linear_velocity) > 0.6 * speed
        assert abs(cube.angular_velocity[2]) < 0.1
