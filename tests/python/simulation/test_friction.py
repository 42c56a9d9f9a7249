"""Friction of the World's default solver beside Coulomb's closed forms, at default settings.

`benchmarks/friction.py` tries more bodies, grounds, headings and rates.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
import voxshell as vx
from sliding_bodies import build, build_slab

GRAVITY = 9.81  # m/s2
FRICTION = 0.5
SLOPE = math.radians(35.0)


BODIES = ("cube", "mug", "can", "dented box")


def lay(name, ground, *, rate, heading=0.0, slope=0.0, **settings):
    """A body that lies on a ground, in gravity that leans by ``slope`` toward ``heading``, radians.

    Returns:
        World, body and the heading's unit vector.
    """
    along = np.array([math.cos(heading), math.sin(heading), 0.0])
    gravity = GRAVITY * (math.sin(slope) * along - math.cos(slope) * np.array([0.0, 0.0, 1.0]))
    world = vx.World(gravity=gravity, time_step=1.0 / rate, sleeping=False, **settings)
    world.add(vx.Plane() if ground == "plane" else build_slab(), mass=0, friction=1.0)
    pose = np.eye(4)
    pose[:3, 3] = -0.3 * along
    pose[2, 3] = -build(name).bounds[0, 2]
    return world, world.add(build(name), pose=pose, friction=FRICTION), along


def run_out(speed, rate):
    """What a body moves that loses friction * g / rate of its speed a step, meters."""
    way = 0.0
    while speed > 0.0:
        speed -= FRICTION * GRAVITY / rate
        way += max(speed, 0.0) / rate
    return way


CASES = [
    (name, ground, rate, heading)
    for (name, ground), (rate, heading) in zip(
        [(name, ground) for ground in ("plane", "slab") for name in BODIES],
        [
            (1000, 0.0),
            (200, 22.5),
            (60, 45.0),
            (30, 67.0),
            (200, 45.0),
            (60, 67.0),
            (30, 22.5),
            (200, 0.0),
        ],
        strict=True,
    )
]


@pytest.mark.parametrize(("name", "ground", "rate", "heading"), CASES)
def test_bodies_slide_as_fast_as_coulomb_says(name, ground, rate, heading):
    world, body, along = lay(name, ground, rate=rate, heading=math.radians(heading), slope=SLOPE)
    world.step(round(0.4 * rate))
    expected = round(0.4 * rate) / rate * GRAVITY * (math.sin(SLOPE) - FRICTION * math.cos(SLOPE))
    assert body.linear_velocity @ along == pytest.approx(expected, rel=0.03)
    assert np.linalg.norm(body.linear_velocity) == pytest.approx(expected, rel=0.03)


@pytest.mark.parametrize(("name", "ground", "rate", "heading"), CASES)
def test_bodies_stop_where_coulomb_says(name, ground, rate, heading):
    world, body, along = lay(name, ground, rate=rate, heading=math.radians(heading))
    world.step(round(0.1 * rate))
    start = body.pose[:3, 3]
    body.linear_velocity = along
    world.step(round(0.3 * rate))
    assert np.linalg.norm(body.linear_velocity) < 0.001
    assert (body.pose[:3, 3] - start) @ along == pytest.approx(run_out(1.0, rate), rel=0.03)


def test_one_friction_direction_slides_as_fast_as_two():
    world, body, along = lay(
        "cube", "plane", rate=200, heading=0.4, slope=SLOPE, friction_directions=1
    )
    world.step(80)
    expected = 0.4 * GRAVITY * (math.sin(SLOPE) - FRICTION * math.cos(SLOPE))
    assert body.linear_velocity @ along == pytest.approx(expected, rel=0.03)


def test_stock_solver_gives_bodies_of_many_points_too_much_friction():
    """Else the tests above would say nothing of the solver."""
    world, body, along = lay(
        "cube", "plane", rate=200, heading=0.4, slope=SLOPE, solver="sequential_impulse"
    )
    world.step(80)
    expected = 0.4 * GRAVITY * (math.sin(SLOPE) - FRICTION * math.cos(SLOPE))
    assert body.linear_velocity @ along < 0.95 * expected


@pytest.mark.parametrize(("name", "rate"), [("cube", 200), ("mug", 60), ("can", 60)])
def test_nothing_creeps_below_the_angle_of_friction(name, rate):
    world, body, _ = lay(name, "plane", rate=rate, slope=0.95 * math.atan(FRICTION), heading=0.4)
    world.step(rate)
    start = body.pose[:3, 3]
    world.step(10 * rate)
    assert np.linalg.norm(body.pose[:3, 3] - start) < 2e-5


def test_a_torque_below_friction_turns_nothing():
    """The stock solver lets a body turn by torque / inertia * time step, 0.9 rad/s here."""
    world, body, _ = lay("cube", "plane", rate=200)
    world.step(20)
    start = body.pose
    for _ in range(200):
        body.apply_torque((0.0, 0.0, 0.1))
        world.step()
    assert np.abs(body.pose - start).max() < 1e-4


@pytest.mark.parametrize("speed", [1.0, 3.0])
def test_an_impact_aslant_loses_friction_times_its_normal_impulse(speed):
    """Contacts that are made before they touch have their friction in the same step."""
    world, body, _ = lay("cube", "plane", rate=60)
    body.position = np.add(body.position, (0, 0, 0.03))
    body.linear_velocity = (3.0 * speed, 0.0, -speed)
    world.step(10)
    lost_by_weight = FRICTION * GRAVITY * 10 / 60
    expected = 3.0 * speed - FRICTION * speed - lost_by_weight
    assert body.linear_velocity[0] == pytest.approx(expected, abs=0.25 * FRICTION * speed)


@pytest.mark.parametrize("rate", [1000, 200, 60])
@pytest.mark.parametrize("friction", [0.1, 0.5])
def test_a_box_slips_on_a_box_that_tips(friction, rate):
    # Bullet keeps the normals of contacts between its own shapes for several steps: the box held on
    # to the level one up to any slope.
    world = vx.World(time_step=1 / rate)
    tray = world.add(vx.Box((0.5, 0.25, 0.025)), motion="kinematic", friction=friction**0.5)
    start = np.eye(4)
    start[2, 3] = 0.035
    box = world.add(vx.Box((0.05, 0.05, 0.01)), mass=1.0, pose=start, friction=friction**0.5)
    degrees, slid = 0.0, 0.0
    while slid < 0.005 and degrees < 80.0:
        degrees += 10.0 / rate
        tray.pose = trimesh.transformations.rotation_matrix(np.radians(degrees), (0, 1, 0))
        world.step(1)
        slid = (tray.pose[:3, :3].T @ box.pose[:3, 3])[0]
    slope = np.arctan(friction)
    growth = GRAVITY / np.cos(slope) * np.radians(10.0)  # m/s3, of the acceleration
    after = (6 * 0.005 / growth) ** (1 / 3)
    assert degrees == pytest.approx(np.degrees(slope) + 10.0 * after, abs=0.8)
