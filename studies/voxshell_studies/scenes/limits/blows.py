"""Blows and rebounds: rocking, narrow rooms, several blows within a step, bodies that are driven into walls."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from voxshell.model.shapes import Box, Capsule, Cylinder, Sphere
from voxshell.simulation.joint_kinds import SliderJoint
from voxshell_studies.scenes.everyday import forms
from voxshell_studies.scenes.everyday.scene import X, Y, Z, heading, scatter, shift, turn
from voxshell_studies.scenes.limits.scene import G, LimitScene, count_steps, open_world, put

if TYPE_CHECKING:
    from collections.abc import Iterable

    from voxshell.simulation.body import Body
    from voxshell.simulation.body_shapes import Shape
    from voxshell_studies.scenes.everyday.scene import Form

ROCKING = "Rocking blocks"
SLOW = "Slow impacts"
TURNED = "Rebounds with a turn"
ROOMS = "Elastic bodies in narrow rooms"
SEVERAL = "Several rebounds within one step"
DRIVEN = "Bodies that something makes fast beside a wall"
RODS = "Thin rods that spin fast"
PIPES = "Bullet's shapes that are fast inside a curved model"

_FREE = (0.0, 0.0, 0.0)

# ---- one body ------------------------------------------------------------------------------------

_BLOCK = (0.12, 0.3)
_FIRST_SWING = math.radians(10.0)


def true_swing() -> float:
    """Return the tilt that a rocking block reaches after its first landing, degrees.

    A landing keeps 1 - 1.5 sin2 of the diagonal's angle of its spin (Housner 1963).

    Example:
        >>> round(true_swing(), 2)
        5.58
    """
    diagonal = math.atan2(*_BLOCK)
    kept = (1.0 - 1.5 * math.sin(diagonal) ** 2) ** 2
    energy = math.cos(diagonal - _FIRST_SWING) - math.cos(diagonal)
    return math.degrees(diagonal - math.acos(math.cos(diagonal) + kept * energy))


def _rock(rate: float, placement: int) -> float:
    world = open_world(rate)
    put(world, forms.slab(1.0), turn(Z, heading(placement)), friction=1.0)
    width, height = _BLOCK
    edge = shift(0.5 * width, 0.0, 0.0)
    start = edge @ turn(Y, _FIRST_SWING) @ shift(-0.5 * width, 0.0, 0.5 * height)
    body = put(world, forms.box(width, 0.1, height), start, 1.0, friction=1.0)
    tilt = 0.0
    for _ in range(count_steps(rate, 1.0)):
        world.step()
        tilt = max(tilt, math.degrees(math.asin(float(np.clip(-body.pose[0, 2], -1.0, 1.0)))))
    return tilt


def _find_slowest_rebound(rate: float, placement: int) -> float:
    """Return the smallest speed of an elastic ball into a slab with which it comes back, m/s."""
    for speed in np.geomspace(0.005, 0.5, 47):
        world = open_world(rate)
        put(world, forms.slab(1.0), restitution=1.0)
        gap = speed / rate * (0.5 + 0.4 * scatter(placement))
        ball = put(
            *(world, forms.ball(0.03), shift(0.0, 0.0, 0.03 + gap), 0.3),
            restitution=1.0,
            velocity=(0.0, 0.0, -float(speed)),
        )
        for _ in range(4):
            world.step()
            if ball.linear_velocity[2] > 0.2 * speed:
                return float(speed)
    return math.nan


def _rebound_as_a_sphere(rate: float, _: int) -> float:
    """Return the height that an elastic sphere of Bullet's reaches again, of 3 mm."""
    world = open_world(rate)
    put(world, Box((0.5, 0.5, 0.05)), shift(0.0, 0.0, -0.05), restitution=1.0)
    body = put(world, Sphere(0.03), shift(0.0, 0.0, 0.033), 0.3, restitution=1.0)
    highest, hit = 0.0, False
    for _step in range(count_steps(rate, 0.11)):
        world.step()
        hit |= float(body.linear_velocity[2]) > 0.0
        highest = max(highest, float(body.position[2]) - 0.03 if hit else 0.0)
    return highest / 0.003


def _rebound_with_a_turn(rate: float, placement: int, restitution: float) -> float:
    """Return how deep a corner of a plate is at most that falls aslant at 3 m/s, millimeters."""
    world = open_world(rate)
    put(world, forms.slab(2.0), restitution=restitution)
    plate = forms.box(0.2, 0.3, 0.01)
    aslant = turn(Z, heading(placement)) @ turn(X, 0.35 + 0.3 * scatter(placement)) @ turn(Y, 0.2)
    low = float((plate.vertices @ aslant[2, :3]).min())
    start = shift(0.0, 0.0, 0.02 + 0.01 * scatter(placement, 2) - low) @ aslant
    body = put(world, plate, start, 0.5, restitution=restitution, velocity=(0.0, 0.0, -3.0))
    deepest = 0.0
    for _ in range(count_steps(rate, 0.5)):
        world.step()
        deepest = max(deepest, -_lowest(plate, body))
    return 1e3 * deepest


def _lowest(form: Form, body: Body) -> float:
    return float((form.vertices @ body.pose[2, :3]).min() + body.pose[2, 3])


def _leave_a_room(rate: float, _: int, restitution: float) -> float:
    """Return how many of ten balls of 40 mm pass one of two walls of 2 cm, 62 mm apart."""
    left = 0
    for throw in range(10):
        world = open_world(rate, _FREE)
        wall = forms.box(0.02, 0.5, 0.5)
        for side in (-1.0, 1.0):
            put(world, wall, shift(side * 0.041, 0.0, 0.0), restitution=restitution)
        start = shift(0.01 * scatter(throw), 0.0, 0.0) @ turn(Z, heading(throw))
        ball = put(
            *(world, forms.ball(0.02), start, 0.1),
            restitution=restitution,
            velocity=(5.0, 0.2 * scatter(throw, 2), 0.0),
        )
        world.step(count_steps(rate, 0.5))
        left += abs(float(ball.position[0])) > 0.031
    return float(left)


def _leave_a_pipe(rate: float, _: int) -> float:
    """Return how many of 24 bodies of Bullet's leave a pipe of 0.4 m with walls of 5 cm."""
    left = 0
    for throw in range(24):
        world = open_world(rate, _FREE)
        put(world, forms.tube(0.25, 0.2, 2.0, 96))
        shape = (Sphere(0.05), Cylinder(0.05, 0.1), Capsule(0.03, 0.08))[throw % 3]
        way = heading(throw)
        velocity = (15.0 * math.cos(way), 15.0 * math.sin(way), 1.0)
        start = shift(0.05 * scatter(throw, 2), 0.05 * scatter(throw, 3), -0.2) @ turn(X, way)
        body = put(world, shape, start, 0.5, restitution=0.5, velocity=velocity)
        world.step(count_steps(rate, 0.3))
        left += math.hypot(*body.position[:2]) > 0.2
    return float(left)


def _throw_rods(rate: float, _: int, rod: Form | Shape) -> float:
    """Return how many of 100 rods at 50 m/s, which spin at 60 rad/s, pass a slab of 5 cm."""
    passed = 0
    for throw in range(100):
        world = open_world(rate, _FREE)
        put(world, forms.slab(2.0))
        lie = turn(Z, heading(throw)) @ turn(X, math.pi * scatter(throw))
        start = shift(0.0, 0.0, 0.5 + 0.4 * scatter(throw, 2)) @ lie
        across = lie[:3, 0] * 60.0
        spin = (float(across[0]), float(across[1]), float(across[2]))
        body = put(world, rod, start, 0.1, velocity=(0.0, 0.0, -50.0), spin=spin)
        world.step(count_steps(rate, 0.1))
        passed += float(body.position[2]) < -0.05
    return float(passed)


# ---- several bodies ------------------------------------------------------------------------------


def _break_balls(rate: float, placement: int) -> float:
    """Return the kinetic energy after a break of ten elastic balls, of that before."""
    world = open_world(rate, _FREE)
    radius = 0.0285
    ball = forms.ball(radius)
    pitch = 2.0 * radius + 1e-4
    balls = []
    for row in range(4):
        for i in range(row + 1):
            place = shift(row * pitch * math.sqrt(0.75), (i - 0.5 * row) * pitch, 0.0)
            balls.append(
                put(world, ball, place @ turn(X, heading(i)), 0.17, friction=0.0, restitution=1.0)
            )
    start = shift(-0.2 - 0.01 * placement, 0.005 * scatter(placement), 0.0)
    cue = put(*(world, ball, start, 0.17), friction=0.0, restitution=1.0, velocity=(5.0, 0.0, 0.0))
    world.step(count_steps(rate, 0.3))
    return sum(float(b.linear_velocity @ b.linear_velocity) for b in (*balls, cue)) / 25.0


def _drop_five_cubes(rate: float, placement: int, side: float) -> float:
    """Return the largest gain of mechanical energy of five cubes that fall, percent."""
    world = open_world(rate)
    put(world, forms.PLANE, friction=0.0, restitution=0.95)
    form = forms.box(side, side, side)
    cubes = []
    height = 0.5 * side
    for i in range(5):
        height += side * (0.2 + 0.1 * scatter(5 * placement + i))
        lean = turn(X, 0.02 * scatter(5 * placement + i, 2)) @ turn(Z, heading(i))
        cubes.append(
            put(world, form, shift(0.0, 0.0, height) @ lean, 1.0, friction=0.0, restitution=0.95)
        )
        height += side
    start = _measure_energy(cubes, side)
    most = start
    for _ in range(count_steps(rate, 1.0)):
        world.step()
        most = max(most, _measure_energy(cubes, side))
    return 100.0 * (most / start - 1.0)


def _measure_energy(cubes: Iterable[Body], side: float) -> float:
    """Return the energy of cubes of 1 kg above the ground that they lie on, joules."""
    return sum(
        0.5 * float(cube.linear_velocity @ cube.linear_velocity)
        + side**2 / 12.0 * float(cube.angular_velocity @ cube.angular_velocity)
        + G * (float(cube.position[2]) - 0.5 * side)
        for cube in cubes
    )


def _drop_two_balls(rate: float, placement: int) -> float:
    """Return how far from the vertical a small ball on a large one leaves, degrees."""
    world = open_world(rate)
    put(world, forms.PLANE, restitution=1.0)
    large, small = 0.05, 0.02
    drop = 0.1 + 0.01 * placement
    lower = shift(0.0, 0.0, large + drop) @ turn(X, heading(placement))
    upper = shift(0.0, 0.0, 2.0 * large + small + drop + 1e-3) @ turn(Y, heading(placement))
    put(world, forms.ball(large), lower, 0.5, restitution=1.0)
    body = put(world, forms.ball(small), upper, 0.03, restitution=1.0)
    last = body.linear_velocity
    for _ in range(count_steps(rate, 0.4)):
        world.step()
        velocity = body.linear_velocity
        # Away from the large ball, which may send it down.
        if np.linalg.norm(velocity - last) > 1.0:
            return math.degrees(math.atan2(math.hypot(*velocity[:2]), float(velocity[2])))
        last = velocity
    return math.nan


# ---- driven within a step ------------------------------------------------------------------------


@cache
def _wall() -> Form:
    return forms.box(0.02, 0.6, 0.6)


def _reverse_a_motor(rate: float, placement: int) -> float:
    """Return how far a slider of 0.1 m passes the face of a wall of 2 cm, millimeters."""
    world = open_world(rate)
    put(world, _wall(), shift(0.01, 0.0, 0.0))
    gap = 0.005 * (1 + placement)
    form = forms.box(0.1, 0.1, 0.1)
    body = put(world, form, shift(-0.05 - gap, 0.0, 0.0), 1.0, velocity=(-4.0, 0.0, 0.0))
    rail = world.add_joint(SliderJoint(axis=X), None, body)
    rail.set_target_velocity(4.0, max_force=1e5)
    farthest = 0.0
    for _ in range(count_steps(rate, 0.1)):
        world.step()
        farthest = max(farthest, float(body.position[0]) + 0.05)
    return 1e3 * farthest


def _press_a_cube(rate: float, placement: int, driven: bool) -> float:
    """Return how deep a cube of 0.1 m is in a wall that a hammer or a paddle drives it at, millimeters.

    The cube slides along the wall, a few millimeters beside it.
    """
    world = open_world(rate, _FREE)
    put(world, forms.box(0.1, 2.0, 0.6), shift(0.05, 0.0, 0.0))
    cube = forms.box(0.1, 0.1, 0.1)
    beside, gap = 0.002 * (1 + placement), 0.05 + 0.011 * placement
    body = put(world, cube, shift(-0.05 - beside, -0.2, 0.0), 1.0, velocity=(0.0, 1.0, 0.0))
    # It meets the cube off its middle.
    y = -0.2 + gap / 5.0 + 0.03 * scatter(placement, 2)
    start = shift(-0.15 - beside - gap, y, 0.0)
    hammer = (
        put(world, cube, start, driven=True)
        if driven
        else put(world, cube, start, 50.0, velocity=(5.0, 0.0, 0.0))
    )
    deepest = 0.0
    for step in range(count_steps(rate, gap / 5.0 + 0.1)):
        if driven:
            # It stops where the cube fills what is left.
            hammer.pose = start @ shift(min(5.0 * (step + 1) / rate, gap + beside), 0.0, 0.0)
        world.step()
        corners = cube.vertices @ body.pose[0, :3] + body.pose[0, 3]
        deepest = max(deepest, float(corners.max()))
    return 1e3 * deepest


_LOSSES = (
    LimitScene(
        "block of 12 by 30 cm rocks from edge to edge",
        ROCKING,
        "tilt after the first landing",
        "degrees",
        round(true_swing(), 2),
        _rock,
        placements=3,
    ),
    LimitScene(
        "elastic model ball hits a slab",
        SLOW,
        "slowest speed with a rebound",
        "m/s",
        0.0,
        _find_slowest_rebound,
        placements=3,
    ),
    LimitScene(
        "elastic vx.Sphere falls by 3 mm on Bullet's box",
        SLOW,
        "height of the rebound over that of the fall",
        "",
        1.0,
        _rebound_as_a_sphere,
        # In longer steps the height depends on where in a step the blow is.
        rates=(1000.0, 200.0),
    ),
    *(
        LimitScene(
            f"plate of 1 by 20 by 30 cm falls at an angle at 3 m/s, restitution {restitution:g}",
            TURNED,
            "depth of a corner",
            "mm",
            0.0,
            lambda rate, i, restitution=restitution: _rebound_with_a_turn(rate, i, restitution),
            placements=10,
        )
        for restitution in (0.6, 1.0)
    ),
)

_CROWDS = (
    *(
        LimitScene(
            f"balls of 40 mm at 5 m/s between walls 62 mm apart, restitution {restitution:g}",
            ROOMS,
            "balls that leave",
            "of 10",
            0.0,
            lambda rate, _, restitution=restitution: _leave_a_room(rate, _, restitution),
        )
        for restitution in (0.8, 0.9)
    ),
    *(
        LimitScene(
            f"{name} at 50 m/s and 60 rad/s meet a slab of 5 cm",
            RODS,
            "rods that pass",
            "of 100",
            0.0,
            lambda rate, _, make=make: _throw_rods(rate, _, make()),
            rates=(200.0, 60.0, 30.0),
        )
        for name, make in (
            ("capsules of 5 mm in radius and 40 cm", lambda: Capsule(0.005, 0.39)),
            ("models of 1 by 1 by 40 cm", lambda: forms.box(0.01, 0.01, 0.4)),
        )
    ),
    LimitScene(
        "Bullet's round shapes at 15 m/s in a pipe of 0.4 m with walls of 5 cm",
        PIPES,
        "shapes that leave",
        "of 24",
        0.0,
        _leave_a_pipe,
    ),
    LimitScene(
        "break of ten elastic balls",
        SEVERAL,
        "kinetic energy over that before",
        "",
        1.0,
        _break_balls,
        placements=5,
    ),
    *(
        LimitScene(
            f"five cubes of {1e2 * side:g} cm fall with gaps, restitution 0.95",
            SEVERAL,
            "largest gain of energy",
            "%",
            0.0,
            lambda rate, placement, side=side: _drop_five_cubes(rate, placement, side),
            placements=10,
        )
        for side in (0.1, 0.01)
    ),
    LimitScene(
        "small ball falls with a large one, restitution 1",
        SEVERAL,
        "direction of the small ball from the vertical",
        "degrees",
        0.0,
        _drop_two_balls,
        placements=3,
    ),
)

_DRIVEN = (
    LimitScene(
        "motor of a slider reverses from -4 to 4 m/s beside a wall of 2 cm",
        DRIVEN,
        "distance beyond the wall's face",
        "mm",
        0.0,
        _reverse_a_motor,
        placements=6,
    ),
    *(
        LimitScene(
            f"{name} at 5 m/s presses a cube that slides along a wall",
            DRIVEN,
            "depth in the wall",
            "mm",
            0.0,
            lambda rate, placement, driven=driven: _press_a_cube(rate, placement, driven),
            placements=6,
        )
        for name, driven in (("hammer of 50 kg", False), ("kinematic paddle", True))
    ),
)

SCENES = (*_LOSSES, *_CROWDS, *_DRIVEN)
