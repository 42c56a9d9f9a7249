"""Races, rails, a turntable, a cone, and a ball that leaves a table."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from voxshell_studies.scenes.everyday import forms, laws
from voxshell_studies.scenes.everyday.held_out import bodies
from voxshell_studies.scenes.everyday.held_out.pulling import RIGHT_ANGLE, in_groove
from voxshell_studies.scenes.everyday.rolling import BALL, ROLLS, rolled_way
from voxshell_studies.scenes.everyday.scene import (
    EverydayScene,
    Item,
    Measure,
    Stage,
    X,
    Y,
    Z,
    heading,
    scatter,
    shift,
    turn,
)
from voxshell_studies.scenes.everyday.sliding import as_vector, downhill, farthest, nothing

if TYPE_CHECKING:
    from voxshell_studies.scenes.everyday.scene import Form, Track

RACE = "Races, rails and turntables"

WAY = Measure("distance", "m", downhill, rolled_way, 0.05, relative=True)


def _any_way(placement: int) -> np.ndarray:
    """A rotation for a ball, (4, 4)."""
    return turn(Z, heading(5 * placement)) @ turn(X, 2.0 * scatter(placement))


@cache
def inertia_ratio(form: Form, axis: int, radius: float) -> float:
    """I / (m r2) of the mesh's uniform solid."""
    return float(np.diag(forms.matter(form, 1.0).inertia)[axis]) / radius**2


# ---- races, rails, turntables --------------------------------------------------------------------

SLOPE = math.radians(10.0)
_RACERS = {
    "hoop": (lambda: forms.tube(BALL, 0.045, 0.03, forms.FINE), 2),
    "disc": (lambda: forms.cylinder(BALL, 0.03, forms.FINE), 2),
    "ball": (lambda: forms.ball(BALL), 0),
}


def _race(placement: int) -> Stage:
    """A hoop, a disc and a ball of one radius, side by side on a slope."""
    ramp = turn(Z, heading(placement)) @ turn(Y, SLOPE)
    items = [Item("ground", forms.PLANE, ramp, mass=0.0)]
    for i, (name, (form, _)) in enumerate(_RACERS.items()):
        lie = bodies.lying(BALL) @ turn(Z, heading(3 * placement + i))
        items.append(Item(name, form(), ramp @ shift(0.0, 0.2 * (i - 1), 0.0) @ lie))
    return Stage(tuple(items), world_from_ramp=ramp[:3, :3])


def _track_way(track: Track, name: str) -> float:
    return float(track.path(name)[-1, 0])


def _racer_way(track: Track, name: str) -> float:
    form, axis = _RACERS[name]
    pull = laws.roll_acceleration(SLOPE, inertia_ratio(form(), axis, BALL))
    return laws.way(0.0, pull, track.seconds, track.time_step)


_RAIL_BALL, _HALF_GAUGE = 0.03, 0.018


def _on_rails(placement: int) -> Stage:
    """A ball on the edges of two square bars, 36 mm apart, on a slope of 10 degrees."""
    ramp = turn(Z, heading(placement)) @ turn(Y, SLOPE)
    ball = forms.ball(_RAIL_BALL)
    bar = forms.box(2.0, 0.02, 0.02)
    height = math.sqrt(_RAIL_BALL**2 - _HALF_GAUGE**2)
    rails = [
        Item(name, bar, ramp @ shift(0.0, side * (_HALF_GAUGE + 0.01), -0.01), mass=0.0)
        for name, side in (("left rail", 1.0), ("right rail", -1.0))
    ]
    ball_at = ramp @ shift(-0.5, 0.0, height) @ _any_way(placement)
    return Stage(
        (*rails, Item("body", ball, ball_at)),
        facts={"slope": SLOPE, "speed": 0.0, "inertia_ratio": inertia_ratio(ball, 0, height)},
        world_from_ramp=ramp[:3, :3],
    )


def _ball_in_groove(placement: int) -> Stage:
    ball = forms.ball(BALL)
    lie = shift(0.0, 0.0, BALL * math.sqrt(2.0)) @ _any_way(placement)
    stage = in_groove(ball, lie, 10.0, placement, 0.5)
    ratio = inertia_ratio(ball, 0, BALL * math.sin(RIGHT_ANGLE))
    return Stage(
        stage.items,
        facts={**stage.facts, "speed": 0.0, "inertia_ratio": ratio},
        world_from_ramp=stage.world_from_ramp,
    )


def _up_and_down(placement: int) -> Stage:
    """A ball that rolls up a slope of 10 degrees at 1 m/s."""
    ramp = turn(Z, heading(placement)) @ turn(Y, SLOPE)
    ball = forms.ball(BALL)
    return Stage(
        (
            Item("ground", forms.slab(2.0), ramp, mass=0.0),
            Item(
                *("body", ball, ramp @ shift(0.2, 0.0, BALL) @ _any_way(placement)),
                velocity=as_vector(-ramp[:3, 0]),
                spin=as_vector(-ramp[:3, 1] / BALL),
            ),
        ),
        facts={"slope": SLOPE, "speed": -1.0, "inertia_ratio": inertia_ratio(ball, 0, BALL)},
        world_from_ramp=ramp[:3, :3],
    )


def _highest(track: Track) -> float:
    """The farthest that the ball gets uphill, meters."""
    return float(-track.path("body")[:, 0].min())


def _true_highest(track: Track) -> float:
    loss = laws.roll_acceleration(SLOPE, track.fact("inertia_ratio"))
    return laws.way_to_stop(1.0, loss, track.time_step)


_TABLE_SPIN, _ROLL_SPEED = 4.0, 0.2


def _turntable(placement: int) -> Stage:
    """A ball that rolls at 0.2 m/s on a disc which turns at 4 rad/s, from 0.2 m off its middle."""
    way = turn(Z, heading(placement))
    table = forms.cylinder(0.6, 0.05, 192)

    def path(time: float) -> np.ndarray:
        return way @ turn(Z, _TABLE_SPIN * time) @ shift(0.0, 0.0, -0.025)

    ball = forms.ball(BALL)
    x = 0.2
    # Inward; what touches moves with the table: v - r w_y = 0 and r w_x = table's speed there.
    spin = (_TABLE_SPIN * x / BALL, -_ROLL_SPEED / BALL, 0.0)
    return Stage(
        (
            Item("table", table, path(0.0), path=path),
            Item(
                *("body", ball, way @ shift(x, 0.0, BALL) @ _any_way(placement)),
                velocity=as_vector(-way[:3, 0] * _ROLL_SPEED),
                spin=as_vector(way[:3, :3] @ spin),
            ),
        ),
        facts={"inertia_ratio": inertia_ratio(ball, 0, BALL)},
        world_from_ramp=way[:3, :3],
    )


def _velocity_turn(track: Track) -> float:
    """By how much the ball's velocity has turned, degrees."""
    velocities = track.velocities["body"]
    angles = np.unwrap(np.arctan2(velocities[:, 1], velocities[:, 0]))
    return math.degrees(float(angles[-1] - angles[0]))


def _true_velocity_turn(track: Track) -> float:
    return math.degrees(
        laws.turntable_rate(_TABLE_SPIN, track.fact("inertia_ratio")) * track.seconds
    )


def _speed(track: Track) -> float:
    return float(np.linalg.norm(track.velocities["body"][-1, :2]))


def _roll_speed(_: Track) -> float:
    return _ROLL_SPEED


_CONE, _CONE_RATE = (0.04, 0.12), 2.0


def _rolling_cone(placement: int) -> Stage:
    """A cone on its side that rolls about its apex at 2 rad/s."""
    way = turn(Z, heading(placement))
    radius, height = _CONE
    slope = math.atan2(radius, height)
    cone = bodies.cone(*_CONE)
    lie = turn(Y, 0.5 * math.pi - slope) @ turn(Z, 2.0 * math.pi / forms.FINE * placement)
    x = float((lie[:3, :3] @ forms.center_of(cone))[0])
    return Stage(
        (
            Item("ground", forms.slab(1.0), mass=0.0),
            Item(
                *("body", cone, way @ lie),
                velocity=as_vector(way[:3, 1] * _CONE_RATE * x),
                spin=as_vector(-way[:3, 0] * _CONE_RATE / math.tan(slope)),
            ),
        ),
        world_from_ramp=way[:3, :3],
    )


def _cone_turn(track: Track) -> float:
    """Of the cone's axis about the vertical, degrees."""
    axes = track.poses["body"][:, :3, 2]
    angles = np.unwrap(np.arctan2(axes[:, 1], axes[:, 0]))
    return math.degrees(float(angles[-1] - angles[0]))


def _true_cone_turn(track: Track) -> float:
    return math.degrees(_CONE_RATE * track.seconds)


_EDGE_SPEED, _EDGE_DROP, _MARBLE = 1.0, 0.4, 0.02


def _off_table(placement: int) -> Stage:
    """A ball of 40 mm that rolls at 1 m/s toward the edge of a table, 0.2 m away."""
    way = turn(Z, heading(placement))
    ball = forms.ball(_MARBLE)
    pose = way @ shift(0.3, 0.1 * scatter(placement, 2), _MARBLE) @ _any_way(placement)
    return Stage(
        (
            Item("table", forms.slab(1.0), way, mass=0.0),
            Item(
                *("body", ball, pose),
                velocity=as_vector(way[:3, 0] * _EDGE_SPEED),
                spin=as_vector(way[:3, 1] * _EDGE_SPEED / _MARBLE),
            ),
        ),
        world_from_ramp=way[:3, :3],
    )


def _throw(track: Track) -> float:
    """How far from the edge the ball is when it has fallen by 0.4 m, meters; NaN where it never has."""
    path = track.path("body")
    below = np.nonzero(path[:, 2] < -_EDGE_DROP)[0]
    if not len(below):
        return math.nan
    last = int(below[0])
    part = (path[last - 1, 2] + _EDGE_DROP) / (path[last - 1, 2] - path[last, 2])
    return float(path[last - 1, 0] + part * (path[last, 0] - path[last - 1, 0])) - 0.2


def _true_throw(track: Track) -> float:
    # Steps put a falling body g h t / 2 lower.
    h = track.time_step
    return _EDGE_SPEED * (math.sqrt(2.0 * _EDGE_DROP / laws.G + 0.25 * h * h) - 0.5 * h)


SCENES = (
    EverydayScene(
        "hoop, disc and ball race down 10 degrees",
        RACE,
        f"{ROLLS}: the ball wins and the hoop loses.",
        _race,
        0.8,
        tuple(
            Measure(
                f"distance of the {name}",
                "m",
                lambda t, name=name: _track_way(t, name),
                lambda t, name=name: _racer_way(t, name),
                0.05,
                relative=True,
            )
            for name in _RACERS
        ),
        held_out=True,
    ),
    EverydayScene(
        "ball rolls down two rails",
        RACE,
        f"{ROLLS}; on rails 2 c apart it rolls with a radius of sqrt(r2 - c2), here 0.8 r.",
        _on_rails,
        0.8,
        (WAY,),
        held_out=True,
    ),
    EverydayScene(
        "ball rolls down a V-groove",
        RACE,
        f"{ROLLS}; between walls at 45 degrees it rolls with a radius of r sin 45 deg.",
        _ball_in_groove,
        0.8,
        (WAY,),
        held_out=True,
    ),
    EverydayScene(
        "ball rolls up a slope and down",
        RACE,
        f"{ROLLS}: up by v2 (1 + I / (m r2)) / (2 g sin a), and back.",
        _up_and_down,
        1.4,
        (
            Measure("farthest uphill", "m", _highest, _true_highest, 0.05, relative=True),
            # Of the way up, 0.41 m.
            Measure("distance at the end", "mm", downhill, rolled_way, 0.02, scale=1e3),
        ),
        needs=1.4,
        held_out=True,
    ),
    EverydayScene(
        "ball rolls on a turntable",
        RACE,
        "Its velocity turns at 2/7 of the table's angular velocity and keeps its size (Weltner 1979).",
        _turntable,
        1.5,
        (
            Measure("turn of the velocity", "degrees", _velocity_turn, _true_velocity_turn, 5.0),
            Measure("speed", "m/s", _speed, _roll_speed, 0.05, relative=True),
        ),
        engines=("voxshell", "bullet"),
        needs=1.5,
        held_out=True,
    ),
    EverydayScene(
        "cone rolls in a circle",
        RACE,
        "A cone that rolls on its side turns about its apex, which stays, at a constant rate.",
        _rolling_cone,
        1.0,
        (
            Measure("turn about the apex", "degrees", _cone_turn, _true_cone_turn, 0.1, True),
            Measure("distance of the apex", "mm", farthest, nothing, 5e-3, scale=1e3),
        ),
        held_out=True,
    ),
    EverydayScene(
        "ball rolls off a table",
        RACE,
        "At v2 above g r it leaves the edge at once and lands v sqrt(2 h / g) away (Galileo), h 0.4 m.",
        _off_table,
        0.6,
        (Measure("distance from the edge", "m", _throw, _true_throw, 0.05, relative=True),),
        held_out=True,
    ),
)
