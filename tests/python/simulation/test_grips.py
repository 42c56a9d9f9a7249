"""Grips and motor forces as `docs/joints.md` states them."""

from __future__ import annotations

import numpy as np
import pytest
import voxshell as vx

LIFT = 0.2  # meters, in a second


def carry(
    *,
    force: float | None,
    damping: float = 10.0,
    press: float = 0.0005,
    smooth: bool = True,
    rate: float = 200.0,
    finger_mass: float = 0.1,
) -> np.ndarray:
    """Slip of a part after a lift and two seconds, meters; without a force, fingers are kinematic."""
    world = vx.World(time_step=1.0 / rate)
    world.add(vx.Plane(), mass=0)
    part = world.add(vx.Box((0.03, 0.03, 0.05)), mass=0.5, pose=(0, 0, 0.05), friction=0.8)
    palm = world.add(vx.Box((0.1, 0.03, 0.01)), motion="kinematic", pose=(0, 0, 0.15))
    hands = []
    for side in (-1, 1):
        motion = "kinematic" if force is None else "dynamic"
        pad, place = vx.Box((0.005, 0.02, 0.05)), (0.06 * side, 0, 0.07)
        finger = world.add(pad, mass=finger_mass, motion=motion, pose=place, friction=0.8)
        if force is None:
            hands.append((finger, side))
            continue
        kind = vx.SliderJoint(axis=(-side, 0, 0), limits=(0.0, 0.05), damping=damping)
        grip = world.add_joint(kind, palm, finger)
        grip.set_target_position(0.05, max_force=force, max_speed=0.1)

    def close(_):
        for finger, side in hands:
            nearer = abs(finger.position[0]) - 0.1 / rate
            finger.position = (side * max(0.035 - press, nearer), 0, 0.07)

    def lift(world):
        t = min(world.time - start + world.time_step, 1.0)
        up = LIFT * (t * t * (3 - 2 * t) if smooth else t)
        palm.position = (0, 0, 0.15 + up)
        for finger, _ in hands:
            finger.position = (finger.position[0], 0, 0.07 + up)

    world.step(round(0.5 * rate), before=close)
    before, start = part.position - palm.position, world.time
    world.step(round(3 * rate), before=lift)
    return part.position - palm.position - before


@pytest.mark.parametrize(("force", "holds"), [(4.0, False), (4.3, True), (8.0, True)])
def test_a_grip_holds_with_the_force_that_friction_needs(force: float, holds: bool):
    """m (g + a) / (2 f) is 4.30 N for this lift."""
    slip = carry(force=force)
    assert (np.abs(slip).max() < 1e-4) == holds
    assert (slip[2] < -0.05) != holds


@pytest.mark.parametrize(("force", "least", "most"), [(8.0, 1e-3, 2e-3), (20.0, -1e-5, 1e-5)])
def test_a_sudden_start_needs_more_force(force: float, least: float, most: float):
    """A palm that moves at 0.2 m/s from one step to the next needs 19.5 N."""
    assert least < -carry(force=force, smooth=False)[2] < most


def test_without_damping_equal_forces_do_not_hold_the_part_sideways():
    assert np.abs(carry(force=50.0)).max() < 1e-5
    assert 1e-4 < np.abs(carry(force=50.0, damping=0.0))[0] < 3e-3


@pytest.mark.parametrize("rate", [1000.0, 200.0, 60.0])
@pytest.mark.parametrize("finger_mass", [0.001, 1.0])
def test_fingers_of_any_mass_hold(rate: float, finger_mass: float):
    assert np.abs(carry(force=8.0, rate=rate, finger_mass=finger_mass)).max() < 1e-4


@pytest.mark.parametrize("smooth", [True, False])
@pytest.mark.parametrize("press", [0.0001, 0.0005, 0.003])
@pytest.mark.parametrize("rate", [1000.0, 200.0, 60.0])
def test_kinematic_fingers_hold_what_they_press(rate: float, press: float, smooth: bool):
    slip = carry(force=None, rate=rate, press=press, smooth=smooth)
    assert abs(slip[2]) < 1e-5
    assert np.abs(slip).max() < 2e-4


@pytest.mark.parametrize("rate", [1000.0, 200.0, 60.0])
def test_kinematic_fingers_hold_by_a_tenth_of_the_rest_margin(rate: float):
    """The force begins with the overlap: that margin is 0.1 mm here."""
    assert abs(carry(force=None, rate=rate, press=1e-5)[2]) < 2e-5


@pytest.mark.parametrize(
    ("force", "speed", "seconds", "beyond"),
    [
        (20.0, 0.5, 1.8, 0.0),
        (40.0, 0.5, 0.66, 0.0),
        (1000.0, 0.5, 0.64, 0.0),
        (40.0, np.inf, 0.48, 0.031),
        (100.0, np.inf, 0.26, 0.036),
    ],
)
def test_motors_arrive_as_the_page_says(force: float, speed: float, seconds: float, beyond: float):
    world = vx.World()
    lift = world.add(vx.Box((0.2, 0.2, 0.02)), mass=2.0)
    rail = world.add_joint(vx.SliderJoint(axis=(0, 0, 1), limits=(0.0, 0.5)), None, lift)
    rail.set_target_position(0.3, max_force=19.0, max_speed=speed)
    world.step(100)
    assert rail.position == pytest.approx(0.0, abs=1e-6)  # less than the weight, 19.62 N
    rail.set_target_position(0.3, max_force=force, max_speed=speed)
    path: list[float] = []
    world.step(400, lambda _: path.append(rail.position))
    off = np.abs(np.array(path) - 0.3) > 1e-3
    assert (np.flatnonzero(off).max() + 2) * world.time_step == pytest.approx(seconds, abs=0.02)
    assert max(path) - 0.3 == pytest.approx(beyond, abs=1e-3)
