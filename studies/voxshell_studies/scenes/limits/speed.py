"""Scenes whose steps take long: the time of the longest one, on this machine."""

from __future__ import annotations

from typing import TYPE_CHECKING

from voxshell_studies.scenes.everyday import forms
from voxshell_studies.scenes.everyday.scene import X, Y, shift, turn
from voxshell_studies.scenes.limits.mechanisms import add_oldham_coupling
from voxshell_studies.scenes.limits.scene import LimitScene, open_world, put, time_steps

if TYPE_CHECKING:
    from collections.abc import Callable

    from voxshell_studies.scenes.everyday.scene import Form

MANY = "Few bodies with many contacts"
FLUSH = "Flush bodies that move"
THIN = "Small or thin bodies on large ones"
TURNING = "Pairs that turn fast beside each other"


def _time_a_coupling(rate: float, _: int) -> float:
    world = open_world(rate)
    add_oldham_coupling(world)
    return time_steps(world, rate, 0.5)


def _time_a_sliding_cube(rate: float, _: int) -> float:
    world = open_world(rate)
    put(world, forms.slab(2.0), friction=0.1)
    cube = forms.box(0.1, 0.1, 0.1)
    put(world, cube, shift(-0.5, 0.0, 0.05), 1.0, friction=0.1, velocity=(1.0, 0.0, 0.0))
    return time_steps(world, rate, 0.5)


def _time_a_fall(rate: float, _: int, form: Form) -> float:
    """Time a body that falls aslant by a few millimeters on a slab of 5 m, until it lies."""
    world = open_world(rate)
    put(world, forms.slab(5.0))
    pose = turn(X, 0.02) @ turn(Y, 0.02)
    low = float((form.vertices @ pose[2, :3]).min())
    put(world, form, shift(0.0, 0.0, 0.002 - low) @ pose, 0.01)
    return time_steps(world, rate, 0.3)


def _time_a_pair(rate: float, _: int) -> float:
    """Time two bunnies that spin at 30 rad/s beside each other and hardly touch."""
    world = open_world(rate, (0.0, 0.0, 0.0))
    for x, way in ((0.0, 1.0), (0.21, -1.0)):
        spin = (0.0, 0.0, 30.0 * way)
        put(world, forms.named("bunny 0.2 m"), shift(x, 0.0, 0.0), 1.0, spin=spin)
    return time_steps(world, rate, 0.5)


def _timed(name: str, group: str, run: Callable[[float, int], float]) -> LimitScene:
    return LimitScene(name, group, "longest time of a step", "ms", 0.0, run, timed=True)


SCENES = (
    _timed("driven Oldham coupling", MANY, _time_a_coupling),
    _timed("cube of 0.1 m slides on a slab of 2 m", FLUSH, _time_a_sliding_cube),
    _timed(
        "sheet of 0.3 m by 0.1 mm falls on a slab of 5 m",
        THIN,
        lambda rate, placement: _time_a_fall(rate, placement, forms.box(0.3, 0.3, 0.0001)),
    ),
    _timed(
        "needle of 1 mm by 1 m falls on a slab of 5 m",
        THIN,
        lambda rate, placement: _time_a_fall(rate, placement, forms.box(1.0, 0.001, 0.001)),
    ),
    _timed("two bunnies of 0.2 m spin at 30 rad/s beside each other", TURNING, _time_a_pair),
)
