"""Shafts in bearings, and balls in tubes with little clearance."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from voxshell.model.shapes import Cylinder, Sphere
from voxshell_studies.scenes.everyday import forms
from voxshell_studies.scenes.everyday.scene import X, heading, scatter, shift, turn
from voxshell_studies.scenes.limits.rolling import ALONG_X, ALONG_Y, roll_along, swing
from voxshell_studies.scenes.limits.scene import (
    LimitScene,
    count_steps,
    fallen_way,
    open_world,
    put,
)

if TYPE_CHECKING:
    from voxshell.simulation.body_shapes import Shape
    from voxshell_studies.scenes.everyday.scene import Form

BEARINGS = "Shafts in bearings"
TUBES = "Balls in close tubes"


def _spin_in_a_bearing(rate: float, shape: Form | Shape) -> float:
    """Return the fraction of the spin of a shaft without friction that is left after 0.5 s."""
    world = open_world(rate)
    put(world, forms.tube(0.032, 0.02, 0.03, 128), ALONG_Y, friction=0.0)
    shaft = put(
        *(world, shape, shift(0.0, 0.0, -0.002) @ ALONG_Y, 0.3), friction=0.0, spin=(0, 10, 0)
    )
    world.step(count_steps(rate, 0.5))
    return float(shaft.angular_velocity[1]) / 10.0


def _swing_in_a_bearing(rate: float, shape: Form | Shape) -> float:
    world = open_world(rate)
    put(world, forms.tube(0.06, 0.04, 0.06, 128), ALONG_Y, friction=1.0)
    start = math.radians(30.0)
    place = shift(0.022 * math.sin(start), 0.0, -0.022 * math.cos(start))
    return swing(world, rate, put(world, shape, place @ ALONG_Y, 0.3, friction=1.0), start)


def _roll_in_a_tube(rate: float, placement: int) -> float:
    tube = forms.tube(0.03, 0.025, 1.0, 128)
    phase = turn(X, 0.05 * scatter(placement, 2))
    ball = forms.ball(0.0245)
    return roll_along(rate, placement, lambda w: put(w, tube, phase @ ALONG_X), ball, -0.0005)


def _fall_in_a_tube(rate: float, placement: int) -> float:
    """Return the distance of a ball without friction as a fraction of free fall."""
    world = open_world(rate)
    put(world, forms.tube(0.03, 0.025, 1.2, 128), friction=0.0)
    aside = heading(placement + 1)
    start = shift(3e-4 * math.cos(aside), 3e-4 * math.sin(aside), 0.5)
    push = 0.02 * scatter(placement + 1)
    body = put(
        *(world, forms.ball(0.0245), start, 0.3), friction=0.0, velocity=(push, 0.3 * push, 0.0)
    )
    world.step(count_steps(rate, 0.4))
    return float(0.5 - body.position[2]) / fallen_way(rate, 0.4)


def _leave_a_thin_tube(rate: float, _: int) -> float:
    """Return how many of ten spheres of 10 mm leave a tube with walls of 1.5 mm."""
    left = 0
    for throw in range(10):
        world = open_world(rate)
        put(world, forms.tube(0.0075, 0.006, 0.4, 64), ALONG_X)
        aside = heading(throw)
        velocity = (0.5, 0.5 * math.cos(aside), 0.5 * math.sin(aside))
        ball = put(world, Sphere(0.005), shift(-0.15, 0.0, 0.0), 0.01, velocity=velocity)
        inside = True
        for _step in range(count_steps(rate, 1.0)):
            world.step()
            x, y, z = ball.position
            inside &= abs(x) > 0.19 or math.hypot(y, z) < 0.005
        left += not inside
    return float(left)


SCENES = (
    *(
        LimitScene(
            f"{name} of 36 mm spins in a bearing of 40 mm",
            BEARINGS,
            "fraction of the spin after 0.5 s",
            "",
            1.0,
            lambda rate, _, make=make: _spin_in_a_bearing(rate, make()),
        )
        for name, make in (
            ("model shaft", lambda: forms.cylinder(0.018, 0.06, 128)),
            ("Bullet's cylinder", lambda: Cylinder(0.018, 0.06)),
        )
    ),
    *(
        LimitScene(
            f"{name} of {1e3 * length:g} mm swings in a bearing of 60 mm",
            BEARINGS,
            "fraction of the angle after a second",
            "",
            1.0,
            lambda rate, _, make=make, length=length: _swing_in_a_bearing(rate, make(length)),
        )
        for name, make in (
            ("model shaft", lambda length: forms.cylinder(0.018, length, 128)),
            ("Bullet's cylinder", lambda length: Cylinder(0.018, length)),
        )
        for length in (0.04, 0.12)
    ),
    LimitScene(
        "model ball rolls in a tube of 50 mm with 0.5 mm of clearance",
        TUBES,
        "fraction of the speed after 2 s",
        "",
        1.0,
        _roll_in_a_tube,
        placements=3,
    ),
    LimitScene(
        "model ball falls in a tube of 50 mm with 0.5 mm of clearance",
        TUBES,
        "distance over free fall",
        "",
        1.0,
        _fall_in_a_tube,
        placements=5,
    ),
    LimitScene(
        "spheres of 10 mm thrown in tubes with walls of 1.5 mm",
        TUBES,
        "spheres that leave",
        "of 10",
        0.0,
        _leave_a_thin_tube,
    ),
)
