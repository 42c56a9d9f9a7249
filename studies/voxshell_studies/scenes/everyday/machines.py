"""Chains, hooks, screws, conveyors and grippers."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from voxshell_studies.scenes.everyday import forms, laws
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
from voxshell_studies.scenes.everyday.sliding import as_vector, nothing

if TYPE_CHECKING:
    from voxshell_studies.scenes.everyday.scene import Form, Track

LOAD, DRIVEN = "Loads", "Conveyor and gripper"

# ---- loads ---------------------------------------------------------------------------------------

_LINKS = 10
_LINK = (0.025, 0.005)
_PITCH = 2.0 * (_LINK[0] - _LINK[1])


def _chain(placement: int, load: float) -> Stage:
    """Ten tori hang in each other; the first is fixed and the last carries the load as its own mass."""
    form = forms.torus(*_LINK)
    way = turn(Z, heading(placement))
    items = []
    for i in range(_LINKS):
        around = turn(Z, 0.5 * math.pi * (i % 2)) @ turn(X, 0.5 * math.pi)
        mass = 0.0 if i == 0 else load if i == _LINKS - 1 else 0.05
        items.append(Item(f"link {i + 1}", form, way @ shift(0.0, 0.0, -_PITCH * i) @ around, mass))
    return Stage(tuple(items))


def _chain_length(track: Track) -> float:
    """From the center of the first to that of the last link at the end, meters."""
    return float(np.linalg.norm(track.poses[f"link {_LINKS}"][-1][:3, 3]))


def _true_chain(_: Track) -> float:
    return _PITCH * (_LINKS - 1)


def _chains(load: float, *, shown: bool = False) -> EverydayScene:
    return EverydayScene(
        f"chain of ten links carries {load:g} kg",
        LOAD,
        "Rigid links in each other: nine times twice the inner radius from the first to the last center.",
        lambda i: _chain(i, load),
        30.0,
        (Measure("length", "mm", _chain_length, _true_chain, 0.01, relative=True, scale=1e3),),
        most=3,
        shown=shown,
    )


def _hook(placement: int) -> Stage:
    """A ring of 25 mm hangs on a hook's lowest place, across it."""
    # The wires' centers are a wire's radius and the ring's apart where they touch.
    center = -0.03 + 0.005 - (_LINK[0] - _LINK[1])
    pose = shift(0.0, 0.0, center) @ turn(Y, 0.5 * math.pi)
    way = turn(Z, heading(placement))
    return Stage(
        (
            Item("hook", forms.hook(), way, mass=0.0),
            Item("body", forms.torus(*_LINK), way @ pose, 0.05 + 2.0 * abs(scatter(placement))),
        ),
        facts={"center": center},
    )


def _ring_height(track: Track) -> float:
    return float(track.poses["body"][-1][2, 3])


def _true_ring(track: Track) -> float:
    return track.fact("center")


def _screw(placement: int, friction: float) -> Stage:
    """A nut whose own mass is the load, 5 kg, half way up a bolt that stands.

    It begins in the middle of its play, 0.4 mm along the radius, and settles on the lower flank.
    """
    bolt, nut = forms.nut_and_bolt()
    turns = 3.0 + 0.5 * scatter(placement)
    pose = shift(0.0, 0.0, 0.006 * turns) @ turn(Z, 2.0 * math.pi * turns)
    return Stage(
        (Item("bolt", bolt, mass=0.0), Item("body", nut, pose, 5.0)),
        friction=friction,
    )


def _screw_turn(track: Track) -> float:
    """How far the nut has turned at the end after the first half second, degrees."""
    later = track.poses["body"][track.count(0.5) :, :3, :3]
    trace = float(np.trace(later[0].T @ later[-1]))
    return math.degrees(math.acos(max(-1.0, min(1.0, 0.5 * (trace - 1.0)))))


# ---- conveyor, gripper ---------------------------------------------------------------------------

_BELT = 0.5


def _conveyor(placement: int, form: Form) -> Stage:
    """A slab of 3 m that moves at 0.5 m/s from the first step, and a body that is put on it."""
    way = turn(Z, heading(placement))
    belt = forms.boxes("belt", (((0.0, 0.0, -0.025), (3.0, 0.4, 0.05)),))

    def path(time: float) -> np.ndarray:
        return way @ shift(_BELT * time, 0.0, 0.0)

    return Stage(
        (
            Item("belt", belt, way, path=path),
            Item("body", form, way @ turn(Z, heading(3 * placement)) @ forms.standing(form)),
        ),
        friction=0.2,
        world_from_ramp=way[:3, :3],
    )


def _carried(track: Track) -> float:
    return float(track.path("body")[-1, 0])


def _true_carried(track: Track) -> float:
    """The belt's way less what it takes to catch up, which is the way to stop in the belt's frame."""
    slip = laws.way_to_stop(_BELT, 0.2 * laws.G, track.time_step)
    return _BELT * track.seconds - slip


def _carried_aside(track: Track) -> float:
    return float(abs(track.path("body")[-1, 1]))


def _gripper(placement: int, force: float, form: Form) -> Stage:
    """Two jaws on sliders press a body of 0.3 kg with a force each; nothing else carries it."""
    way = turn(Z, heading(placement))
    jaw = forms.box(0.02, 0.06, 0.06)
    # A mug's handle is away from the jaws.
    body = turn(Z, 0.5 * math.pi + 0.3 * scatter(placement)) if form.name == "mug" else np.eye(4)
    points = form.vertices @ body[:3, :3].T
    near = np.abs(points[:, 1]) < 0.031
    low, high = float(points[near, 0].min()), float(points[near, 0].max())
    axis = as_vector(way[:3, 0])
    push = way[:3, 0] * force
    return Stage(
        (
            Item(
                *("left", jaw, way @ shift(low - 0.01, 0.0, 0.0), 0.5),
                force=as_vector(push),
                joint=Joint("slider", (0.0, 0.0, 0.0), axis),
            ),
            Item(
                *("right", jaw, way @ shift(high + 0.01, 0.0, 0.0), 0.5),
                force=as_vector(-push),
                joint=Joint("slider", (0.0, 0.0, 0.0), axis),
            ),
            Item("body", form, way @ body, 0.3),
        ),
        facts={"force": force},
    )


def _slip(track: Track) -> float:
    """How far the body has sunk at the end, meters."""
    return float(-track.path("body")[-1, 2])


def _free_slip(track: Track) -> float:
    """With friction mu = 0.5 at both jaws: a = g - 2 mu F / m."""
    pull = laws.G - 2.0 * 0.5 * track.fact("force") / 0.3
    return laws.way(0.0, pull, track.seconds, track.time_step)


SCENES = (
    _chains(10.0),
    _chains(20.0),
    _chains(50.0, shown=True),
    EverydayScene(
        "ring hangs on a hook",
        LOAD,
        "A ring rests with its inside on the lowest place of the hook's wire.",
        _hook,
        5.0,
        (Measure("height of its center", "mm", _ring_height, _true_ring, 2e-4, scale=1e3),),
        most=10,
    ),
    EverydayScene(
        "nut under 5 kg holds on its thread",
        LOAD,
        "A thread holds itself if friction exceeds tan(lead) = pitch / (2 pi r) = 0.10 over the cosine of the "
        "flank; here 0.5.",
        lambda i: _screw(i, 0.5),
        5.0,
        (Measure("turned after half a second", "degrees", _screw_turn, nothing, 1.0),),
        engines=("voxshell",),
        most=3,
    ),
    *(
        EverydayScene(
            f"conveyor carries a {name}",
            DRIVEN,
            "Friction accelerates it with mu g until it has the belt's speed; its slip is the stopping distance in the "
            "belt's frame.",
            lambda i, form=form: _conveyor(i, form()),
            1.5,
            (
                Measure("distance", "m", _carried, _true_carried, 0.02, relative=True),
                Measure("aside", "mm", _carried_aside, nothing, 2e-3, scale=1e3),
            ),
            engines=("voxshell", "bullet"),
        )
        for name, form in (("cube", lambda: forms.box(0.1, 0.1, 0.1)), ("mug", forms.mug))
    ),
    *(
        EverydayScene(
            f"gripper holds a {name} with 20 N",
            DRIVEN,
            "It holds if 2 mu F exceeds the weight: 20 N against 2.9 N.",
            lambda i, form=form: _gripper(i, 20.0, form()),
            60.0,
            (Measure("slip", "mm", _slip, nothing, 5e-4, scale=1e3),),
            most=5,
            shown=name == "mug",
        )
        for name, form in (("cube", lambda: forms.box(0.06, 0.06, 0.06)), ("mug", forms.mug))
    ),
    EverydayScene(
        "gripper lets a cube slip with 1.5 N",
        DRIVEN,
        "2 mu F is half the weight: it sinks with a = g - 2 mu F / m, summed over Euler steps.",
        lambda i: _gripper(i, 1.5, forms.box(0.06, 0.06, 0.06)),
        0.08,
        (Measure("slip", "mm", _slip, _free_slip, 0.05, relative=True, scale=1e3),),
        rates=(1000.0, 200.0),
        most=5,
    ),
)
