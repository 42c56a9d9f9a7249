"""A brake, a ratchet, a cam, and a wedge that lifts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from voxshell_studies.scenes.everyday import forms, laws
from voxshell_studies.scenes.everyday.held_out import bodies
from voxshell_studies.scenes.everyday.scene import (
    EverydayScene,
    Item,
    Joint,
    Measure,
    Stage,
    Y,
    Z,
    heading,
    shift,
    turn,
)
from voxshell_studies.scenes.everyday.sliding import as_vector, downhill, nothing

if TYPE_CHECKING:
    from voxshell_studies.scenes.everyday.scene import Track

MACHINE = "Brake, ratchet, cam, wedge"

_WHEEL, _WHEEL_SPIN, _PRESS = 0.1, 20.0, 5.0


def _brake(placement: int) -> Stage:
    """A wheel of 2 kg on an axle at 20 rad/s, on whose rim a shoe on a slider presses with 5 N."""
    way = turn(Z, heading(placement))
    wheel = forms.cylinder(_WHEEL, 0.04, forms.FINE)
    inward, across = as_vector(way[:3, 0]), as_vector(way[:3, 1])
    return Stage(
        (
            Item(
                *("body", wheel, way @ bodies.lying(0.0), 2.0),
                spin=as_vector(way[:3, 1] * _WHEEL_SPIN),
                joint=Joint("hinge", (0.0, 0.0, 0.0), across),
            ),
            Item(
                *("shoe", forms.box(0.04, 0.05, 0.06), way @ shift(_WHEEL + 0.02, 0.0, 0.0), 0.2),
                force=as_vector(-way[:3, 0] * _PRESS),
                joint=Joint("slider", (0.0, 0.0, 0.0), inward),
            ),
        ),
        facts={"inertia": float(forms.matter(wheel, 2.0).inertia[2, 2])},
        world_from_ramp=way[:3, :3],
    )


def _brake_time(track: Track) -> float:
    """When the wheel's spin falls below a hundredth, seconds; NaN where it never does."""
    spins = track.spins["body"] @ track.stage.world_from_ramp[:, 1]
    still = np.nonzero(spins < 0.01 * _WHEEL_SPIN)[0]
    return float(still[0] * track.time_step) if len(still) else math.nan


def _true_brake(track: Track) -> float:
    return track.fact("inertia") * _WHEEL_SPIN / (track.stage.friction * _PRESS * _WHEEL)


_PAWL, _PAWL_SLOPE = (0.12, 0.015, 0.006), math.radians(30.0)


def _ratchet(placement: int) -> Stage:
    """A rack on a slider, pulled along x with 50 N, and a pawl on a hinge that leans against its teeth."""
    way = turn(Z, heading(placement))
    _, pitch, height = bodies.RACK
    length = _PAWL[0]
    gap = 2e-4
    lean = turn(Y, -_PAWL_SLOPE)
    corners = forms.box(*_PAWL).vertices @ lean[:3, :3].T
    # The foremost corner touches the tooth that ends at x = 0, the lowest one the next tooth's slope.
    lowest = corners[int(np.argmin(corners[:, 2]))]
    x = gap - float(corners[:, 0].min())
    foot = x + float(lowest[0])
    z = foot * height / pitch + gap - float(lowest[2])
    axle = way @ shift(x, 0.0, z) @ lean @ shift(0.5 * length, 0.0, 0.0)
    return Stage(
        (
            Item(
                *("body", bodies.rack(), way, 1.0),
                force=as_vector(way[:3, 0] * 50.0),
                joint=Joint("slider", (0.0, 0.0, 0.0), as_vector(way[:3, 0])),
            ),
            Item(
                *("pawl", forms.box(*_PAWL), way @ shift(x, 0.0, z) @ lean, 0.1),
                joint=Joint("hinge", as_vector(axle[:3, 3]), as_vector(way[:3, 1])),
            ),
        ),
        friction=0.3,
        world_from_ramp=way[:3, :3],
    )


def _farthest_along(track: Track) -> float:
    """The largest way of the rack in the direction that the pawl blocks, meters."""
    return float(track.path("body")[:, 0].max())


_CAM, _LIFT, _CAM_SPIN = 0.04, 0.01, 6.0


def _cam(placement: int) -> Stage:
    """A flat follower of 0.5 kg on a disc that turns at 6 rad/s about an axis 10 mm off its middle."""
    way = turn(Z, heading(placement))

    def path(time: float) -> np.ndarray:
        return way @ turn(Y, _CAM_SPIN * time) @ shift(0.0, 0.0, -_LIFT) @ bodies.lying(0.0)

    return Stage(
        (
            Item("cam", forms.cylinder(_CAM, 0.03, forms.FINE), path(0.0), path=path),
            Item(
                *("body", forms.box(0.06, 0.05, 0.02), way @ shift(0.0, 0.0, _CAM), 0.5),
                joint=Joint("slider"),
            ),
        ),
        friction=0.1,
    )


def _cam_error(track: Track) -> float:
    """The largest distance of the follower from where the cam holds it, meters."""
    times = track.time_step * np.arange(track.steps + 1)
    lift = _LIFT * (1.0 - np.cos(_CAM_SPIN * times))
    return float(np.abs(track.path("body")[:, 2] - lift).max())


_GENTLE, _THRUST, _ROLLER = math.radians(20.0), 10.0, 0.03


def _lifting_wedge(placement: int) -> Stage:
    """A wedge of 2 kg pushed with 10 N below a roller of 1 kg on an upright slider, without friction."""
    way = turn(Z, heading(placement))
    x = 0.05
    height = (0.2 - x) * math.tan(_GENTLE) + _ROLLER / math.cos(_GENTLE)
    roller = way @ shift(x, 0.0, 0.0) @ bodies.lying(height)
    return Stage(
        (
            Item("ground", forms.PLANE, mass=0.0),
            Item(
                *("body", bodies.gentle_wedge(_GENTLE), way, 2.0),
                force=as_vector(way[:3, 0] * _THRUST),
            ),
            Item(
                *("roller", forms.cylinder(_ROLLER, 0.1, forms.FINE), roller, 1.0),
                joint=Joint("slider"),
            ),
        ),
        friction=0.0,
        world_from_ramp=way[:3, :3],
    )


def _true_thrust(track: Track) -> float:
    pull = laws.lifting_wedge_acceleration(_GENTLE, _THRUST, 2.0, 1.0)
    return laws.way(0.0, pull, track.seconds, track.time_step)


SCENES = (
    EverydayScene(
        "brake stops a wheel",
        MACHINE,
        "Coulomb friction at the rim: I w / (mu F r), mu 0.5.",
        _brake,
        1.2,
        (Measure("time to stop", "s", _brake_time, _true_brake, 0.05, relative=True),),
        most=5,
        needs=1.2,
        held_out=True,
    ),
    EverydayScene(
        "ratchet holds 50 N",
        MACHINE,
        "The tooth pushes the pawl toward its hinge and down into the teeth: nothing moves beyond the play, 0.2 mm.",
        _ratchet,
        1.0,
        (Measure("farthest distance", "mm", _farthest_along, nothing, 1e-3, scale=1e3, signed=1),),
        most=5,
        held_out=True,
    ),
    EverydayScene(
        "cam lifts a follower",
        MACHINE,
        "A flat follower on an eccentric disc moves by e (1 - cos w t), e 10 mm.",
        _cam,
        1.5,
        (Measure("largest distance from that", "mm", _cam_error, nothing, 5e-4, scale=1e3),),
        engines=("voxshell", "bullet"),
        # Where the cam is during a step is a matter of convention: 0.3 mm at 200 Hz.
        rates=(1000.0, 200.0),
        most=5,
        held_out=True,
    ),
    EverydayScene(
        "wedge lifts a roller",
        MACHINE,
        "Without friction: (F - m g tan a) / (M + m tan2 a), summed over Euler steps; 20 degrees.",
        _lifting_wedge,
        0.3,
        (Measure("distance of the wedge", "m", downhill, _true_thrust, 0.05, relative=True),),
        held_out=True,
    ),
)
