"""Springs and armatures of joints, beside closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
import voxshell as vx

RATES = (1000.0, 200.0, 60.0, 30.0)


def make_spring(stiffness: float, *, rate: float, damping: float = 0.0, **settings):
    """1 kg on a spring that is relaxed at 0.1 m, released at 0."""
    world = vx.World(time_step=1.0 / rate, **{"gravity": (0, 0, 0), **settings})
    body = world.add(vx.Box((0.1, 0.1, 0.1)), mass=1.0)
    spring = vx.SliderJoint((1, 0, 0), stiffness=stiffness, damping=damping, spring_position=0.1)
    return world, world.add_joint(spring, None, body)


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("phase", [0.02, 0.1, 0.5, 1.0])
@pytest.mark.parametrize("solver", ["coulomb", "sequential_impulse"])
def test_oscillations_keep_their_period_and_their_amplitude(rate, phase, solver):
    world, joint = make_spring((phase * rate) ** 2, rate=rate, solver=solver)
    positions = []
    world.step(round(20 * 2 * math.pi / phase), lambda world: positions.append(joint.position))
    off = np.array(positions) - 0.1
    last = off[-round(2 * math.pi / phase) - 2 :]
    assert max(abs(off)) <= 0.1 * (1 + 0.15 * phase**2 + 1e-3)
    assert max(abs(last)) >= 0.1 * (1 - 1e-3 - phase**2 / 8)
    zeros = np.flatnonzero(np.diff(np.sign(off)))
    # Of semi-implicit Euler steps: sin(phase of a step / 2) = phase / 2.
    expected = math.pi / (2.0 * math.asin(phase / 2.0))
    half_periods = len(zeros) - 1
    assert zeros[-1] - zeros[0] == pytest.approx(half_periods * expected, abs=1.0)


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("stiffness", [1e2, 1e4, 1e6, 1e8])
def test_what_hangs_on_a_spring_comes_to_rest_where_its_force_is_the_weight(rate, stiffness):
    world, joint = make_spring(
        stiffness, rate=rate, damping=2.0 * math.sqrt(stiffness), gravity=(-9.81, 0, 0)
    )
    world.step(round(4.0 * rate))
    assert joint.position - 0.1 == pytest.approx(-9.81 / stiffness, rel=1e-6, abs=1e-12)
    np.testing.assert_allclose(joint.reaction.force, (9.81, 0, 0), atol=1e-4)


@pytest.mark.parametrize("rate", RATES)
def test_springs_stiffer_than_steps_can_follow_do_not_diverge(rate):
    world, joint = make_spring(1e9, rate=rate)
    positions = []
    world.step(300, lambda world: positions.append(joint.position))
    assert max(positions) <= 0.1 + 1e-3
    assert positions[-1] == pytest.approx(0.1, abs=1e-6)


@pytest.mark.parametrize("rate", RATES[:3])
def test_a_hinge_turns_back_over_whole_turns(rate):
    world = vx.World(gravity=(0, 0, 0), time_step=1.0 / rate)
    wheel = world.add(vx.Cylinder(radius=0.1, length=0.02), mass=1.0)
    spring = vx.HingeJoint((0, 0, 1), stiffness=0.2, spring_position=7.0)
    joint = world.add_joint(spring, None, wheel)
    positions = []
    world.step(round(rate), lambda world: positions.append(joint.position))
    assert max(positions) == pytest.approx(14.0, rel=2e-3)


def test_motors_and_limits_act_beside_the_spring():
    world, joint = make_spring(100.0, rate=200.0, damping=5.0)
    joint.set_target_position(0.3, max_force=50.0, max_speed=0.5)
    world.step(400)
    assert joint.position == pytest.approx(0.3, abs=1e-4)
    joint.set_target_position(0.3, max_force=10.0, max_speed=0.5)  # 20 N are needed
    world.step(1600)
    assert joint.position == pytest.approx(0.2, abs=2e-3)
    world = vx.World(gravity=(0, 0, 0))
    door = world.add(vx.Box((0.1, 0.1, 0.1)))
    stop = vx.SliderJoint((1, 0, 0), limits=(0.0, 0.05), stiffness=1000.0, spring_position=0.1)
    joint = world.add_joint(stop, None, door)
    world.step(400)
    assert joint.position == pytest.approx(0.05, abs=1e-3)


@pytest.mark.parametrize("armature", [0.1, 1.0, 1e4])
def test_an_armature_adds_to_the_inertia_of_the_joint(armature):
    world = vx.World(gravity=(0, 0, 0))
    carriage = world.add(vx.Box((0.1, 0.1, 0.1)), mass=2.0)
    body = world.add(vx.Box((0.1, 0.1, 0.1)), mass=1.0)
    kind = vx.SliderJoint((1, 0, 0), armature=armature)
    joint = world.add_joint(kind, carriage, body)
    world.step(200, before=lambda world: body.apply_force((10, 0, 0)))
    # The reduced mass of both is 2/3 kg; 2/3 of the force moves the joint.
    assert joint.velocity == pytest.approx(20.0 / 3.0 / (2.0 / 3.0 + armature), rel=1e-9)
    momentum = 2.0 * carriage.linear_velocity + body.linear_velocity
    np.testing.assert_allclose(momentum, (10, 0, 0), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("armature", [0.01, 1.0])
def test_a_motor_turns_armature_and_body(armature):
    world = vx.World(gravity=(0, 0, 0))
    wheel = world.add(vx.Cylinder(radius=0.1, length=0.02), mass=1.0)
    joint = world.add_joint(vx.HingeJoint((0, 0, 1), armature=armature), None, wheel)
    joint.set_target_velocity(1000.0, max_force=0.5)
    world.step(100)
    inertia = wheel.inertia[2, 2] + armature
    assert joint.velocity == pytest.approx(0.25 / inertia, rel=1e-9)


def test_bullets_own_solvers_refuse_an_armature():
    world = vx.World(solver="sequential_impulse")
    wheel = world.add(vx.Cylinder(radius=0.1, length=0.02))
    with pytest.raises(vx.SettingsError, match="make the world with the solver 'coulomb'"):
        world.add_joint(vx.HingeJoint((0, 0, 1), armature=0.1), None, wheel)


@pytest.mark.parametrize("kind", [vx.HingeJoint, vx.SliderJoint])
def test_wrong_springs_are_refused(kind):
    with pytest.raises(vx.SettingsError, match="stiffness must be at least 0"):
        kind(stiffness=-1.0)
    with pytest.raises(vx.SettingsError, match="armature must be at least 0"):
        kind(armature=-1.0)
    with pytest.raises(vx.SettingsError, match="spring_position"):
        kind(stiffness=1.0, spring_position=math.inf)
