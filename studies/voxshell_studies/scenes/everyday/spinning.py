"""Free rotation, tops, coins, rings that spin, pendulums."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from voxshell_studies.scenes.everyday import forms, laws
from voxshell_studies.scenes.everyday.rolling import swing_period
from voxshell_studies.scenes.everyday.scene import (
    EverydayScene,
    Item,
    Joint,
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

FREE, TOP, SWING = "Free rotation", "Tops, coins and rings", "Pendulum"

# ---- free ----------------------------------------------------------------------------------------


def _tumbling(placement: int, form: Form, speed: float) -> Stage:
    """Weightless, at 6 rad/s about an axis near the middle principal one, about which spin is unstable."""
    about = np.array([0.2 + 0.1 * scatter(placement), 1.0, 0.2 + 0.1 * scatter(placement, 2)])
    matter = forms.matter(form, 1.0)
    moments, axes = np.linalg.eigh(matter.inertia)
    axes = axes * np.sign(np.linalg.det(axes))
    turned = turn(Z, heading(placement)) @ turn(X, scatter(placement, 3))
    spin = speed * about / np.linalg.norm(about)
    return Stage(
        (Item("body", form, turned, spin=as_vector(turned[:3, :3] @ axes @ spin)),),
        gravity=(0.0, 0.0, 0.0),
        facts={
            **{f"moment {i}": float(moments[i]) for i in range(3)},
            **{f"spin {i}": float(spin[i]) for i in range(3)},
        },
        # World from the principal axes at the start.
        world_from_ramp=turned[:3, :3] @ axes,
    )


def _principal(track: Track) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Moments, attitude relative to the start and spin after each step, in the start's principal axes."""
    moments = np.array([track.fact(f"moment {i}") for i in range(3)])
    start = track.stage.world_from_ramp
    rotations = track.poses["body"][:, :3, :3]
    relative = rotations @ rotations[0].T
    attitude = np.einsum("ji,njk,kl->nil", start, relative, start)
    spins = track.spins["body"] @ start
    return moments, attitude, spins


def _energy(track: Track) -> float:
    moments, attitude, spins = _principal(track)
    body = np.einsum("nji,nj->ni", attitude, spins)
    energy = 0.5 * (body**2 * moments).sum(axis=1)
    return float((energy / energy[0])[int(np.argmax(np.abs(energy - energy[0])))])


def _momentum_change(track: Track) -> float:
    moments, attitude, spins = _principal(track)
    body = np.einsum("nji,nj->ni", attitude, spins)
    momentum = np.einsum("nij,nj->ni", attitude, body * moments)
    return float(np.linalg.norm(momentum - momentum[0], axis=1).max() / np.linalg.norm(momentum[0]))


def _attitude_error(track: Track) -> float:
    """The angle between the attitude at the end and the true one, degrees."""
    moments, attitude, _ = _principal(track)
    spin = tuple(track.fact(f"spin {i}") for i in range(3))
    true = np.array(laws.tumble(tuple(moments.tolist()), spin, track.seconds))  # pyright: ignore[reportArgumentType]
    trace = float(np.trace(true.T @ attitude[-1]))
    return math.degrees(math.acos(max(-1.0, min(1.0, 0.5 * (trace - 1.0)))))


TUMBLE = (
    Measure("energy that differs most", "", _energy, one, 0.01),
    Measure("change of angular momentum", "%", _momentum_change, nothing, 1e-3, scale=100.0),
    Measure("attitude off Euler's equations", "degrees", _attitude_error, nothing, 5.0),
)


def _tumbles(name: str, form: str, speed: float) -> EverydayScene:
    return EverydayScene(
        name,
        FREE,
        "Euler's equations of a free body: energy and angular momentum stay; the attitude is integrated with "
        "fourth order and steps of 1 ms.",
        lambda i: _tumbling(i, forms.named(form), speed),
        30.0,
        TUMBLE,
        most=5,
        smooth=True,
    )


# ---- tops ----------------------------------------------------------------------------------------

_TOP_MASS, _TOP_SPIN, _TILT = 0.5, 100.0, math.radians(20.0)


def _heavy_top(placement: int) -> Stage:
    """A top on a pivot at its tip's center, tilted by 20 degrees, that begins in steady precession."""
    form = forms.spinning_top()
    matter = forms.matter(form, _TOP_MASS)
    height = float(matter.center_of_mass[2])
    axial = float(matter.inertia[2, 2])
    lateral = float(matter.inertia[0, 0]) + _TOP_MASS * height**2
    rate = laws.precession(_TOP_SPIN, axial, lateral, _TOP_MASS * laws.G * height, _TILT)
    pose = turn(Z, heading(placement)) @ turn(Y, _TILT)
    axis = pose[:3, 2]
    # The spin along the axis includes what the precession contributes.
    spin = np.array([0.0, 0.0, rate]) + axis * (_TOP_SPIN - rate * math.cos(_TILT))
    velocity = np.cross(spin, axis * height)
    return Stage(
        (
            Item(
                *("body", form, pose, _TOP_MASS),
                velocity=as_vector(velocity),
                spin=as_vector(spin),
                joint=Joint("point"),
            ),
        ),
        facts={"rate": rate},
    )


def _precession(track: Track) -> float:
    """The mean angular velocity of the axis about the vertical, rad/s."""
    axes = track.poses["body"][:, :3, 2]
    angle = np.unwrap(np.arctan2(axes[:, 1], axes[:, 0]))
    return float((angle[-1] - angle[0]) / track.seconds)


def _true_precession(track: Track) -> float:
    return track.fact("rate")


def _tilt(track: Track) -> float:
    """The axis' tilt that differs most from the start, degrees."""
    tilts = np.degrees(np.arccos(np.clip(track.poses["body"][:, 2, 2], -1.0, 1.0)))
    return float(tilts[int(np.argmax(np.abs(tilts - tilts[0])))])


def _start_tilt(_: Track) -> float:
    return math.degrees(_TILT)


def _sleeping_top(placement: int) -> Stage:
    """A top that spins upright at 100 rad/s on a slab: far above 2 sqrt(m g l I1) / I3, 22 rad/s."""
    pose = shift(0.2 * scatter(placement), 0.2 * scatter(placement, 2), 0.003) @ turn(
        Z, heading(placement)
    )
    # Half a degree off the vertical.
    pose = pose @ turn(X, math.radians(0.5))
    return Stage(
        (
            Item("ground", forms.slab(1.0), mass=0.0),
            Item("body", forms.spinning_top(), pose, 0.5, spin=(0.0, 0.0, 100.0)),
        ),
        friction=0.3,
    )


def _most_tilted(track: Track) -> float:
    return float(np.degrees(np.arccos(np.clip(track.poses["body"][:, 2, 2], -1.0, 1.0))).max())


def _coin(placement: int) -> Stage:
    """A coin of 40 mm on its edge, spinning at 60 rad/s about its vertical diameter."""
    form = forms.cylinder(0.02, 0.002, 192)
    pose = shift(0.2 * scatter(placement), 0.2 * scatter(placement, 2), 0.02) @ turn(
        Z, heading(placement)
    )
    pose = pose @ turn(X, 0.5 * math.pi) @ turn(Z, heading(3 * placement))
    return Stage(
        (
            Item("ground", forms.slab(1.0), mass=0.0),
            Item("body", form, pose, 0.01, spin=(0.0, 0.0, 60.0)),
        ),
        friction=0.2,
    )


def _coin_tilt(track: Track) -> float:
    """The largest angle of the coin's plane from the vertical, degrees."""
    axes = np.abs(track.poses["body"][:, 2, 2])
    return float(np.degrees(np.arcsin(np.clip(axes, 0.0, 1.0))).max())


def _rolling_coin(placement: int) -> Stage:
    """A coin of 40 mm that rolls upright at 1 m/s: above sqrt(g R / 3), 0.26 m/s, it does not fall."""
    form = forms.cylinder(0.02, 0.002, 192)
    way = turn(Z, heading(placement))
    pose = way @ shift(-0.4, 0.0, 0.02) @ turn(X, 0.5 * math.pi) @ turn(Z, heading(3 * placement))
    return Stage(
        (
            Item("ground", forms.slab(2.0), mass=0.0),
            Item(
                *("body", form, pose, 0.01),
                velocity=as_vector(way[:3, 0]),
                spin=as_vector(way[:3, 1] * 50.0),
            ),
        ),
        world_from_ramp=way[:3, :3],
    )


def _coin_way(track: Track) -> float:
    return float(track.path("body")[-1, 0])


def _free_way(track: Track) -> float:
    return track.seconds * 1.0


_RING = (0.05, 0.045)


def _flat_ring(placement: int, ground: Form) -> Stage:
    form = forms.tube(*_RING, 0.01)
    pose = turn(Z, heading(placement)) @ shift(0.1 * scatter(placement), 0.0, 0.005)
    return Stage(
        (
            Item("ground", ground, mass=0.0),
            Item("body", form, pose, spin=(0.0, 0.0, 30.0)),
        ),
        friction=0.2,
    )


def _stop_time(track: Track) -> float:
    """When the spin's magnitude falls below a thousandth, seconds; NaN where it never does."""
    spins = np.abs(track.spins["body"][:, 2])
    still = np.nonzero(spins < 1e-3 * spins[0])[0]
    return float(still[0] * track.time_step) if len(still) else math.nan


def _true_stop(_: Track) -> float:
    return laws.ring_spin_down(30.0, 0.2, *_RING)


# ---- pendulum ------------------------------------------------------------------------------------

_SWING = math.radians(40.0)


def _pendulum(placement: int) -> Stage:
    """A bar of 0.3 m hinged at its end, released at 40 degrees."""
    form = forms.box(0.02, 0.03, 0.3)
    way = turn(Z, heading(placement))
    pose = way @ turn(Y, _SWING) @ shift(0.0, 0.0, -0.15)
    hinge = Joint("hinge", (0.0, 0.0, 0.0), as_vector(way[:3, 1]))
    inertia = float(forms.matter(form, 1.0).inertia[1, 1]) + 0.15**2
    return Stage(
        (Item("body", form, pose, joint=hinge),),
        facts={"length": inertia / 0.15},
        world_from_ramp=way[:3, :3],
    )


def _true_swing(track: Track) -> float:
    return laws.pendulum_period(track.fact("length"), _SWING)


def _swing_height(track: Track) -> float:
    """The largest angle during the last two seconds, degrees."""
    places = track.poses["body"][-track.count(2.0) :, :3, 3] @ track.stage.world_from_ramp
    return float(np.degrees(np.arctan2(np.abs(places[:, 0]), -places[:, 2])).max())


def _true_height(_: Track) -> float:
    return math.degrees(_SWING)


SCENES = (
    _tumbles("box tumbles freely at 6 rad/s", "box 0.1 m", 6.0),
    _tumbles("mug tumbles freely at 6 rad/s", "mug", 6.0),
    _tumbles("bunny tumbles freely at 6 rad/s", "bunny 0.2 m", 6.0),
    EverydayScene(
        "heavy top precesses on a pivot",
        TOP,
        "Steady precession (Goldstein 5.7), begun with its own angular velocity: rate and tilt stay.",
        _heavy_top,
        5.0,
        (
            Measure("precession", "rad/s", _precession, _true_precession, 0.1, relative=True),
            Measure("tilt that differs most", "degrees", _tilt, _start_tilt, 5.0),
        ),
        rates=(1000.0, 200.0),
        most=5,
        smooth=True,
    ),
    EverydayScene(
        "top spins upright on a slab",
        TOP,
        "Above 2 sqrt(m g l I1) / I3 an upright top sleeps; a rounded tip with friction raises it further.",
        _sleeping_top,
        5.0,
        (Measure("largest tilt", "degrees", _most_tilted, nothing, 5.0),),
        rates=(1000.0, 200.0),
        most=5,
        shown=True,
    ),
    EverydayScene(
        "coin spins on its edge",
        TOP,
        "Upright spin is stable above 2 sqrt(g / R), 44 rad/s without friction, and 20 rad/s with; on the flat "
        "rim it stands below that as well.",
        _coin,
        1.0,
        (Measure("largest tilt", "degrees", _coin_tilt, nothing, 5.0),),
        rates=(1000.0, 200.0),
        most=5,
    ),
    EverydayScene(
        "coin rolls upright at 1 m/s",
        TOP,
        "A thin disk that rolls faster than sqrt(g R / 3) is stable; without rolling friction it keeps its speed.",
        _rolling_coin,
        0.8,
        (
            Measure("distance", "m", _coin_way, _free_way, 0.05, relative=True),
            Measure("largest tilt", "degrees", _coin_tilt, nothing, 5.0),
        ),
        rates=(1000.0, 200.0, 60.0),
        most=10,
    ),
    EverydayScene(
        "ring spins down, plane",
        TOP,
        "Coulomb friction under a thin ring: w (R2 + r2) / (2 mu g L), L 2/3 (R3 - r3) / (R2 - r2).",
        lambda i: _flat_ring(i, forms.PLANE),
        1.5,
        (Measure("time to stop", "s", _stop_time, _true_stop, 0.05, relative=True),),
        most=5,
    ),
    EverydayScene(
        "ring spins down, slab",
        TOP,
        "As on the plane.",
        lambda i: _flat_ring(i, forms.slab(1.0)),
        1.5,
        (Measure("time to stop", "s", _stop_time, _true_stop, 0.05, relative=True),),
        most=5,
    ),
    EverydayScene(
        "pendulum on a hinge",
        SWING,
        "2 pi sqrt(l / g) / agm(1, cos(A / 2)) at an amplitude of 40 degrees; without friction it stays.",
        _pendulum,
        10.0,
        (
            Measure("period", "s", swing_period, _true_swing, 0.01, relative=True),
            Measure("amplitude after 10 s", "degrees", _swing_height, _true_height, 1.0),
        ),
        most=3,
        smooth=True,
    ),
)
