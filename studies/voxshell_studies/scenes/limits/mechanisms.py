"""Mechanisms whose parts turn by more than their play within a long step, and gears."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from voxshell.query.distances import distance
from voxshell.simulation.joint_kinds import HingeJoint, SliderJoint
from voxshell_studies.everyday.worlds import build_model
from voxshell_studies.scenes.everyday import forms
from voxshell_studies.scenes.everyday.scene import X, Z, shift, turn
from voxshell_studies.scenes.limits import mechanism_bodies as parts
from voxshell_studies.scenes.limits.scene import LimitScene, count_steps, open_world, put

if TYPE_CHECKING:
    from voxshell.simulation.body import Body
    from voxshell.simulation.joints import Joint
    from voxshell.simulation.world import World
    from voxshell_studies.scenes.everyday.scene import Form

MECHANISMS = "Mechanisms with little play"
GEARS = "Spur gears"

_PLAY = 0.0003
"""Of all mechanisms, meters."""
_TURN = 2.0 * math.pi


def _put_on_hinge(
    world: World, form: Form, x: float, z: float, mass: float, angle: float = 0.0
) -> Joint:
    """Add a body that turns about an upright axis through (x, 0)."""
    body = put(world, form, shift(x, 0.0, z) @ turn(Z, angle), mass, friction=0.1)
    return world.add_joint(HingeJoint(axis=Z), None, body, world_from_joint=shift(x, 0.0, z))


def _turn_a_yoke(rate: float, _: int) -> float:
    """Return the turns of a crank that drives a Scotch yoke, of two."""
    world = open_world(rate)
    hinge = _put_on_hinge(world, parts.crank(), 0.0, 0.0, 0.1)
    yoke = put(world, parts.yoke(_PLAY), shift(parts.CRANK, 0.0, 0.0), 0.2, friction=0.1)
    world.add_joint(SliderJoint(axis=X), None, yoke)
    hinge.set_target_velocity(_TURN, max_force=0.5)
    world.step(count_steps(rate, 2.0))
    return hinge.position / (2.0 * _TURN)


def _turn_a_geneva_drive(rate: float, _: int) -> float:
    """Return the turn of a Geneva wheel of four slots after two turns of its driver, of half a turn."""
    world = open_world(rate)
    wheel = _put_on_hinge(world, parts.geneva_wheel(_PLAY), 0.0, 0.0, 0.1, 0.25 * math.pi)
    # The pin begins on the far side.
    driver = _put_on_hinge(world, parts.geneva_driver(), parts.GENEVA, 0.0, 0.1)
    driver.set_target_velocity(0.5 * _TURN, max_force=0.5)
    world.step(count_steps(rate, 4.0))
    return -wheel.position / (0.5 * _TURN)


def add_oldham_coupling(world: World) -> tuple[Joint, Joint]:
    """Add a driven Oldham coupling, and return the hinges of its input and its output."""
    gap = 0.0002
    middle = parts.THICK + gap
    driver = _put_on_hinge(world, parts.hub(_PLAY), 0.0, 0.0, 0.1)
    put(world, parts.middle_disc(), shift(0.0025, 0.0, middle), 0.05, friction=0.1)
    # The output's groove is along y, in its lower face.
    over = turn(Z, 0.5 * math.pi) @ turn(X, math.pi)
    place = shift(0.005, 0.0, middle + 2.0 * parts.THICK + gap)
    output = put(world, parts.hub(_PLAY), place @ over, 0.1, friction=0.1)
    follower = world.add_joint(
        HingeJoint(axis=Z, friction=0.02), None, output, world_from_joint=place
    )
    driver.set_target_velocity(0.5 * _TURN, max_force=2.0)
    return driver, follower


def _turn_an_oldham_coupling(rate: float, _: int) -> float:
    """Return how far the output of an Oldham coupling lags behind its input at most, degrees."""
    world = open_world(rate)
    driver, follower = add_oldham_coupling(world)
    lag = 0.0
    for _step in range(count_steps(rate, 2.0)):
        world.step()
        lag = max(lag, abs(driver.position - follower.position))
    return math.degrees(lag)


def _lift_a_brick(rate: float, placement: int) -> float:
    """Return how far a brick is lifted with the one that is pulled off its studs, millimeters."""
    world = open_world(rate)
    put(world, forms.PLANE)
    lower = put(world, parts.brick(0.0001), None, 0.002, friction=0.2)
    upper = put(world, parts.brick(0.0001), shift(0.0, 0.0, 0.01), friction=0.2, driven=True)
    world.step(count_steps(rate, 0.2))
    speed = 0.05 * (1.0 + 0.5 * placement)
    for step in range(count_steps(rate, 0.5)):
        upper.pose = shift(0.0, 0.0, 0.01 + speed * (step + 1) / rate)
        world.step()
    return 1e3 * float(lower.position[2])


def _pull_a_keyhole_plate(rate: float, placement: int) -> float:
    """Return how deep a hung plate is in the head of its screw, that is pulled against it, millimeters."""
    world = open_world(rate)
    pin, plate = parts.screw(), parts.keyhole_plate()
    outward = turn(X, 0.5 * math.pi)
    put(world, pin, outward)
    # The plate's y is up; it hangs with the slot's end on the shaft.
    start = outward @ shift(0.0, -0.0005, 0.002)
    body = put(world, plate, start, 0.1)
    pull = outward[:3, 2] * (20.0 + 20.0 * placement)
    deepest = 0.0
    for _ in range(count_steps(rate, 0.5)):
        body.apply_force(pull)
        world.step()
        gap = distance(build_model(pin), build_model(plate), outward, body.pose).distance
        deepest = max(deepest, -gap)
    return 1e3 * deepest


def true_backlash() -> float:
    """Return by how much the second gear can lag without a tooth's overlap, degrees.

    Both gears' teeth are thinner by a tenth of the module; they begin in the middle.

    Example:
        >>> round(true_backlash(), 2)
        0.48
    """
    return math.degrees(0.1 * parts.MODULE / (0.5 * parts.MODULE * parts.TEETH[1]))


def true_coupling_lag() -> float:
    """Return the lag that the play of an Oldham coupling's two tongues allows, degrees.

    A tongue of 48 mm turns in its groove until its corners touch.

    Example:
        >>> round(true_coupling_lag(), 2)
        1.43
    """
    return math.degrees(2.0 * math.asin(_PLAY / 0.024))


# ---- gears ---------------------------------------------------------------------------------------


def _add_gears(world: World, friction: float) -> tuple[list[Body], list[Joint]]:
    bodies, hinges = [], []
    distance_of_axes = 0.5 * parts.MODULE * sum(parts.TEETH)
    for teeth, x, angle, mass in zip(
        parts.TEETH,
        (0.0, distance_of_axes),
        (0.0, math.pi / parts.TEETH[1]),
        (0.05, 0.2),
        strict=True,
    ):
        place = shift(x, 0.0, 0.0)
        body = put(world, parts.gear(teeth), place @ turn(Z, angle), mass, friction=friction)
        bodies.append(body)
        hinges.append(world.add_joint(HingeJoint(axis=Z), None, body, world_from_joint=place))
    return bodies, hinges


def _work_on_gears(rate: float, _: int) -> float:
    """Return the kinetic energy of two gears after a constant torque's work, of that work."""
    world = open_world(rate)
    bodies, hinges = _add_gears(world, 0.0)
    torque = 2e-4
    for _step in range(count_steps(rate, 0.5)):
        bodies[0].apply_torque((0.0, 0.0, torque))
        world.step()
    energy = sum(
        0.5 * float(forms.matter(parts.gear(teeth), body.mass).inertia[2, 2]) * hinge.velocity**2
        for teeth, body, hinge in zip(parts.TEETH, bodies, hinges, strict=True)
    )
    return energy / (torque * hinges[0].position)


def _lag_of_gears(rate: float, _: int) -> float:
    """Return how far the second gear is from the ratio of the teeth at most, degrees."""
    world = open_world(rate)
    hinges = _add_gears(world, 0.0)[1]
    hinges[0].set_target_velocity(_TURN, max_force=0.05)
    lag = 0.0
    for _step in range(count_steps(rate, 1.0)):
        world.step()
        lag = max(
            lag, abs(hinges[1].position + hinges[0].position * parts.TEETH[0] / parts.TEETH[1])
        )
    return math.degrees(lag)


SCENES = (
    LimitScene(
        "Scotch yoke with 0.3 mm of play, turned once a second",
        MECHANISMS,
        "turns of the crank over the true ones",
        "",
        1.0,
        _turn_a_yoke,
        cost=4.0,
    ),
    LimitScene(
        "Geneva drive with 0.3 mm of play, driven by half a turn a second",
        MECHANISMS,
        "turn of the wheel over the true one",
        "",
        1.0,
        _turn_a_geneva_drive,
        cost=10.0,
    ),
    LimitScene(
        "Oldham coupling with 0.3 mm of play, driven by half a turn a second",
        MECHANISMS,
        "largest lag",
        "degrees",
        round(true_coupling_lag(), 2),
        _turn_an_oldham_coupling,
        cost=10.0,
    ),
    LimitScene(
        "brick is pulled off the studs of another",
        MECHANISMS,
        "height of the lower brick",
        "mm",
        0.0,
        _lift_a_brick,
        placements=3,
    ),
    LimitScene(
        "keyhole plate is pulled against the head of its screw",
        MECHANISMS,
        "depth in the head",
        "mm",
        0.0,
        _pull_a_keyhole_plate,
        placements=2,
    ),
    LimitScene(
        "gears of 12 and 24 teeth, turned by a constant torque",
        GEARS,
        "energy over the work",
        "",
        1.0,
        _work_on_gears,
        cost=2.0,
    ),
    LimitScene(
        "gears of 12 and 24 teeth, started at a turn a second",
        GEARS,
        "largest lag",
        "degrees",
        round(true_backlash(), 2),
        _lag_of_gears,
        cost=2.0,
    ),
)
