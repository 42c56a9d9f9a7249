"""Collars on poles, pulled along them at a lever, so that they lean."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from voxshell.model.shapes import Cylinder
from voxshell_studies.scenes.everyday import forms
from voxshell_studies.scenes.everyday.scene import Z, heading, shift, turn
from voxshell_studies.scenes.limits.scene import LimitScene, count_steps, open_world, put

if TYPE_CHECKING:
    from voxshell.simulation.body_shapes import Shape
    from voxshell_studies.scenes.everyday.scene import Form

GROUP = "Collars under a lever"
_POLE, _BORE, _OUTER, _LENGTH = 0.01, 0.0102, 0.016, 0.04
_SIDES = 64
_LEVER, _PULL, _MASS = 0.03, 2.0, 0.2
_WAY = 0.4
_LONGEST = 2.0
"""Of a run, seconds."""


def _slide(rate: float, placement: int, pole: Form | Shape, friction: float) -> tuple[float, float]:
    """Return the time over that of statics, and how deep the edges of the bore get, meters."""
    world = open_world(rate, gravity=(0.0, 0.0, 0.0))
    put(world, pole, friction=friction)
    collar = put(
        world,
        forms.tube(_OUTER, _BORE, _LENGTH, _SIDES),
        shift(0.0, 0.0, 0.3) @ turn(Z, heading(placement)),
        _MASS,
        friction=friction,
    )
    angles = np.linspace(0.0, 2.0 * math.pi, _SIDES + 1)
    edge = [
        (_BORE * math.cos(a), _BORE * math.sin(a), z)
        for a in angles
        for z in (-0.5 * _LENGTH, 0.5 * _LENGTH)
    ]
    deepest = 0.0
    steps = 0
    while collar.position[2] > 0.3 - _WAY and steps < count_steps(rate, _LONGEST):
        at = collar.position + collar.pose[:3, :3] @ (_LEVER, 0.0, 0.0)
        collar.apply_force((0.0, 0.0, -_PULL), at=at)
        world.step()
        steps += 1
        places = np.array(edge) @ collar.pose[:3, :3].T + collar.position
        deepest = max(deepest, _POLE - float(np.hypot(places[:, 0], places[:, 1]).min()))
    # Both edges are pressed with the pull's lever over the collar's length.
    acceleration = (_PULL - 2.0 * friction * _PULL * _LEVER / _LENGTH) / _MASS
    true_time = math.sqrt(2.0 * float(0.3 - collar.position[2]) / acceleration)
    return steps / rate / true_time, deepest


def _time(rate: float, placement: int, pole: Form | Shape) -> float:
    return _slide(rate, placement, pole, 0.3)[0]


def _depth(rate: float, placement: int, pole: Form | Shape) -> float:
    return 1e3 * _slide(rate, placement, pole, 0.3)[1]


SCENES = tuple(
    LimitScene(
        f"{what} 40 mm with 0.4 mm of play on {name}, pulled at a lever",
        GROUP,
        measured,
        unit,
        truth,
        lambda rate, placement, make=make, run=run: run(rate, placement, make()),
        placements=3,
    )
    for name, make in (
        ("a model pole", partial(forms.cylinder, _POLE, 1.2, _SIDES)),
        ("a vx.Cylinder as pole", partial(Cylinder, _POLE, 1.2)),
    )
    for what, measured, unit, truth, run in (
        ("collar of", "time over the true one", "", 1.0, _time),
        ("edges of a collar of", "depth in the pole", "mm", 0.0, _depth),
    )
)
