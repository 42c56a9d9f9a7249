"""Bodies that roll: down ramps, on the level, out of sliding, in a bowl and through a loop."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from voxshell_studies.scenes.everyday import forms, laws
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
from voxshell_studies.scenes.everyday.sliding import (
    as_vector,
    downhill,
    end_speed,
    nothing,
    on_ramp,
    one,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from voxshell_studies.scenes.everyday.scene import Form, Track

ROLL, LEVEL, CURVE = "Rolling down", "Rolling on the level", "Bowl, loop and mug"
BALL = 0.05
"""Radius, meters."""

ROLLS = "Rolling without sliding: a = g sin a / (1 + I / (m r2)), summed over Euler steps"


def rolled_way(track: Track) -> float:
    """How far a rolling body should get, meters."""
    pull = laws.roll_acceleration(track.fact("slope"), track.fact("inertia_ratio"))
    return laws.way(track.fact("speed"), pull, track.seconds, track.time_step)


def _rolls(
    name: str,
    form: Callable[[], Form],
    ground: Callable[[], Form],
    degrees: float,
    *,
    radius: float,
    seconds: float = 0.8,
    speed: float = 0.0,
    axis: int | None = None,
    bar: float = 0.05,
    shown: bool = False,
) -> EverydayScene:
    """Down a ramp.

    ``axis`` is the body's axis of rotation: it starts across the slope. None: a ball, turned in any way.
    """

    def stage(placement: int) -> Stage:
        body = form()
        inertia = float(np.diag(forms.matter(body, 1.0).inertia)[axis or 0])
        made = on_ramp(
            body,
            ground(),
            math.radians(degrees),
            placement,
            friction=0.5,
            at=-0.5 if ground() is not forms.PLANE else 0.0,
            speed=speed,
            spin=(0.0, speed / radius, 0.0),
            facts={"inertia_ratio": inertia / radius**2},
        )
        ramp = np.eye(4)
        ramp[:3, :3] = made.world_from_ramp
        # The body's axis along y of the ramp; a ball in any orientation.
        lie = turn(X, 0.5 * math.pi) @ turn(Z, heading(3 * placement))
        if axis is None:
            lie = turn(Z, heading(5 * placement)) @ turn(X, 2.0 * scatter(placement)) @ lie
        old = made.items[1]
        start = ramp.T @ old.pose
        center = shift(float(start[0, 3]), float(start[1, 3]), radius)
        pose = ramp @ center @ lie
        item = Item("body", body, pose, velocity=old.velocity, spin=old.spin)
        return Stage(
            (made.items[0], item),
            friction=0.5,
            facts=made.facts,
            world_from_ramp=made.world_from_ramp,
        )

    return EverydayScene(
        name,
        ROLL,
        f"{ROLLS}, slope {degrees:g} degrees, inertia of the mesh's uniform solid.",
        stage,
        seconds,
        (Measure("distance", "m", downhill, rolled_way, bar, relative=True),),
        shown=shown,
    )


def _ball() -> Form:
    return forms.ball(BALL)


def _spheroid() -> Form:
    return forms.spheroid(0.05, 0.03)


def _wheel() -> Form:
    return forms.torus(0.04, 0.01, segments=192)


def _plane() -> Form:
    return forms.PLANE


def _slab() -> Form:
    return forms.slab(2.0)


# ---- level ---------------------------------------------------------------------------------------


def _level(placement: int, ground: Form, speed: float) -> Stage:
    ball = forms.ball(BALL)
    made = on_ramp(
        ball, ground, 0.0, placement, friction=0.5, speed=speed, spin=(0.0, speed / BALL, 0.0)
    )
    pose = made.items[1].pose.copy()
    pose[:3, :3] = (turn(Z, heading(5 * placement)) @ turn(X, 2.0 * scatter(placement)))[:3, :3]
    body = Item("body", ball, pose, velocity=made.items[1].velocity, spin=made.items[1].spin)
    return Stage((made.items[0], body), facts=made.facts, world_from_ramp=made.world_from_ramp)


def _aside(track: Track) -> float:
    """Mean speed across the direction, m/s."""
    return float(abs(track.path("body")[-1, 1]) / track.seconds)


def _start_speed(track: Track) -> float:
    return track.fact("speed")


def _levels(name: str, ground: Callable[[], Form], speed: float) -> EverydayScene:
    return EverydayScene(
        name,
        LEVEL,
        "Without rolling friction a ball that rolls keeps its speed and its direction.",
        lambda i: _level(i, ground(), speed),
        1.0,
        (
            Measure(
                "speed after 1 s", "mm/s", end_speed, _start_speed, 0.05, relative=True, scale=1e3
            ),
            Measure("drift aside", "mm/s", _aside, nothing, 2e-3, scale=1e3),
        ),
    )


def _bowled(placement: int) -> Stage:
    stage = _level(placement, forms.PLANE, 1.0)
    old = stage.items[1]
    ratio = float(forms.matter(old.form, 1.0).inertia[0, 0]) / BALL**2
    still = Item("body", old.form, old.pose, velocity=old.velocity)
    return Stage(
        (stage.items[0], still),
        friction=0.3,
        facts={"speed": 1.0, "inertia_ratio": ratio},
        world_from_ramp=stage.world_from_ramp,
    )


def _bowled_speed(track: Track) -> float:
    return laws.bowled_speed(track.fact("speed"), track.fact("inertia_ratio"))


# ---- curves --------------------------------------------------------------------------------------

_BOWL, _MARBLE = 0.2, 0.02


def _in_bowl(placement: int) -> Stage:
    """A marble released 8 degrees aside from the lowest point, in a heading."""
    # The bowl's facets are up to 0.03 mm inside the sphere, and the marble must not begin in them.
    reach, angle = _BOWL - _MARBLE - 5e-5, math.radians(8.0)
    place = turn(Z, heading(placement)) @ shift(
        reach * math.sin(angle), 0.0, -reach * math.cos(angle)
    )
    pose = place @ turn(X, 2.0 * scatter(placement))
    direction = turn(Z, heading(placement))[:3, :3]
    return Stage(
        (
            Item("bowl", forms.bowl(_BOWL), mass=0.0),
            Item("body", forms.ball(_MARBLE), pose),
        ),
        world_from_ramp=direction,
    )


def find_period(values: np.ndarray, time_step: float) -> float:
    """From the zeros of an oscillation about its mean of extremes, seconds; NaN with fewer than three.

    Zeros are interpolated linearly; the mean over all pairs of zeros two apart.

    Example:
        >>> round(find_period(np.cos(np.arange(400) * 0.1), 1.0), 3)
        62.832
    """
    signs = np.nonzero(values[:-1] * values[1:] < 0.0)[0]
    if len(signs) < 3:
        return math.nan
    zeros = signs + values[signs] / (values[signs] - values[signs + 1])
    count = (len(zeros) - 1) // 2
    return float((zeros[2 * count] - zeros[0]) / count * time_step)


def swing_period(track: Track) -> float:
    """Of the body's motion along the ramp's x axis, seconds."""
    places = track.poses["body"][:, :3, 3] @ track.stage.world_from_ramp
    return find_period(places[:, 0], track.time_step)


def _bowl_period(_: Track) -> float:
    # Small angles; at 8 degrees the period is longer by A2 / 16 = 0.12 %.
    angle = math.radians(8.0)
    return laws.bowl_period(_BOWL, _MARBLE) * (1.0 + angle**2 / 16.0)


_LOOP, _RUNNER = 0.3, 0.03


def _in_loop(placement: int, factor: float) -> Stage:
    """A smooth ball at the lowest point of a ring of 0.3 m that stands upright, with v2 = factor g rho."""
    rho = _LOOP - _RUNNER
    speed = math.sqrt(factor * laws.G * rho)
    ring = turn(Z, heading(placement)) @ turn(X, 0.5 * math.pi)
    along = turn(Z, heading(placement))[:3, 0] * speed
    return Stage(
        (
            Item("ring", forms.tube(0.33, _LOOP, 0.1, 192), ring, mass=0.0),
            Item("body", forms.ball(_RUNNER), shift(0.0, 0.0, -rho), velocity=as_vector(along)),
        ),
        friction=0.0,
        facts={"rho": rho},
        world_from_ramp=turn(Z, heading(placement))[:3, :3],
    )


def _round_angle(track: Track) -> np.ndarray:
    places = track.poses["body"][:, :3, 3] @ track.stage.world_from_ramp
    return np.unwrap(np.arctan2(places[:, 0], -places[:, 2]))


def _on_loop(track: Track) -> np.ndarray:
    """Whether it has stayed within 5 % of the ring's way so far, after each step."""
    places = track.poses["body"][:, :3, 3] @ track.stage.world_from_ramp
    near = np.hypot(places[:, 0], places[:, 2]) > 0.95 * track.fact("rho")
    return np.logical_and.accumulate(near)


def _goes_round(track: Track) -> float:
    """Whether it comes back to the lowest point along the ring. What has fallen off may, too, later."""
    return float(_round_angle(track)[_on_loop(track)].max() >= 2.0 * math.pi)


def _stays_on(track: Track) -> float:
    """Whether it stays on the ring during its first turn."""
    first = _round_angle(track) <= 2.0 * math.pi
    return float(_on_loop(track)[first].all())


def _mug_on_side(placement: int) -> Stage:
    """A mug 5 mm over a slab, on its side, its handle anywhere around."""
    form = forms.mug()
    pose = turn(Z, heading(placement)) @ turn(Y, 0.5 * math.pi) @ turn(Z, heading(2 * placement))
    low = float((form.vertices @ pose[2, :3]).min())
    return Stage(
        (
            Item("ground", forms.slab(1.0), mass=0.0),
            Item("body", form, shift(0.0, 0.0, 0.005 - low) @ pose, mass=0.3),
        )
    )


def lowest_vertex(track: Track) -> float:
    """Over z = 0 after the last step, meters."""
    return track.lowest("body")


def last_speed(track: Track) -> float:
    """Of the center of mass, the mean over the last half second, m/s."""
    last = track.count(0.5)
    return float(np.linalg.norm(track.velocities["body"][-last:], axis=1).mean())


SCENES = (
    _rolls("ball rolls down 15 degrees, plane", _ball, _plane, 15.0, radius=BALL, shown=True),
    _rolls("ball rolls down 15 degrees, slab", _ball, _slab, 15.0, radius=BALL),
    _rolls("ball rolls down 5 degrees, slab", _ball, _slab, 5.0, radius=BALL),
    _rolls(
        "ball rolls off 0.5 degrees, plane", _ball, _plane, 0.5, radius=BALL, bar=0.1, seconds=2.0
    ),
    _rolls(
        "ellipsoid rolls about its axis down 10 degrees, plane",
        _spheroid,
        _plane,
        10.0,
        radius=0.05,
        axis=2,
    ),
    _rolls(
        "ellipsoid rolls about its axis down 10 degrees, slab",
        _spheroid,
        _slab,
        10.0,
        radius=0.05,
        axis=2,
    ),
    _rolls(
        "torus rolls down 10 degrees at 1 m/s, plane",
        _wheel,
        _plane,
        10.0,
        radius=0.05,
        axis=2,
        speed=1.0,
    ),
    _rolls(
        "torus rolls down 10 degrees at 1 m/s, slab",
        _wheel,
        _slab,
        10.0,
        radius=0.05,
        axis=2,
        speed=1.0,
    ),
    _levels("ball rolls level at 1 cm/s, plane", _plane, 0.01),
    _levels("ball rolls level at 1 cm/s, slab", _slab, 0.01),
    _levels("ball rolls level at 0.2 m/s, plane", _plane, 0.2),
    _levels("ball rolls level at 0.2 m/s, slab", _slab, 0.2),
    EverydayScene(
        "ball bowled at 1 m/s ends up rolling",
        LEVEL,
        "Angular momentum about the contact's line stays: 5/7 of the speed, whatever the friction.",
        _bowled,
        1.0,
        (Measure("speed", "m/s", end_speed, _bowled_speed, 0.05, relative=True),),
    ),
    EverydayScene(
        "ball rolls to and fro in a bowl",
        CURVE,
        "Period 2 pi sqrt(7 (R - r) / (5 g)) (1 + A2 / 16), A 8 degrees.",
        _in_bowl,
        4.0,
        (Measure("period", "s", swing_period, _bowl_period, 0.03, relative=True),),
        engines=("voxshell",),
        most=5,
        needs=3.0,
    ),
    EverydayScene(
        "ball goes round a loop",
        CURVE,
        "A smooth ball stays on the loop if v2 at the bottom is at least 5 g rho; here 8 g rho.",
        lambda i: _in_loop(i, 8.0),
        1.2,
        (
            Measure("goes round", "", _goes_round, one, 0.0),
            Measure("stays on the loop", "", _stays_on, one, 0.0),
        ),
        rates=(1000.0, 200.0, 60.0),
        most=5,
    ),
    EverydayScene(
        "ball too slow for a loop falls off",
        CURVE,
        "A smooth ball leaves the loop if v2 at the bottom is below 5 g rho (and above 2 g rho); here 4 g rho.",
        lambda i: _in_loop(i, 4.0),
        1.2,
        (
            Measure("goes round", "", _goes_round, nothing, 0.0),
            Measure("stays on the loop", "", _stays_on, nothing, 0.0),
        ),
        rates=(1000.0, 200.0, 60.0),
        most=5,
    ),
    EverydayScene(
        "mug on its side comes to rest",
        CURVE,
        "A body at rest on a flat ground touches it with its lowest point, and does not move.",
        _mug_on_side,
        6.0,
        (
            Measure("lowest vertex over the ground", "mm", lowest_vertex, nothing, 5e-4, scale=1e3),
            Measure("speed at the end", "mm/s", last_speed, nothing, 5e-3, scale=1e3),
        ),
        most=10,
        needs=6.0,
    ),
)
