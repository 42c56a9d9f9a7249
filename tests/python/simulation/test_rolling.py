"""Round bodies that roll, beside closed forms, at default settings.

A body that rolls without sliding down a slope accelerates by g sin a / (1 + I / (m r2)); on the level it keeps
its speed. Semi-implicit Euler steps add a half of a step's velocity to each way.
"""

from __future__ import annotations

import itertools
import math
from functools import cache

import numpy as np
import pytest
import voxshell as vx
from trimesh.creation import box, capsule, cylinder, icosphere, torus

GRAVITY = 9.81  # m/s2
RATES = [1000, 200, 60, 30]

# Mesh, rolling radius, and the axis that it rolls about.
BODIES = {
    "ball": (lambda: icosphere(5, radius=0.05), 0.05, 2),
    "coarse ball": (lambda: icosphere(3, radius=0.05), 0.05, 2),
    "ellipsoid": (lambda: icosphere(5, radius=0.05).apply_scale((1.0, 1.0, 0.6)), 0.05, 2),
    "wheel": (lambda: torus(0.04, 0.01, major_sections=128, minor_sections=48), 0.05, 2),
    "can": (lambda: cylinder(0.03, 0.1, sections=64), 0.03, 2),
    "can of 32 sides": (lambda: cylinder(0.03, 0.1, sections=32), 0.03, 2),
    "capsule": (lambda: capsule(0.1, 0.05, count=(64, 64)), 0.05, 2),
    "coin": (lambda: cylinder(0.02, 0.002, sections=128), 0.02, 2),
}


@cache
def build(name):
    return vx.Model.from_mesh(BODIES[name][0]())


@cache
def build_slab():
    return vx.Model.from_mesh(box((3.0, 3.0, 0.06)).apply_translation((0, 0, -0.03)))


def lay(name, ground, *, rate, slope=0.0, speed=0.0, turned=0.0):
    """A body on its rim, its axis along y, in gravity that leans by ``slope`` toward x, radians.

    Returns:
        World, body and its moment of inertia, as a fraction of that of a thin hoop.
    """
    model = build(name)
    _, radius, axis = BODIES[name]
    down = np.array([math.sin(slope), 0.0, -math.cos(slope)])
    world = vx.World(gravity=GRAVITY * down, time_step=1 / rate)
    world.add(vx.Plane((0, 0, 1)) if ground == "plane" else build_slab(), mass=0.0, friction=1.0)
    about_x = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], dtype=float)
    about_axis = np.array(
        [
            [math.cos(turned), -math.sin(turned), 0],
            [math.sin(turned), math.cos(turned), 0],
            [0, 0, 1],
        ]
    )
    pose = np.eye(4)
    pose[:3, :3] = about_x @ about_axis
    pose[:3, 3] = (-1.0, 0.0, radius)
    body = world.add(model, pose=pose, friction=0.8)
    body.linear_velocity = (speed, 0, 0)
    body.angular_velocity = (0, speed / radius, 0)
    return world, body, model.mass_properties().inertia[axis, axis] / radius**2


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("ground", ["plane", "slab"])
@pytest.mark.parametrize("name", ["ball", "coarse ball", "ellipsoid", "can", "can of 32 sides"])
def test_round_bodies_roll_down_a_slope(name, ground, rate):
    slope = math.radians(10.0)
    seconds = 0.6
    world, body, inertia = lay(name, ground, rate=rate, slope=slope, turned=0.3)
    world.step(round(seconds * rate))
    pull = GRAVITY * math.sin(slope) / (1.0 + inertia)
    way = 0.5 * pull * seconds * (seconds + 1 / rate)
    assert body.pose[0, 3] + 1.0 == pytest.approx(way, rel=0.01)


@pytest.mark.parametrize("ground", ["plane", "slab"])
@pytest.mark.parametrize(
    ("name", "rate"),
    [
        *itertools.product(["ball", "wheel", "can", "capsule"], RATES),
        # In longer steps it turns by too much.
        ("coin", 1000),
        ("coin", 200),
    ],
)
def test_round_bodies_keep_rolling_on_the_level(name, ground, rate):
    world, body, _ = lay(name, ground, rate=rate, speed=0.6, turned=0.3)
    world.step(rate)
    assert body.linear_velocity[0] == pytest.approx(0.6, rel=0.01)
    assert abs(body.pose[1, 3]) < 2e-3


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("ground", ["plane", "slab"])
def test_a_ball_rolls_off_a_slope_of_half_a_degree(ground, rate):
    world, body, inertia = lay("ball", ground, rate=rate, slope=math.radians(0.5))
    world.step(rate)
    pull = GRAVITY * math.sin(math.radians(0.5)) / (1.0 + inertia)
    assert body.linear_velocity[0] == pytest.approx(pull, rel=0.05)


# Visible facets are facets: a turn of 20 edges bends by 18 degrees at each.
def test_a_prism_of_twenty_sides_stands_on_a_facet():
    model = vx.Model.from_mesh(cylinder(0.03, 0.1, sections=20))
    slope = math.radians(5.0)
    world = vx.World(gravity=(GRAVITY * math.sin(slope), 0, -GRAVITY * math.cos(slope)))
    world.add(vx.Plane((0, 0, 1)), mass=0.0, friction=1.0)
    pose = np.eye(4)
    half = math.pi / 20
    about_x = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], dtype=float)
    pose[:3, :3] = about_x @ [
        [math.cos(half), -math.sin(half), 0],
        [math.sin(half), math.cos(half), 0],
        [0, 0, 1],
    ]
    pose[2, 3] = 0.03 * math.cos(half)
    body = world.add(model, pose=pose, friction=0.8)
    world.step(400)
    assert abs(body.pose[0, 3]) < 2e-4


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("ground", ["plane", "slab"])
def test_a_ball_that_drops_straight_goes_up_straight(ground, rate):
    world = vx.World(time_step=1 / rate)
    world.add(vx.Plane((0, 0, 1)) if ground == "plane" else build_slab(), mass=0.0, restitution=1.0)
    pose = np.eye(4)
    pose[2, 3] = 0.25
    body = world.add(build("ball"), pose=pose, restitution=0.9, friction=0.5)
    impact = math.sqrt(2 * GRAVITY * 0.2)
    for _ in range(round(0.4 * rate)):
        world.step()
    assert np.linalg.norm(body.linear_velocity[:2]) < 0.01 * impact


# What a slide reaches does not depend on which sample it began from.
@pytest.mark.parametrize("ground", ["plane", "slab"])
def test_a_ball_touches_with_one_point_whose_impulse_goes_on(ground):
    world, _, _ = lay("ball", ground, rate=200, speed=0.3)
    world.step(20)
    ids = set()
    impulses = []
    for _ in range(40):
        world.step()
        contacts = world.contacts()
        assert len(contacts) == 1
        impulses.append(contacts["impulse"][0])
        ids.add(int(contacts["id"][0]))
    assert len(ids) == 1
    assert np.mean(impulses) == pytest.approx(GRAVITY / 200, rel=0.01)
    # Facets are smoothed to second order: what is left shakes the ball a little.
    assert impulses == pytest.approx(np.full(40, GRAVITY / 200), rel=0.1)


@pytest.mark.parametrize("rate", [1000, 200, 60])
def test_a_ball_that_rolls_off_a_slab_keeps_its_speed(rate):
    world, body, _ = lay("ball", "slab", rate=rate, speed=1.0, turned=0.3)
    pose = body.pose.copy()
    pose[0, 3] = 1.3
    body.pose = pose
    world.step(round(0.4 * rate))
    assert body.pose[2, 3] < 0.0
    assert body.linear_velocity[0] == pytest.approx(1.0, rel=0.02)
