"""Free rotation beside its closed forms, at default settings."""

from __future__ import annotations

import math
import warnings

import numpy as np
import pytest
import trimesh
import voxshell as vx


@pytest.fixture(scope="module")
def plate():
    """A box of three different sides, the inertia of 1 kg along its axes."""
    return vx.Model.from_mesh(trimesh.creation.box((0.1, 0.06, 0.02)), voxel_size=0.004)


def energy_and_momentum(body, inertia):
    """J, and kg m2/s in the world frame."""
    rotation = body.pose[:3, :3]
    turn = rotation.T @ body.angular_velocity
    return 0.5 * turn @ inertia @ turn, rotation @ inertia @ turn


@pytest.mark.parametrize("rate", [1000, 200, 60])
def test_a_tumbling_body_keeps_energy_and_momentum(plate, rate):
    """With Bullet's implicit gyroscopic term 56, 14 and 4 % of the energy were left."""
    world = vx.World(gravity=(0, 0, 0), time_step=1.0 / rate)
    body = world.add(plate)
    spin = 0.15 * rate  # up to 0.2 radians a step
    body.angular_velocity = (0.1 * spin, spin, 0.2 * spin)
    inertia = plate.mass_properties(1.0).inertia
    energy, momentum = energy_and_momentum(body, inertia)
    world.step(30 * rate)
    energy_at_end, momentum_at_end = energy_and_momentum(body, inertia)
    assert energy_at_end == pytest.approx(energy, rel=1e-8)
    assert np.allclose(momentum_at_end, momentum, rtol=0.0, atol=1e-8 * np.linalg.norm(momentum))


def test_attitude_does_not_depend_on_the_step(plate):
    def attitude(rate):
        world = vx.World(gravity=(0, 0, 0), time_step=1.0 / rate)
        body = world.add(plate)
        body.angular_velocity = (1.0, 12.0, 2.0)
        world.step(30 * rate)
        return body.pose[:3, :3]

    turned = attitude(1000).T @ attitude(60)
    assert math.degrees(np.arccos(min(0.5 * (np.trace(turned) - 1.0), 1.0))) < 0.01


def test_a_heavy_top_precesses_as_fast_as_the_closed_form_says():
    """The slow one of the two steady rates, of a disc on a point that spins at 200 rad/s."""
    arm, mass, spin, tilt = 0.05, 0.2, 200.0, 0.3
    disc = vx.Model.from_mesh(trimesh.creation.cylinder(0.04, 0.01, sections=64), voxel_size=0.002)
    inertia = disc.mass_properties(mass).inertia
    along, across = inertia[2, 2], inertia[0, 0] + mass * arm**2
    half = 0.5 * along * spin / ((across - along) * math.cos(tilt))
    rate = half - math.sqrt(half**2 - mass * 9.81 * arm / ((across - along) * math.cos(tilt)))
    pose = trimesh.transformations.rotation_matrix(tilt, (0, 1, 0))
    axis = pose[:3, 2].copy()
    pose[:3, 3] = arm * axis
    world = vx.World(time_step=0.001, sleeping=False)
    top = world.add(disc, mass=mass, pose=pose)
    foot = np.eye(4)
    foot[2, 3] = -arm
    world.add_joint(vx.PointJoint(), None, top, child_from_joint=foot)
    turn = np.array([0, 0, rate]) + (spin - rate * math.cos(tilt)) * axis
    top.angular_velocity = turn
    top.linear_velocity = np.cross(turn, arm * axis)
    angles = []
    world.step(1000, lambda _: angles.append(math.atan2(top.pose[1, 2], top.pose[0, 2])))
    assert np.unwrap(angles)[-1] == pytest.approx(rate, rel=0.03)
    assert math.acos(top.pose[2, 2]) == pytest.approx(tilt, abs=0.02)


def test_a_body_that_turns_by_more_than_an_eighth_of_a_turn_a_step_is_named_once(plate):
    world = vx.World(gravity=(0, 0, 0), time_step=0.01)
    body = world.add(plate, name="rotor")
    body.angular_velocity = (0.0, 0.0, 70.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        world.step(5)
    body.angular_velocity = (0.0, 0.0, 100.0)
    with pytest.warns(vx.AccuracyWarning, match=r"'rotor' turns by 1 rad a step.*0\.785 rad"):
        world.step(5)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        world.step(5)
    assert body.angular_velocity[2] == pytest.approx(100.0)


def test_bodies_that_turn_fast_from_one_step_on_share_a_warning(plate):
    world = vx.World(gravity=(0, 0, 0), time_step=0.01)
    for i in range(5):
        body = world.add(plate, name=f"rotor {i}", pose=(30.0 * i, 0, 0))
        body.angular_velocity = (0.0, 0.0, 100.0 + 10.0 * i)
    with pytest.warns(
        vx.AccuracyWarning, match=r"'rotor 4' and 4 others turn by up to 1\.4 rad"
    ) as all_of:
        world.step(5)
    assert sum("rad a step" in str(each.message) for each in all_of) == 1
