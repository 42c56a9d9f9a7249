"""Impacts with friction, shots at thin plates, heavy on light, curbs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from voxshell.scenes.everyday import forms, impact_laws
from voxshell.scenes.everyday.held_out import bodies
from voxshell.scenes.everyday.impacts import BULLETS
from voxshell.scenes.everyday.scene import (
    EverydayScene,
    Item,
    Measure,
    Stage,
    X,
    Y,
    Z,
    heading,
    share,
    shift,
    turn,
)
from voxshell.scenes.everyday.sliding import as_vector, nothing, one

if TYPE_CHECKING:
    from voxshell.scenes.everyday.scene import Track

BOUNCE, SHOT, CURB = "Bounces with friction", "Shots and hammers", "Curbs"
WEIGHTLESS = (0.0, 0.0, 0.0)

# ---- bounces -------------------------------------------------------------------------------------

_RADIUS = 0.02


def _bounce(
    placement: int, along: float, into: float, spin: float, friction: float, restitution: float
) -> Stage:
    """A weightless ball of 40 mm that hits a slab; ``spin`` rolls it forward."""
    way = turn(Z, heading(placement))
    ball = forms.ball(_RADIUS)
    place = shift(0.1 * share(placement), 0.1 * share(placement, 2), _RADIUS + 0.05 * into)
    velocity = way[:3, 0] * along - way[:3, 2] * into
    pose = place @ way @ turn(X, 2.0 * share(placement, 3))
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
            "share": float(forms.matter(ball, 1.0).inertia[0, 0]) / _RADIUS**2,
        },
        world_from_ramp=way[:3, :3],
    )


def _after(track: Track) -> tuple[float, float]:
    return impact_laws.rough_bounce(
        *(track.fact("along"), track.fact("into"), track.fact("spin"), _RADIUS),
        *(track.fact("share"), track.stage.friction, track.stage.restitution),
    )


def _along(track: Track) -> float:
    return float(track.velocities["body"][-1] @ track.stage.world_from_ramp[:, 0])


def _up(track: Track) -> float:
    return float(track.velocities["body"][-1, 2])


def _true_up(track: Track) -> float:
    return track.stage.restitution * track.fact("into")


def _spin(track: Track) -> float:
    return float(track.spins["body"][-1] @ track.stage.world_from_ramp[:, 1])


_AFTER_BOUNCE = (
    Measure("speed along the ground", "m/s", _along, lambda t: _after(t)[0], 0.05, relative=True),
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


def _speed(track: Track) -> float:
    return float(np.linalg.norm(track.velocities["body"][-1]))


# ---- shots ---------------------------------------------------------------------------------------

_SHOT, _PLATE, _PELLET = 20.0, 0.001, 0.005


def _aim(placement: int) -> np.ndarray:
    """Where a shot goes along x, (4, 4)."""
    return turn(Z, heading(placement)) @ turn(Y, share(placement))


def _at_plate(placement: int) -> Stage:
    """A ball of 10 mm shot at 20 m/s at a fixed plate of 0.5 m and 1 mm."""
    way = _aim(placement)
    ball = forms.ball(_PELLET)
    start = shift(-0.5, 0.1 * share(placement, 2), 0.1 * share(placement, 3))
    return Stage(
        (
            Item("plate", forms.box(_PLATE, 0.5, 0.5), way, mass=0.0),
            Item("body", ball, way @ start, 0.004, velocity=as_vector(way[:3, 0] * _SHOT)),
        ),
        gravity=WEIGHTLESS,
        world_from_ramp=way[:3, :3],
    )


def _in_plate(track: Track) -> float:
    """How deep the ball's foremost point gets into the plate, metres; more than its thickness: through."""
    return float(track.path("body")[:, 0].max()) - 0.5 + _PELLET + 0.5 * _PLATE


_WASHER = (0.01, 0.005, 0.002)


def _washer_at_plate(placement: int) -> Stage:
    """A washer of 20 mm thrown at 20 m/s at the plate, flipping at 50 rad/s."""
    stage = _at_plate(placement)
    plate, ball = stage.items
    about = stage.world_from_ramp[:, 1] * 50.0
    pose = ball.pose @ turn(Y, 1.5 * share(placement, 4))
    washer = Item(
        *("body", forms.tube(*_WASHER), pose, 0.004), velocity=ball.velocity, spin=as_vector(about)
    )
    return Stage(
        (plate, washer), gravity=WEIGHTLESS, world_from_ramp=stage.world_from_ramp
    )


def _stays_in_front(track: Track) -> float:
    return float(track.path("body")[:, 0].max() < 0.5)


_TARGET, _SLUG = 0.4, 0.1


def _at_free_plate(placement: int) -> Stage:
    """A ball of 0.1 kg shot at 20 m/s at the middle of a free plate of 0.4 kg and 1 mm."""
    way = _aim(placement)
    return Stage(
        (
            Item("plate", forms.box(_PLATE, 0.3, 0.3), way, _TARGET),
            Item(
                *("body", forms.ball(0.01), way @ shift(-0.2, 0.0, 0.0), _SLUG),
                velocity=as_vector(way[:3, 0] * _SHOT),
            ),
        ),
        gravity=WEIGHTLESS,
        world_from_ramp=way[:3, :3],
    )


def _plate_speed(track: Track) -> float:
    return float(track.velocities["plate"][-1] @ track.stage.world_from_ramp[:, 0])


def _shared_speed(_: Track) -> float:
    return _SHOT * _SLUG / (_SLUG + _TARGET)


def _stays_behind(track: Track) -> float:
    """Whether the ball's center is never beyond the plate's."""
    ball = track.poses["body"][:, :3, 3] @ track.stage.world_from_ramp[:, 0]
    plate = track.poses["plate"][:, :3, 3] @ track.stage.world_from_ramp[:, 0]
    return float((ball < plate).all())


_CAN, _RATTLE, _THROWN = (0.04, 0.1, 0.001), 0.008, 5.0


def _rattle(placement: int) -> Stage:
    """A smooth elastic marble, weightless, thrown at 5 m/s in a closed can with walls of 1 mm."""
    toward = turn(Z, heading(placement)) @ turn(Y, 0.7 + 0.5 * share(placement))
    return Stage(
        (
            Item("can", bodies.closed_can(*_CAN), mass=0.0),
            Item(
                *("body", forms.ball(_RATTLE), shift(0.005, 0.0, 0.01), 0.005),
                velocity=as_vector(toward[:3, 0] * _THROWN),
            ),
        ),
        friction=0.0,
        restitution=1.0,
        gravity=WEIGHTLESS,
    )


def _stays_inside(track: Track) -> float:
    """Whether the marble's center never gets into the can's walls."""
    places = track.poses["body"][:, :3, 3]
    radius, height, wall = _CAN
    inside = np.hypot(places[:, 0], places[:, 1]).max() < radius - wall
    return float(inside and np.abs(places[:, 2]).max() < 0.5 * height - wall)


def _thrown(_: Track) -> float:
    return _THROWN


def _hammer(placement: int) -> Stage:
    """A block of 1000 kg hits a cube of 10 mm and 1 g at 1 m/s, face on face; weightless, e = 0.5."""
    way = _aim(placement)
    return Stage(
        (
            Item(
                *("hammer", forms.box(0.5, 0.5, 0.5), way @ shift(-0.305, 0.0, 0.0), 1000.0),
                velocity=as_vector(way[:3, 0]),
            ),
            Item("body", forms.box(0.01, 0.01, 0.01), way, 0.001),
        ),
        friction=0.0,
        restitution=0.5,
        gravity=WEIGHTLESS,
        world_from_ramp=way[:3, :3],
    )


def _hit_speed(_: Track) -> float:
    return 1.5 * 1000.0 / 1000.001


def _hammer_speed(track: Track) -> float:
    return float(track.velocities["hammer"][-1] @ track.stage.world_from_ramp[:, 0])


_ROD, _ARM, _CUE = (0.02, 0.4, 0.02), 0.15, 0.3


def _at_rod(placement: int) -> Stage:
    """A smooth elastic ball of 0.3 kg hits a free rod of 1 kg and 0.4 m, 0.15 m from its middle, at 2 m/s."""
    way = _aim(placement)
    rod = forms.box(*_ROD)
    ball = forms.ball(0.02)
    return Stage(
        (
            Item("rod", rod, way, 1.0),
            Item(
                *("body", ball, way @ shift(-0.08, _ARM, 0.0), _CUE),
                velocity=as_vector(way[:3, 0] * 2.0),
            ),
        ),
        friction=0.0,
        restitution=1.0,
        gravity=WEIGHTLESS,
        facts={"inertia": float(forms.matter(rod, 1.0).inertia[2, 2])},
        world_from_ramp=way[:3, :3],
    )


def _true_rod(track: Track) -> tuple[float, float, float]:
    return impact_laws.rod_impact(2.0, _CUE, 1.0, _ARM, track.fact("inertia"), 1.0)


def _rod_speed(track: Track) -> float:
    return float(track.velocities["rod"][-1] @ track.stage.world_from_ramp[:, 0])


def _rod_spin(track: Track) -> float:
    """In the sense in which the ball turns it, rad/s."""
    return float(-track.spins["rod"][-1] @ track.stage.world_from_ramp[:, 2])


# ---- curbs ---------------------------------------------------------------------------------------

_SIDE = 0.1


def _curb(placement: int, factor: float) -> Stage:
    """A cube of 0.1 m that slides into a curb of 5 mm, a millimetre away, at a multiple of its limit."""
    way = turn(Z, heading(placement))
    speed = factor * impact_laws.trip_speed(_SIDE)
    curb = forms.box(0.05, 0.3, 0.01)
    return Stage(
        (
            Item("ground", forms.slab(1.0), way, mass=0.0),
            Item("curb", curb, way @ shift(0.5 * _SIDE + 0.026, 0.0, 0.0), mass=0.0),
            Item(
                *("body", forms.box(_SIDE, _SIDE, _SIDE), way @ shift(0.0, 0.0, 0.5 * _SIDE)),
                velocity=as_vector(way[:3, 0] * speed),
            ),
        ),
        friction=1.0,
        world_from_ramp=way[:3, :3],
    )


def _turns_over(track: Track) -> float:
    """Whether the cube's foremost face comes to lie below."""
    down = track.poses["body"][-1][:3, 0] @ track.stage.world_from_ramp
    return float(down[2] < -0.7)


def _curbs(name: str, factor: float, happens: bool) -> EverydayScene:
    return EverydayScene(
        name,
        CURB,
        f"Without restitution a cube turns over a low curb above sqrt(8 (sqrt 2 - 1) g s / 3), 1.04 m/s; here "
        f"{factor:g} of that.",
        lambda i: _curb(i, factor),
        1.2,
        (Measure("turns over", "", _turns_over, one if happens else nothing, 0.0),),
        most=10,
        needs=1.2,
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
            Measure("speed", "m/s", _speed, one, 0.02, relative=True),
        ),
        engines=BULLETS,
        held_out=True,
    ),
    EverydayScene(
        "ball of 10 mm shot at a plate of 1 mm at 20 m/s",
        SHOT,
        "Nothing passes a fixed plate.",
        _at_plate,
        0.2,
        (
            Measure(
                "depth in the plate", "mm", _in_plate, nothing, 5e-4, scale=1e3, signed=1
            ),
        ),
        held_out=True,
    ),
    EverydayScene(
        "washer thrown at a plate of 1 mm at 20 m/s",
        SHOT,
        "Nothing passes a fixed plate.",
        _washer_at_plate,
        0.2,
        (Measure("stays in front", "", _stays_in_front, one, 0.0),),
        held_out=True,
    ),
    EverydayScene(
        "ball shot at a free plate of 1 mm",
        SHOT,
        "Without restitution ball and plate go on with one speed, m v / (m + M) = 4 m/s.",
        _at_free_plate,
        0.2,
        (
            Measure("speed of the plate", "m/s", _plate_speed, _shared_speed, 0.05, relative=True),
            Measure("ball stays behind", "", _stays_behind, one, 0.0),
        ),
        held_out=True,
    ),
    EverydayScene(
        "marble rattles in a closed can",
        SHOT,
        "Nothing leaves a closed can; a smooth elastic marble keeps its speed.",
        _rattle,
        1.0,
        (
            Measure("stays inside", "", _stays_inside, one, 0.0),
            Measure("speed", "m/s", _speed, _thrown, 0.05, relative=True),
        ),
        engines=BULLETS,
        most=10,
        held_out=True,
    ),
    EverydayScene(
        "hammer of 1000 kg hits a cube of 1 g",
        SHOT,
        "Momentum and Newton's law: the cube leaves with (1 + e) M / (M + m) of the speed, e 0.5, and the hammer "
        "goes on.",
        _hammer,
        0.2,
        (
            Measure("speed of the cube", "m/s", _along, _hit_speed, 0.05, relative=True),
            Measure("speed of the hammer", "m/s", _hammer_speed, one, 1e-3, relative=True),
        ),
        engines=BULLETS,
        held_out=True,
    ),
    EverydayScene(
        "ball hits a rod near its end",
        SHOT,
        "Impulse 2 v / (1 / m + 1 / M + d2 / I) of a smooth elastic ball (Newton's law where they touch).",
        _at_rod,
        0.15,
        (
            Measure("speed of the ball", "m/s", _along, lambda t: _true_rod(t)[0], 0.03),
            Measure("speed of the rod", "m/s", _rod_speed, lambda t: _true_rod(t)[1], 0.05, True),
            Measure("spin of the rod", "rad/s", _rod_spin, lambda t: _true_rod(t)[2], 0.05, True),
        ),
        engines=BULLETS,
        held_out=True,
    ),
    _curbs("cube trips over a curb", 1.3, True),
    _curbs("cube stops at a curb", 0.7, False),
)
