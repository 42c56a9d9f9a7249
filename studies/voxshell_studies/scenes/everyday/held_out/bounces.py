"""Impacts with friction, a wall, curbs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from voxshell_studies.scenes.everyday import forms, impact_laws
from voxshell_studies.scenes.everyday.impacts import BULLETS
from voxshell_studies.scenes.everyday.scene import (
    RATES,
    EverydayScene,
    Item,
    Measure,
    Stage,
    X,
    Z,
    heading,
    scatter,
    shift,
    turn,
)
from voxshell_studies.scenes.everyday.sliding import as_vector, end_speed, nothing, one

if TYPE_CHECKING:
    from voxshell_studies.scenes.everyday.scene import Track

BOUNCE, CURB = "Bounces with friction", "Curbs"
WEIGHTLESS = (0.0, 0.0, 0.0)

# ---- bounces -------------------------------------------------------------------------------------

_RADIUS = 0.02


def _bounce(
    placement: int, along: float, into: float, spin: float, friction: float, restitution: float
) -> Stage:
    """A weightless ball of 40 mm that hits a slab; ``spin`` rolls it forward."""
    way = turn(Z, heading(placement))
    ball = forms.ball(_RADIUS)
    place = shift(0.1 * scatter(placement), 0.1 * scatter(placement, 2), _RADIUS + 0.05 * into)
    velocity = way[:3, 0] * along - way[:3, 2] * into
    pose = place @ way @ turn(X, 2.0 * scatter(placement, 3))
    return Stage(
        (
            Item("ground", forms.slab(1.0), mass=0.0),
            Item(
                *("body", ball, pose, 0.1),
                velocity=as_vector(velocity),
                spin=as_vector(way[:3, 1] * spin),
            ),
        ),
        friction=friction,
        restitution=restitution,
        gravity=WEIGHTLESS,
        facts={
            "along": along,
            "into": into,
            "spin": spin,
            "inertia_ratio": float(forms.matter(ball, 1.0).inertia[0, 0]) / _RADIUS**2,
        },
        world_from_ramp=way[:3, :3],
    )


def _after(track: Track) -> tuple[float, float]:
    return impact_laws.rough_bounce(
        *(track.fact("along"), track.fact("into"), track.fact("spin"), _RADIUS),
        *(track.fact("inertia_ratio"), track.stage.friction, track.stage.restitution),
    )


def _up(track: Track) -> float:
    return float(track.velocities["body"][-1, 2])


def _true_up(track: Track) -> float:
    return track.stage.restitution * track.fact("into")


def _spin(track: Track) -> float:
    return float(track.spins["body"][-1] @ track.stage.world_from_ramp[:, 1])


_AFTER_BOUNCE = (
    Measure(
        "speed along the ground", "m/s", end_speed, lambda t: _after(t)[0], 0.05, relative=True
    ),
    Measure("speed off the ground", "m/s", _up, _true_up, 0.05, relative=True),
    Measure("spin", "rad/s", _spin, lambda t: _after(t)[1], 0.05, relative=True),
)
_NEWTON = (
    "Newton's law along the normal, Coulomb's across it: friction's impulse stops the slip, or is mu (1 + e) m v "
    "(Brach)."
)


def _bounces(
    name: str, along: float, into: float, spin: float, friction: float, restitution: float
) -> EverydayScene:
    return EverydayScene(
        name,
        BOUNCE,
        f"{_NEWTON} {along:g} m/s along, {into:g} m/s into the ground, {spin:g} rad/s; mu {friction:g}, "
        f"e {restitution:g}.",
        lambda i: _bounce(i, along, into, spin, friction, restitution),
        0.2,
        _AFTER_BOUNCE,
        engines=BULLETS,
        held_out=True,
    )


def _at_wall(placement: int) -> Stage:
    """A weightless smooth disc of 60 mm that flies at a wall of 2 m under 45 degrees."""
    way = turn(Z, heading(placement))
    disc = forms.cylinder(0.03, 0.02, 192)
    speed = math.sqrt(0.5)
    return Stage(
        (
            Item("wall", forms.box(0.02, 2.0, 0.2), way @ shift(0.31, 0.0, 0.0), mass=0.0),
            Item(
                *("body", disc, way @ shift(0.0, -0.3, 0.0) @ turn(Z, heading(3 * placement)), 0.1),
                velocity=as_vector(way[:3, :3] @ (speed, speed, 0.0)),
            ),
        ),
        friction=0.0,
        restitution=1.0,
        gravity=WEIGHTLESS,
        world_from_ramp=way[:3, :3],
    )


def _leaving_angle(track: Track) -> float:
    """Between the wall's normal and the velocity afterwards, degrees."""
    velocity = track.velocities["body"][-1] @ track.stage.world_from_ramp
    return math.degrees(math.atan2(velocity[1], -velocity[0]))


def _half_right(_: Track) -> float:
    return 45.0


def last_speed(track: Track) -> float:
    """Of the body after the last step, m/s."""
    return float(np.linalg.norm(track.velocities["body"][-1]))


# ---- curbs ---------------------------------------------------------------------------------------

_SIDE, _CURB = 1.0, 0.02


def _curb(placement: int, factor: float) -> Stage:
    """A crate of 1 m that slides into a curb of 20 mm, a millimeter away, at a multiple of its limit.

    With friction of 1 or more it may also jam between the curb and the ground, and Coulomb's law does not
    say which of the two happens.
    """
    way = turn(Z, heading(placement))
    speed = factor * impact_laws.trip_speed(_SIDE, _CURB)
    curb = forms.box(0.2, 2.0, 2.0 * _CURB)
    return Stage(
        (
            Item("ground", forms.slab(5.0), way, mass=0.0),
            Item("curb", curb, way @ shift(0.5 * _SIDE + 0.101, 0.0, 0.0), mass=0.0),
            Item(
                *(
                    "body",
                    forms.box(_SIDE, _SIDE, _SIDE),
                    way @ shift(0.0, 0.0, 0.5 * _SIDE),
                    200.0,
                ),
                velocity=as_vector(way[:3, 0] * speed),
            ),
        ),
        friction=0.8,
        world_from_ramp=way[:3, :3],
    )


def _turns_over(track: Track) -> float:
    """Whether the crate's foremost face comes to lie below."""
    down = track.poses["body"][-1][:3, 0] @ track.stage.world_from_ramp
    return float(down[2] < -0.7)


def _curbs(
    name: str, factor: float, happens: bool, rates: tuple[float, ...] = RATES
) -> EverydayScene:
    return EverydayScene(
        name,
        CURB,
        "Without restitution its angular momentum about the curb's edge stays, which turns a cube over above "
        f"3.43 m/s (a textbook's exercise); here {factor:g} of that.",
        lambda i: _curb(i, factor),
        2.0,
        (Measure("turns over", "", _turns_over, one if happens else nothing, 0.0),),
        rates=rates,
        most=10,
        needs=2.0,
        held_out=True,
    )


SCENES = (
    _bounces("ball bounces obliquely and ends up rolling", 1.0, 2.0, 0.0, 0.3, 0.7),
    _bounces("ball bounces obliquely and slips", 3.0, 1.0, 0.0, 0.2, 0.7),
    _bounces("spinning ball dropped straight leaves sideways", 0.0, 2.0, 50.0, 0.5, 0.9),
    EverydayScene(
        "disc bounces off a wall at 45 degrees",
        BOUNCE,
        "A smooth elastic disc leaves a wall under the angle at which it came, as fast.",
        _at_wall,
        0.8,
        (
            Measure("angle to the normal", "degrees", _leaving_angle, _half_right, 2.0),
            Measure("speed", "m/s", last_speed, one, 0.02, relative=True),
        ),
        engines=BULLETS,
        held_out=True,
    ),
    # Above 1.23 it leaves the ground as it turns; in long steps friction slows it before it arrives.
    _curbs("crate trips over a curb", 1.15, True, (1000.0, 200.0)),
    _curbs("crate stops at a curb", 0.7, False),
)
