"""Impacts: straight drops, billiards, a cradle, dice, dominoes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from voxshell_studies.scenes.everyday import forms, laws
from voxshell_studies.scenes.everyday.rolling import lowest_vertex
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
from voxshell_studies.scenes.everyday.sliding import as_vector, nothing, one

if TYPE_CHECKING:
    from voxshell_studies.scenes.everyday.scene import Form, Track

DROP, HIT, MANY = "Straight drops", "Balls that hit balls", "Dice and dominoes"
BULLETS = ("voxshell", "bullet")
"""MuJoCo has no coefficient of restitution."""

# ---- drops ---------------------------------------------------------------------------------------

_BOUNCE = 0.9


def _dropped_ball(placement: int, ground: Form) -> Stage:
    ball = forms.ball(0.05)
    place = shift(0.3 * scatter(placement), 0.3 * scatter(placement, 2), 0.35)
    pose = place @ turn(Z, heading(placement)) @ turn(X, 3.0 * scatter(placement, 3))
    return Stage((Item("ground", ground, mass=0.0), Item("body", ball, pose)), restitution=_BOUNCE)


def _rebound(track: Track) -> tuple[np.ndarray, np.ndarray]:
    """Velocities before and after the first rebound, m/s; NaN where there is none."""
    speeds = track.velocities["body"]
    up = np.nonzero(speeds[:, 2] > 0.0)[0]
    if not len(up) or up[0] < 1:
        return np.full(3, np.nan), np.full(3, np.nan)
    before = int(np.argmin(speeds[: up[0] + 1, 2]))
    return speeds[before], speeds[int(up[0])]


def _kept_speed(track: Track) -> float:
    before, after = _rebound(track)
    return float(-after[2] / before[2])


def _sideways(track: Track) -> float:
    before, after = _rebound(track)
    return float(np.hypot(after[0], after[1]) / -before[2])


def _bounce(_: Track) -> float:
    return _BOUNCE


def _drops(name: str, ground: Form | None, length: float = 0.0) -> EverydayScene:
    return EverydayScene(
        name,
        DROP,
        "Newton's impact law along the normal, restitution 0.9; a ball that falls straight has no reason to "
        "leave sideways.",
        lambda i: _dropped_ball(i, ground or forms.slab(length)),
        0.5,
        (
            Measure("speed kept", "", _kept_speed, _bounce, 0.02, relative=True),
            Measure("sideways, of the speed of impact", "%", _sideways, nothing, 0.01, scale=100.0),
        ),
        engines=BULLETS,
    )


def _flat_cube(placement: int) -> Stage:
    cube = forms.box(0.05, 0.05, 0.05)
    place = shift(0.3 * scatter(placement), 0.3 * scatter(placement, 2), 0.125)
    return Stage(
        (
            Item("ground", forms.slab(1.0), mass=0.0),
            Item("body", cube, place @ turn(Z, heading(placement))),
        )
    )


def _moved_aside(track: Track) -> float:
    return float(np.linalg.norm(track.path("body")[-1, :2]))


def _turned_at_end(track: Track) -> float:
    return float(np.degrees(track.turned("body")[-1]))


# ---- balls ---------------------------------------------------------------------------------------


def _billiards(placement: int) -> Stage:
    """A ball of 60 mm hits another one off center, both smooth, elastic and weightless."""
    radius = 0.03
    offset = radius * (0.2 + 0.7 * abs(scatter(placement, 2)))
    way = turn(Z, heading(placement))
    spun = turn(Y, 2.0 * scatter(placement, 3))
    ball = forms.ball(radius)
    return Stage(
        (
            Item(
                "cue",
                ball,
                way @ shift(-0.1, offset, 0.0) @ spun,
                velocity=as_vector(way[:3, 0]),
            ),
            Item("object", ball, spun),
        ),
        friction=0.0,
        restitution=1.0,
        gravity=(0.0, 0.0, 0.0),
        facts={"offset": offset, "radius": radius},
    )


def _impact(track: Track) -> tuple[float, float]:
    return laws.oblique_impact(1.0, track.fact("offset"), track.fact("radius"), 1.0)


def _last(track: Track, name: str) -> float:
    return float(np.linalg.norm(track.velocities[name][-1]))


def _cradle(placement: int) -> Stage:
    """Five balls in a row, a millimeter apart, and one that comes at 1 m/s; weightless and elastic."""
    ball = forms.ball(0.03)
    way = turn(Z, heading(placement)) @ turn(Y, 1.0 * scatter(placement))
    spun = turn(X, 2.0 * scatter(placement, 2))
    row = tuple(
        Item(f"ball {i + 1}", ball, way @ shift(0.061 * i, 0.0, 0.0) @ spun) for i in range(5)
    )
    first = Item("cue", ball, way @ shift(-0.1, 0.0, 0.0) @ spun, velocity=as_vector(way[:3, 0]))
    return Stage(
        (first, *row),
        friction=0.0,
        restitution=1.0,
        gravity=(0.0, 0.0, 0.0),
        world_from_ramp=way[:3, :3],
    )


def _last_ball(track: Track) -> float:
    return float(track.velocities["ball 5"][-1] @ track.stage.world_from_ramp[:, 0])


def _fastest_other(track: Track) -> float:
    others = [name for name in track.velocities if name != "ball 5"]
    return max(_last(track, name) for name in others)


# ---- dice and dominoes ---------------------------------------------------------------------------


def _dice(placement: int) -> Stage:
    """Five dice of 16 mm thrown onto a slab of 2 m, which none of them can leave."""
    die = forms.box(0.016, 0.016, 0.016)
    items = [Item("ground", forms.slab(2.0), mass=0.0)]
    for i in range(5):
        k = 5 * placement + i
        pose = (
            shift(-0.1 + 0.05 * i, 0.1 * scatter(k), 0.15)
            @ turn(Z, heading(k))
            @ turn(X, 3.0 * scatter(k, 2))
        )
        spin = (20.0 * scatter(k, 3), 20.0 * scatter(k, 4), 20.0 * scatter(k, 5))
        velocity = (0.5 * scatter(k, 6), 0.5, 0.0)
        items.append(Item(f"die {i + 1}", die, pose, 0.005, velocity=velocity, spin=spin))
    return Stage(tuple(items), restitution=0.3)


def _dice_height(track: Track) -> float:
    """The height of a die's center that differs most from half its side, meters; NaN if one is lost."""
    heights = np.array([poses[-1][2, 3] for poses in track.poses.values()])
    return float(heights[np.argmax(np.abs(heights - 0.008))])


def _half_die(_: Track) -> float:
    return 0.008


def _dice_speed(track: Track) -> float:
    return max(_last(track, name) for name in track.velocities)


_DOMINOES = 10
_DOMINO = (0.008, 0.024, 0.048)


def _dominoes(placement: int) -> Stage:
    """Ten dominoes 24 mm apart in a heading; the first one is pushed at its top."""
    row = turn(Z, heading(placement))
    form = forms.box(*_DOMINO)
    items = [Item("ground", forms.slab(1.0), turn(Z, heading(5 * placement)), mass=0.0)]
    for i in range(_DOMINOES):
        pose = row @ shift(0.024 * (i - 4.5), 0.0, 0.5 * _DOMINO[2])
        # 20 degrees a tenth of a second at its start: beyond its balance on the edge, 9.5 degrees.
        spin = as_vector(row[:3, :3] @ (0.0, 6.0, 0.0)) if i == 0 else (0.0, 0.0, 0.0)
        velocity = as_vector(row[:3, 0] * 6.0 * 0.5 * _DOMINO[2]) if i == 0 else (0.0, 0.0, 0.0)
        items.append(Item(f"domino {i + 1}", form, pose, 0.02, velocity=velocity, spin=spin))
    return Stage(tuple(items), friction=0.4)


def _fallen(track: Track) -> float:
    return float(sum(track.turned(name)[-1] > math.radians(30.0) for name in track.poses))


def _all_dominoes(_: Track) -> float:
    return float(_DOMINOES)


def _still_dominoes(placement: int) -> Stage:
    stage = _dominoes(placement)
    items = tuple(Item(item.name, item.form, item.pose, item.mass) for item in stage.items)
    return Stage(items, friction=0.4)


SCENES = (
    _drops("ball drops straight, plane", forms.PLANE),
    _drops("ball drops straight, slab of 1 m", None, 1.0),
    EverydayScene(
        "cube drops flat on a slab",
        DROP,
        "An inelastic cube that falls flat stays where it lands and turns nowhere (symmetry).",
        _flat_cube,
        1.0,
        (
            Measure("aside", "mm", _moved_aside, nothing, 1e-4, scale=1e3),
            Measure("turned", "degrees", _turned_at_end, nothing, 0.1),
            Measure(
                "lowest vertex over the ground", "mm", lowest_vertex, nothing, 2.5e-4, scale=1e3
            ),
        ),
    ),
    EverydayScene(
        "billiard balls, off center",
        HIT,
        "Equal smooth elastic balls: the struck one leaves along the line of centers with the component "
        "along it, the other keeps the component across it.",
        _billiards,
        0.5,
        (
            Measure(
                "speed of the one that came",
                "m/s",
                lambda t: _last(t, "cue"),
                lambda t: _impact(t)[0],
                0.03,
            ),
            Measure(
                "speed of the one that stood",
                "m/s",
                lambda t: _last(t, "object"),
                lambda t: _impact(t)[1],
                0.03,
            ),
        ),
        engines=BULLETS,
    ),
    EverydayScene(
        "cradle of five balls",
        HIT,
        "Equal elastic balls that are apart exchange their velocities one pair after another: the last one "
        "leaves with all of it.",
        _cradle,
        0.6,
        (
            Measure("speed of the last ball", "m/s", _last_ball, one, 0.03),
            Measure("fastest of the others", "m/s", _fastest_other, nothing, 0.03),
        ),
        engines=BULLETS,
        shown=True,
    ),
    EverydayScene(
        "dice come to rest on a face",
        MANY,
        "A cube at rest on a flat ground lies on a face: its center is half a side above it, and it is still.",
        _dice,
        4.0,
        (
            Measure("height of a center", "mm", _dice_height, _half_die, 1e-4, scale=1e3),
            Measure("fastest at the end", "mm/s", _dice_speed, nothing, 5e-3, scale=1e3),
        ),
        most=10,
        needs=4.0,
        heavy=True,
    ),
    EverydayScene(
        "ten dominoes fall",
        MANY,
        "Their distance is half their height: each one that falls hits the next above its balance.",
        _dominoes,
        3.0,
        (Measure("fallen", "of 10", _fallen, _all_dominoes, 0.0),),
        most=10,
        shown=True,
        needs=3.0,
        heavy=True,
    ),
    EverydayScene(
        "ten dominoes stand",
        MANY,
        "Nobody pushes them.",
        _still_dominoes,
        5.0,
        (Measure("fallen", "of 10", _fallen, nothing, 0.0),),
        most=5,
        heavy=True,
    ),
)
