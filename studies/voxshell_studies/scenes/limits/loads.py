"""Heavy loads on light bodies, joints between light and heavy bodies, and bodies that are nearly at rest."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from voxshell.model.shapes import Capsule, Sphere
from voxshell.simulation.joint_kinds import FixedJoint, PointJoint, SliderJoint
from voxshell.simulation.world import World
from voxshell_studies.scenes.everyday import forms
from voxshell_studies.scenes.everyday.scene import X, Y, Z, shift, turn
from voxshell_studies.scenes.limits.scene import G, LimitScene, count_steps, open_world, put

if TYPE_CHECKING:
    from voxshell.simulation.body import Body
    from voxshell.simulation.body_shapes import Shape
    from voxshell_studies.scenes.everyday.scene import Form

TALL = "Tall thin bodies"
LIGHT = "Light bodies far below their load"
PRESSED = "Balls pressed with thousands of times their weight"
NEEDLES = "Needles on large bodies"
SLIPS = "Tiny slips"
ITERATIONS = "Given iterations with joints"
WHIPS = "Light links that whip heavy bodies"

# ---- standing and slipping -----------------------------------------------------------------------


def _stand_past_balance(rate: float, _: int, slenderness: float) -> float:
    """Return how far past the point of balance a slab tilts until a box on it tips, degrees."""
    height = 0.4
    width = height / slenderness
    world = open_world(rate)
    slab = put(world, forms.slab(1.0), driven=True)
    box = put(
        world, forms.box(width, width, height), shift(0.0, 0.0, 0.5 * height), 1.0, friction=0.8
    )
    world.step(count_steps(rate, 0.5))
    balance = math.degrees(math.atan2(width, height))
    tilt = 0.0
    while tilt < balance + 6.0:
        # By a quarter of a degree a second near the point of balance.
        tilt += (4.0 if tilt < balance - 1.0 else 0.25) / rate
        slab.pose = turn(Y, math.radians(tilt))
        world.step()
        if box.pose[:3, 2] @ slab.pose[:3, 2] < math.cos(math.radians(2.0)):
            break
    return tilt - balance


def _drop_a_needle(rate: float, placement: int) -> float:
    """Return how deep a needle's lowest corner is in a slab a second after it fell aslant, millimeters."""
    world = open_world(rate)
    put(world, forms.slab(5.0))
    needle = forms.box(1.0, 0.001, 0.001)
    pose = turn(X, 0.02 + 0.2 * placement) @ turn(Y, 0.02)
    low = float((needle.vertices @ pose[2, :3]).min())
    body = put(world, needle, shift(0.0, 0.0, 0.002 - low) @ pose, 0.01)
    world.step(count_steps(rate, 1.0))
    lowest = float((needle.vertices @ body.pose[2, :3]).min() + body.pose[2, 3])
    return -1e3 * min(lowest, 0.0)


def _slip_after_a_kick(rate: float, _: int) -> float:
    """Return how far a cube slides that is kicked to 5 mm/s, micrometers."""
    world = open_world(rate)
    put(world, forms.slab(1.0))
    body = put(world, forms.box(0.1, 0.1, 0.1), shift(0.0, 0.0, 0.05), 1.0)
    world.step(count_steps(rate, 0.2))
    before = float(body.position[0])
    body.linear_velocity = (0.005, 0.0, 0.0)
    body.wake()
    world.step(count_steps(rate, 0.1))
    return 1e6 * (float(body.position[0]) - before)


_SHAKE, _SHAKE_RATE = 20e-6, 2.0 * math.pi * 50.0
"""Amplitude of a feeder, meters, and its angular frequency, rad/s."""


def feeder_place(time: float) -> float:
    """Return where a feeder is that moves slowly forward and fast back, meters."""
    phase = _SHAKE_RATE * time
    # From rest: the amplitude grows during a tenth of a second.
    return _SHAKE * min(10.0 * time, 1.0) * (math.sin(phase) - 0.4 * math.sin(2.0 * phase))


def true_feed(friction: float, seconds: float) -> float:
    """Return how far a body moves on the feeder, micrometers: Coulomb's law in steps of 10 µs."""
    step = 1e-5
    place = speed = 0.0
    for i in range(round(seconds / step)):
        belt = (feeder_place((i + 1) * step) - feeder_place(i * step)) / step
        change = friction * G * step
        speed += min(max(belt - speed, -change), change)
        place += speed * step
    return 1e6 * place


def _feed(rate: float, _: int) -> float:
    """Return how far a feeder moves a cube in half a second, of the true distance."""
    world = open_world(rate)
    feeder = put(world, forms.slab(1.0), driven=True, friction=0.2)
    body = put(world, forms.box(0.1, 0.1, 0.1), shift(0.0, 0.0, 0.05), 1.0, friction=0.2)
    for step in range(count_steps(rate, 0.5)):
        feeder.pose = shift(feeder_place((step + 1) / rate), 0.0, 0.0)
        world.step()
    return 1e6 * float(body.position[0]) / true_feed(0.2, 0.5)


# ---- loads ---------------------------------------------------------------------------------------


def _load_light_cubes(rate: float, _: int, load: float) -> float:
    """Return how fast a plate sinks into four cubes of 1 g, mm/s."""
    world = open_world(rate)
    put(world, forms.slab(2.0))
    side = 0.05
    for x in (-0.15, 0.15):
        for y in (-0.15, 0.15):
            put(world, forms.box(side, side, side), shift(x, y, 0.5 * side), 0.001)
    plate = put(world, forms.box(0.4, 0.4, 0.04), shift(0.0, 0.0, side + 0.02), load)
    world.step(count_steps(rate, 1.0))
    before = float(plate.position[2])
    world.step(count_steps(rate, 2.0))
    return 1e3 * (before - float(plate.position[2])) / 2.0


def _press_a_ball(rate: float, ball: Form | Shape, force: float) -> tuple[float, float]:
    """Return how much nearer two plates come than a ball's diameter, meters, and its share of the force."""
    world = open_world(rate)
    radius = 0.03
    put(world, forms.slab(0.5))
    body = put(world, ball, shift(0.0, 0.0, radius), 0.3)
    lid = put(world, forms.box(0.2, 0.2, 0.02), shift(0.0, 0.0, 2.0 * radius + 0.01), 1.0)
    world.add_joint(SliderJoint(axis=Z), None, lid)
    for _ in range(count_steps(rate, 1.0)):
        lid.apply_force((0.0, 0.0, -force))
        world.step()
    contacts = world.contacts()
    ends = zip(contacts["body_a"].tolist(), contacts["body_b"].tolist(), strict=True)
    both = [{a, b} == {body.number, lid.number} for a, b in ends]
    carried = float(contacts["impulse"][both].sum()) * rate
    return 2.0 * radius + 0.01 - float(lid.position[2]), carried / (force + G)


# ---- joints --------------------------------------------------------------------------------------


def _drift_with_iterations(rate: float, _: int, iterations: int | None) -> float:
    """Return how far a light capsule leaves the place to which it is pinned at most, millimeters."""
    world = World(time_step=1.0 / rate, iterations=iterations)
    length = 0.3
    along = turn(Y, 0.5 * math.pi)
    rod = put(world, Capsule(0.01, length), shift(0.5 * length, 0.0, 0.0) @ along, 0.03)
    ball = put(world, Sphere(0.06), shift(length + 0.07, 0.0, 0.0), 8.0)
    world.add_joint(PointJoint(), None, rod, world_from_joint=np.eye(4))
    world.add_joint(FixedJoint(), rod, ball)
    world.set_collision(rod, ball, False)
    return 1e3 * _watch(world, rate, 3.0, [(None, rod, (0.0, 0.0, -0.5 * length))])


def _whip(rate: float, _: int) -> float:
    """Return how far two light links come apart from each other or the world at most, millimeters."""
    world = open_world(rate)
    length = 0.25
    along = turn(Y, 0.5 * math.pi)
    links = [
        put(world, Capsule(0.01, length - 0.04), shift((i + 0.5) * length, 0.0, 0.0) @ along, mass)
        for i, mass in enumerate((0.012, 0.019))
    ]
    load = put(world, Sphere(0.1), shift(2.0 * length + 0.1, 0.0, 0.0), 35.0)
    ends = [(None, links[0]), (links[0], links[1]), (links[1], load)]
    for i, (parent, child) in enumerate(ends):
        world.add_joint(PointJoint(), parent, child, world_from_joint=shift(i * length, 0.0, 0.0))
    world.set_collision(links[0], load, False)
    half = 0.5 * length
    pins = [
        (None, links[0], (0.0, 0.0, -half)),
        (links[0], links[1], (0.0, 0.0, -half)),
    ]
    return 1e3 * _watch(world, rate, 3.0, pins)


def _watch(
    world: World,
    rate: float,
    seconds: float,
    pins: list[tuple[Body | None, Body, tuple[float, float, float]]],
) -> float:
    """Step, and return how far a child's pin is at most from where it was in its parent, meters."""

    def find(parent: Body | None, child: Body, pin: tuple[float, float, float]) -> np.ndarray:
        place = child.pose @ (*pin, 1.0)
        return place if parent is None else np.linalg.inv(parent.pose) @ place

    starts = [find(*pin) for pin in pins]
    farthest = 0.0
    for _ in range(count_steps(rate, seconds)):
        world.step()
        for pin, start in zip(pins, starts, strict=True):
            farthest = max(farthest, float(np.linalg.norm(find(*pin) - start)))
    return farthest


_STANDING = (
    *(
        LimitScene(
            f"box of 1:{slenderness:g} on a slab that tilts slowly",
            TALL,
            "angle past balance at which it tips",
            "degrees",
            0.0,
            lambda rate, _, slenderness=slenderness: _stand_past_balance(rate, _, slenderness),
            cost=2.0,
        )
        for slenderness in (4.0, 16.0)
    ),
    LimitScene(
        "needle of 1 mm by 1 m falls at an angle on a slab of 5 m",
        NEEDLES,
        "depth of a corner",
        "mm",
        0.0,
        _drop_a_needle,
        placements=5,
    ),
    LimitScene(
        "cube of 0.1 m at rest is kicked to 5 mm/s",
        SLIPS,
        "slip",
        "µm",
        # v2 / (2 mu g).
        2.55,
        _slip_after_a_kick,
        rates=(1000.0,),
    ),
    LimitScene(
        "feeder that shakes by 20 µm at 50 Hz",
        SLIPS,
        "distance of a cube over the true one",
        "",
        1.0,
        _feed,
        rates=(1000.0,),
    ),
)

_LOADS = (
    *(
        LimitScene(
            f"plate of {load:g} kg on four cubes of 1 g",
            LIGHT,
            "speed at which it sinks",
            "mm/s",
            0.0,
            lambda rate, _, load=load: _load_light_cubes(rate, _, load),
        )
        for load in (100.0, 1000.0)
    ),
    *(
        LimitScene(
            f"{short} a {name} of 0.3 kg pressed with {1e-3 * force:g} kN",
            PRESSED,
            what,
            unit,
            truth,
            lambda rate, _, make=make, force=force, pick=pick, scale=scale: (
                scale * _press_a_ball(rate, make(), force)[pick]
            ),
        )
        for name, make in (
            ("model ball", lambda: forms.ball(0.03)),
            ("vx.Sphere", lambda: Sphere(0.03)),
        )
        for force in (3000.0, 10000.0)
        for pick, short, what, unit, truth, scale in (
            (0, "depth of", "in both plates", "mm", 0.0, 1e3),
            (1, "force through", "share that contacts report", "", 1.0, 1.0),
        )
    ),
)

_JOINTS = (
    *(
        LimitScene(
            f"capsule of 30 g pinned to the world, with a ball of 8 kg, {name}",
            ITERATIONS,
            "distance from the pin",
            "mm",
            0.0,
            lambda rate, _, iterations=iterations: _drift_with_iterations(rate, _, iterations),
        )
        for name, iterations in (
            ("10 iterations", 10),
            ("75 iterations", 75),
            ("default iterations", None),
        )
    ),
    LimitScene(
        "two links of 12 and 19 g swing 35 kg",
        WHIPS,
        "distance of joints",
        "mm",
        0.0,
        _whip,
    ),
)

SCENES = (*_STANDING, *_LOADS, *_JOINTS)
