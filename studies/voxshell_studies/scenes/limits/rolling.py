"""Round bodies on curved models, on small wheels, and across seams."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from voxshell.model.shapes import Box, Cylinder
from voxshell.simulation.joint_kinds import HingeJoint
from voxshell_studies.scenes.everyday import forms
from voxshell_studies.scenes.everyday.scene import X, Y, heading, scatter, shift, turn
from voxshell_studies.scenes.limits import bodies
from voxshell_studies.scenes.limits.scene import (
    G,
    LimitScene,
    count_steps,
    fallen_way,
    open_world,
    put,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray
    from voxshell.simulation.body import Body
    from voxshell.simulation.body_shapes import Shape
    from voxshell.simulation.world import World
    from voxshell_studies.scenes.everyday.scene import Form

WAVES = "Wheels on waves"
PIPES = "Balls in half-pipes, on rails and in bends"
BOWLS = "Swinging in troughs and bowls"
EGGS = "Eggs and other long round bodies"
WHEELS = "Small wheels"
SEAMS = "Seams, small steps and ramps"

ALONG_X, ALONG_Y = turn(Y, 0.5 * math.pi), turn(X, -0.5 * math.pi)
"""Rotations that lay a body's z along x and along y."""

_BALL_INERTIA = 0.4
"""Of a ball, in units of mass times squared radius."""

# ---- waves --------------------------------------------------------------------------

_WAVE, _WAVE_LENGTH = 0.02, 0.5


def way_over_waves(radius: float, speed: float, seconds: float) -> tuple[float, float, float]:
    """Return how far a disc rolls along x, and its first center (x, z), meters; it starts at x = 0.

    Example:
        >>> [round(value, 3) for value in way_over_waves(0.05, 1.0, 1.5)]
        [1.43, -0.012, 0.048]
    """
    x = np.linspace(0.0, 2.4, 24001)
    wave_number = 2.0 * math.pi / _WAVE_LENGTH
    slope = _WAVE * wave_number * np.cos(wave_number * x)
    length = np.hypot(1.0, slope)
    centers = np.column_stack(
        [x - radius * slope / length, _WAVE * np.sin(wave_number * x) + radius / length]
    )
    steps = np.linalg.norm(np.diff(centers, axis=0), axis=1)
    speeds = np.sqrt(speed**2 - 2.0 * G / 1.5 * (centers[:, 1] - centers[0, 1]))
    times = np.concatenate([[0.0], np.cumsum(2.0 * steps / (speeds[1:] + speeds[:-1]))])
    way = float(np.interp(seconds, times, centers[:, 0]) - centers[0, 0])
    return way, float(centers[0, 0]), float(centers[0, 1])


def _roll_over_waves(rate: float, shape: Form | Shape, radius: float) -> float:
    """Return the distance as a fraction of the closed form's."""
    seconds = 1.5
    way, x, z = way_over_waves(radius, 1.0, seconds)
    world = open_world(rate)
    put(world, bodies.waves(_WAVE, _WAVE_LENGTH, 2.7, 0.025), friction=1.0)
    uphill = math.atan(_WAVE * 2.0 * math.pi / _WAVE_LENGTH)
    wheel = put(
        *(world, shape, shift(x, 0.0, z) @ ALONG_Y, 0.3),
        friction=1.0,
        velocity=(math.cos(uphill), 0.0, math.sin(uphill)),
        spin=(0.0, 1.0 / radius, 0.0),
    )
    world.step(count_steps(rate, seconds))
    return float(wheel.pose[0, 3] - x) / way


# ---- pipes, rails, bends ------------------------------------------------------------------

_SPEED = 0.3


def _any_way(placement: int) -> NDArray[np.float64]:
    """Return a rotation for a ball, (4, 4)."""
    return turn((0.0, 0.0, 1.0), heading(5 * placement)) @ turn(X, 2.0 * scatter(placement))


def roll_along(
    rate: float, placement: int, add_ground: Callable[[World], object], ball: Form, height: float
) -> float:
    """Return the fraction of a ball's speed along x that is left after 2 s.

    ``height`` is that of the ball's center where it touches both sides or the lowest line.
    """
    world = open_world(rate)
    add_ground(world)
    radius = float(ball.vertices[:, 2].max())
    body = put(
        *(world, ball, shift(-0.35, 0.0, height) @ _any_way(placement), 0.3),
        velocity=(_SPEED, 0.0, 0.0),
        spin=(0.0, _SPEED / radius, 0.0),
    )
    world.step(count_steps(rate, 2.0))
    return float(body.linear_velocity[0]) / _SPEED


def _roll_in_a_half_pipe(rate: float, placement: int, radius: float) -> float:
    pipe = bodies.half_pipe(radius, 1.0, 48.0, 0.5 * (1.0 + scatter(placement, 2)))
    height = 0.02 - radius
    return roll_along(rate, placement, lambda w: put(w, pipe), forms.ball(0.02), height)


def _roll_on_rails(rate: float, placement: int) -> float:
    """A ball of 40 mm on two round bars of 10 mm, whose axes are 30 mm apart."""

    def add_rails(world: World) -> None:
        for y in (-0.015, 0.015):
            rail = turn(X, 0.05 * scatter(placement, 3)) @ ALONG_X
            put(world, forms.cylinder(0.005, 1.0, 48), shift(0.0, y, 0.0) @ rail)

    height = math.sqrt(0.025**2 - 0.015**2)
    world = open_world(rate)
    add_rails(world)
    # It touches the rails at 0.8 of its radius below its center.
    body = put(
        *(world, forms.ball(0.02), shift(-0.35, 0.0, height) @ _any_way(placement), 0.3),
        velocity=(_SPEED, 0.0, 0.0),
        spin=(0.0, _SPEED / 0.016, 0.0),
    )
    world.step(count_steps(rate, 2.0))
    return float(body.linear_velocity[0]) / _SPEED


def _slide_through_a_bend(rate: float, placement: int) -> float:
    """Return the fraction of the speed of a ball without friction after a second in a circle."""
    world = open_world(rate)
    channel = bodies.round_channel(0.1, 0.0105, 120)
    put(world, channel, turn((0.0, 0.0, 1.0), heading(placement)), friction=0.0)
    start = shift(0.1005, 0.0, 0.01)
    body = put(world, forms.ball(0.01), start, 0.05, friction=0.0, velocity=(0.0, 0.59, 0.0))
    world.step(count_steps(rate, 1.0))
    return float(np.linalg.norm(body.linear_velocity)) / 0.59


# ---- swinging ------------------------------------------------------------------------------------


def swing(world: World, rate: float, body: Body, start: float) -> float:
    """Return the largest angle in the last 0.4 s of a second, as a fraction of the first one.

    The angle is that of the body's center about the x axis or the y axis, from straight below.
    """
    angles = []
    for _ in range(count_steps(rate, 1.0)):
        world.step()
        x, y, z = body.position
        angles.append(math.atan2(math.hypot(x, y), -z))
    return max(angles[-round(0.4 * rate) :]) / start


def _swing_in_a_trough(rate: float, _: int) -> float:
    world = open_world(rate)
    put(world, bodies.half_pipe(0.06, 2.0, 64.0), friction=1.0)
    start = math.radians(30.0)
    place = shift(0.0, 0.03 * math.sin(start), -0.03 * math.cos(start))
    return swing(world, rate, put(world, forms.ball(0.03), place, 1.0, friction=1.0), start)


def _swing_in_a_bowl(rate: float, placement: int, segments: int) -> float:
    """Return the period of a ball in a bowl as a fraction of the closed form's."""
    radius, ball, start = 0.2, 0.02, 0.3
    world = open_world(rate)
    put(world, bodies.faceted_bowl(radius, segments), friction=1.0)
    way = turn((0.0, 0.0, 1.0), heading(placement))
    place = way @ turn(Y, -start) @ shift(0.0, 0.0, ball - radius)
    body = put(world, forms.ball(ball), place, 0.3, friction=1.0)
    times, last = [], math.inf
    for step in range(count_steps(rate, 4.0)):
        world.step()
        x = float(body.position @ way[:3, 0])
        if step > 0 and x * last < 0.0:
            times.append((step + last / (last - x)) / rate)
        last = x
    if len(times) < 2:
        return math.nan
    period = 2.0 * (times[-1] - times[0]) / (len(times) - 1)
    small = 2.0 * math.pi * math.sqrt((1.0 + _BALL_INERTIA) * (radius - ball) / G)
    return period / (small * (1.0 + start**2 / 16.0))


# ---- eggs, small wheels, seams -------------------------------------------------------------------


def _roll_an_egg(rate: float, ground: Form | Shape, low: float) -> float:
    """Return the fraction of 0.4 m/s that an ellipsoid keeps in a second."""
    world = open_world(rate)
    put(world, ground, shift(0.0, 0.0, low), friction=1.0)
    egg = forms.spheroid(0.02, 0.03)
    body = put(
        *(world, egg, shift(-0.3, 0.0, 0.02) @ ALONG_Y, 0.1),
        friction=1.0,
        velocity=(0.4, 0.0, 0.0),
        spin=(0.0, 20.0, 0.0),
    )
    world.step(count_steps(rate, 1.0))
    return float(body.linear_velocity[0]) / 0.4


def _roll_a_cart(rate: float, wheel: Form | Shape) -> float:
    """Return the distance of a cart with four wheels on a slope of 15 degrees, of the closed form's."""
    slope, radius, seconds = math.radians(15.0), 0.01, 0.8
    world = open_world(rate, (G * math.sin(slope), 0.0, -G * math.cos(slope)))
    put(world, forms.slab(4.0), friction=1.0)
    deck = put(world, Box((0.05, 0.02, 0.005)), shift(-1.5, 0.0, 0.02), 0.5)
    for x in (-0.04, 0.04):
        for y in (-0.03, 0.03):
            place = shift(x - 1.5, y, radius)
            body = put(world, wheel, place @ ALONG_Y, 0.02, friction=1.0)
            world.add_joint(HingeJoint(axis=Y), deck, body, world_from_joint=place)
    world.step(count_steps(rate, seconds))
    rolling = 1.0 + 4.0 * 0.02 * 0.5 / 0.58
    true_way = fallen_way(rate, seconds) * math.sin(slope) / rolling
    return float(deck.position[0] + 1.5) / true_way


def _roll_at_1(world: World, rate: float, seconds: float, x: float = -0.5) -> Body:
    """Roll a ball of 100 mm along x at 1 m/s."""
    ball = put(
        *(world, forms.ball(0.05), shift(x, 0.03, 0.05), 0.5),
        velocity=(1.0, 0.0, 0.0),
        spin=(0.0, 20.0, 0.0),
    )
    world.step(count_steps(rate, seconds))
    return ball


def _roll_over_tiles(rate: float, _: int) -> float:
    world = open_world(rate)
    for i in range(12):
        put(world, forms.box(0.2, 0.2, 0.05), shift(-0.5 + 0.2 * i, 0.0, -0.025))
    return float(_roll_at_1(world, rate, 1.5).linear_velocity[0])


_STEP = 0.001


def true_speed_over_a_step() -> float:
    """Return the speed of a ball of 100 mm and 1 m/s after a step of 1 mm up, m/s.

    The blow keeps its angular momentum about the edge, and then it rises.
    """
    kept = 1.0 - _STEP / (0.05 * (1.0 + _BALL_INERTIA))
    return math.sqrt(kept**2 - 2.0 * G * _STEP / (1.0 + _BALL_INERTIA))


def _roll_over_a_step(rate: float, _: int) -> float:
    world = open_world(rate)
    put(world, forms.slab(1.0), shift(-0.5, 0.0, 0.0))
    put(world, forms.slab(2.0), shift(1.0, 0.0, _STEP))
    return float(_roll_at_1(world, rate, 1.0).linear_velocity[0]) / true_speed_over_a_step()


_RAMP = math.radians(10.0)


def true_rise() -> float:
    """Return how high a ball at 1 m/s rises on a ramp of 10 degrees, meters.

    At the foot, the ball keeps its angular momentum about the place where it meets the ramp.
    """
    kept = (_BALL_INERTIA + math.cos(_RAMP)) / (_BALL_INERTIA + 1.0)
    return (1.0 + _BALL_INERTIA) * kept**2 / (2.0 * G)


def _roll_up_a_ramp(rate: float, placement: int) -> float:
    """Return the rise as a fraction of the closed form's."""
    world = open_world(rate)
    put(world, forms.slab(2.0), shift(-1.0, 0.0, 0.0))
    ramp = turn(Y, -_RAMP) @ shift(0.5, 0.0, -0.025)
    put(world, forms.box(1.0, 1.0, 0.05), ramp)
    ball = _roll_at_1(world, rate, 0.3, -0.4 - 0.003 * placement)
    highest = 0.0
    for _ in range(count_steps(rate, 1.2)):
        world.step()
        highest = max(highest, float(ball.position[2]) - 0.05)
    return highest / true_rise()


SCENES = (
    *(
        LimitScene(
            f"{name} of {1e3 * radius:g} mm in radius rolls over waves of 2 cm",
            WAVES,
            "distance over the true one",
            "",
            1.0,
            lambda rate, _, make=make, radius=radius: _roll_over_waves(rate, make(radius), radius),
        )
        for name, make in (
            ("Bullet's cylinder", lambda radius: Cylinder(radius, 0.04)),
            ("model wheel", lambda radius: forms.cylinder(radius, 0.04, 128)),
        )
        for radius in (0.05, 0.005)
    ),
    *(
        LimitScene(
            f"ball of 40 mm rolls in a half-pipe of {1e3 * radius:g} mm in radius",
            PIPES,
            "fraction of the speed after 2 s",
            "",
            1.0,
            lambda rate, placement, radius=radius: _roll_in_a_half_pipe(rate, placement, radius),
            placements=5,
        )
        for radius in (0.03, 0.045, 0.06)
    ),
    LimitScene(
        "ball of 40 mm rolls on two round rails",
        PIPES,
        "fraction of the speed after 2 s",
        "",
        1.0,
        _roll_on_rails,
        placements=5,
    ),
    LimitScene(
        "ball slides through a level bend of 100 mm in radius",
        PIPES,
        "fraction of the speed after a second",
        "",
        1.0,
        _slide_through_a_bend,
        placements=5,
    ),
    LimitScene(
        "ball of 60 mm swings in a trough of 60 mm in radius",
        BOWLS,
        "fraction of the angle after a second",
        "",
        1.0,
        _swing_in_a_trough,
    ),
    *(
        LimitScene(
            f"ball of 40 mm swings in a bowl of facets of {360.0 / segments:g} degrees",
            BOWLS,
            "period over the true one",
            "",
            1.0,
            lambda rate, placement, segments=segments: _swing_in_a_bowl(rate, placement, segments),
            placements=3,
        )
        for segments in (100, 600)
    ),
    *(
        LimitScene(
            f"ellipsoid of 20 by 30 mm rolls on {name}",
            EGGS,
            "fraction of the speed after a second",
            "",
            1.0,
            lambda rate, _, make=make, low=low: _roll_an_egg(rate, make(), low),
        )
        for name, make, low in (
            ("a plane", lambda: forms.PLANE, 0.0),
            ("Bullet's box", lambda: Box((1.0, 1.0, 0.05)), -0.05),
            ("a flat model", lambda: forms.slab(2.0), 0.0),
        )
    ),
    *(
        LimitScene(
            f"cart on {name} of 10 mm in radius rolls down 15 degrees",
            WHEELS,
            "distance over the true one",
            "",
            1.0,
            lambda rate, _, make=make: _roll_a_cart(rate, make()),
        )
        for name, make in (
            ("model wheels", lambda: forms.cylinder(0.01, 0.008, 128)),
            ("Bullet's cylinders", lambda: Cylinder(0.01, 0.008)),
        )
    ),
    LimitScene(
        "ball of 100 mm rolls over tiles of 0.2 m at 1 m/s",
        SEAMS,
        "speed after 1.5 s",
        "m/s",
        1.0,
        _roll_over_tiles,
    ),
    LimitScene(
        "ball of 100 mm rolls over a step of 1 mm at 1 m/s",
        SEAMS,
        "speed over the true one",
        "",
        1.0,
        _roll_over_a_step,
    ),
    LimitScene(
        "ball of 100 mm rolls up a ramp of 10 degrees at 1 m/s",
        SEAMS,
        "rise over the true one",
        "",
        1.0,
        _roll_up_a_ramp,
        placements=3,
    ),
)
