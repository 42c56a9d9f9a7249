"""Shots at thin plates, a marble in a can, heavy on light, a rod that is hit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from voxshell_studies.scenes.everyday import forms, impact_laws
from voxshell_studies.scenes.everyday.held_out import bodies
from voxshell_studies.scenes.everyday.held_out.bounces import WEIGHTLESS, last_speed
from voxshell_studies.scenes.everyday.impacts import BULLETS
from voxshell_studies.scenes.everyday.scene import (
    EverydayScene,
    Item,
    Measure,
    Stage,
    Y,
    Z,
    heading,
    scatter,
    shift,
    turn,
)
from voxshell_studies.scenes.everyday.sliding import as_vector, end_speed, nothing, one

if TYPE_CHECKING:
    from voxshell_studies.scenes.everyday.scene import Track

SHOT = "Shots and hammers"

_SHOT, _PLATE, _PELLET = 20.0, 0.001, 0.005


def _aim(placement: int) -> np.ndarray:
    """Where a shot goes along x, (4, 4)."""
    return turn(Z, heading(placement)) @ turn(Y, scatter(placement))


def _at_plate(placement: int) -> Stage:
    """A ball of 10 mm shot at 20 m/s at a fixed plate of 0.5 m and 1 mm."""
    way = _aim(placement)
    ball = forms.ball(_PELLET)
    start = shift(-0.5, 0.1 * scatter(placement, 2), 0.1 * scatter(placement, 3))
    return Stage(
        (
            Item("plate", forms.box(_PLATE, 0.5, 0.5), way, mass=0.0),
            Item("body", ball, way @ start, 0.004, velocity=as_vector(way[:3, 0] * _SHOT)),
        ),
        gravity=WEIGHTLESS,
        world_from_ramp=way[:3, :3],
    )


def _in_plate(track: Track) -> float:
    """How deep the ball's foremost point gets into the plate, meters; more than its thickness: through."""
    return float(track.path("body")[:, 0].max()) - 0.5 + _PELLET + 0.5 * _PLATE


_WASHER = (0.01, 0.005, 0.002)


def _washer_at_plate(placement: int) -> Stage:
    """A washer of 20 mm thrown at 20 m/s at the plate, flipping at 50 rad/s."""
    stage = _at_plate(placement)
    plate, ball = stage.items
    about = stage.world_from_ramp[:, 1] * 50.0
    pose = ball.pose @ turn(Y, 1.5 * scatter(placement, 4))
    washer = Item(
        *("body", forms.tube(*_WASHER), pose, 0.004), velocity=ball.velocity, spin=as_vector(about)
    )
    return Stage((plate, washer), gravity=WEIGHTLESS, world_from_ramp=stage.world_from_ramp)


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
    toward = turn(Z, heading(placement)) @ turn(Y, 0.7 + 0.5 * scatter(placement))
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


SCENES = (
    EverydayScene(
        "ball of 10 mm shot at a plate of 1 mm at 20 m/s",
        SHOT,
        "Nothing passes a fixed plate.",
        _at_plate,
        0.2,
        (Measure("depth in the plate", "mm", _in_plate, nothing, 5e-4, scale=1e3, signed=1),),
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
            Measure("speed", "m/s", last_speed, _thrown, 0.05, relative=True),
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
            Measure("speed of the cube", "m/s", end_speed, _hit_speed, 0.05, relative=True),
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
            Measure("speed of the ball", "m/s", end_speed, lambda t: _true_rod(t)[0], 0.03),
            Measure("speed of the rod", "m/s", _rod_speed, lambda t: _true_rod(t)[1], 0.05, True),
            Measure("spin of the rod", "rad/s", _rod_spin, lambda t: _true_rod(t)[2], 0.05, True),
        ),
        engines=BULLETS,
        held_out=True,
    ),
)
