"""Round bodies on round models, and in grooves of one, at default settings.

Meshes of models have facets. What rolls over these feels the smooth surface they stand for.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
import trimesh
import voxshell as vx
from poses import pose_of
from scipy.spatial.transform import Rotation
from shapely.geometry import Polygon
from trimesh.creation import annulus, cylinder, extrude_polygon, icosphere

GRAVITY = 9.81  # m/s2
RATES = (1000, 200, 60, 30)

ALONG_X = Rotation.from_euler("y", 90.0, degrees=True)
ALONG_Y = Rotation.from_euler("x", 90.0, degrees=True)
# From a profile's plane to that across x, z up.
PROFILE = Rotation.from_matrix([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def extrude(profile, length):
    mesh = extrude_polygon(Polygon(profile), length)
    mesh.apply_translation((0.0, 0.0, -0.5 * length))
    return vx.Model.from_mesh(mesh)


@cache
def ball(radius):
    return vx.Model.from_mesh(icosphere(4, radius=radius))


@cache
def bar():
    return vx.Model.from_mesh(cylinder(0.05, 2.0, sections=64))


@cache
def shaft():
    return vx.Model.from_mesh(cylinder(0.018, 0.06, sections=128))


@cache
def bearing():
    return vx.Model.from_mesh(annulus(0.02, 0.032, 0.03, sections=128))


@cache
def trough():
    angles = np.linspace(-math.pi, 0.0, 33)
    inner = 0.06 * np.column_stack([np.cos(angles), np.sin(angles)])
    return extrude([*inner, (0.09, 0.0), (0.09, -0.09), (-0.09, -0.09), (-0.09, 0.0)], 2.0)


@cache
def groove(degrees, length=0.5):
    high = 0.06 * math.tan(math.radians(degrees))
    profile = [(-0.06, high), (0.0, 0.0), (0.06, high), (0.06, -0.03), (-0.06, -0.03)]
    return extrude(profile, length)


@cache
def thin_bar():
    return vx.Model.from_mesh(cylinder(0.01, 1.2, sections=64))


@cache
def wide_bearing(length):
    return vx.Model.from_mesh(annulus(0.04, 0.06, length, sections=128))


WAVE = 0.02  # meters, up and down
WAVE_LENGTH = 0.5


def terrain_height(x):
    return WAVE * np.sin(2.0 * math.pi * x / WAVE_LENGTH)


@cache
def terrain():
    """Of facets of 25 mm, waves along x."""
    x, y = np.linspace(-0.3, 2.7, 121), np.linspace(-0.15, 0.15, 13)
    index = np.arange(x.size * y.size).reshape(x.size, y.size)
    tops = np.array([(a, b, terrain_height(a)) for a in x for b in y])
    bottoms = np.array([(a, b, -0.1) for a in x for b in y])
    a, b, c, d = (
        i.ravel() for i in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:])
    )
    top = np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    ring = np.concatenate([index[:, 0], index[-1, 1:], index[-2::-1, -1], index[0, -2:0:-1]])
    after, low = np.roll(ring, -1), index.size
    sides = np.vstack(
        [
            np.column_stack([ring, ring + low, after]),
            np.column_stack([after, ring + low, after + low]),
        ]
    )
    faces = np.vstack([top, top[:, ::-1] + low, sides])
    mesh = trimesh.Trimesh(np.vstack([tops, bottoms]), faces)
    assert mesh.is_watertight
    assert mesh.volume > 0.0
    return vx.Model.from_mesh(mesh)


def way_over_terrain(radius, inertia, speed, seconds):
    """How far a wheel comes that starts where x is 0, and its first center; `inertia` is in units of
    mass times squared radius."""
    x = np.linspace(0.0, 2.4, 24001)
    wave_number = 2.0 * math.pi / WAVE_LENGTH
    slope = WAVE * wave_number * np.cos(wave_number * x)
    length = np.hypot(1.0, slope)
    centers = np.column_stack([x - radius * slope / length, terrain_height(x) + radius / length])
    steps = np.linalg.norm(np.diff(centers, axis=0), axis=1)
    speeds = np.sqrt(speed**2 - 2.0 * GRAVITY / (1.0 + inertia) * (centers[:, 1] - centers[0, 1]))
    times = np.concatenate([[0.0], np.cumsum(2.0 * steps / (speeds[1:] + speeds[:-1]))])
    return np.interp(seconds, times, centers[:, 0]) - centers[0, 0], centers[0]


def roll_along(ground, ground_pose, shape, height, rate):
    """Returns the speed that is left of 0.2 m/s after half a second, as a fraction, and the way
    aside in meters."""
    world = vx.World(gravity=(0.0, 0.0, -GRAVITY), time_step=1 / rate)
    world.add(ground, mass=0.0, pose=ground_pose, friction=1.0)
    body = world.add(shape, mass=1.0, pose=pose_of((-0.3, 0.0, height)), friction=1.0)
    body.linear_velocity = (0.2, 0.0, 0.0)
    body.angular_velocity = (0.0, 0.2 / 0.03, 0.0)
    world.step(rate // 2)
    return body.linear_velocity[0] / 0.2, abs(body.pose[1, 3])


def make_ball(is_model):
    return ball(0.03) if is_model else vx.Sphere(0.03)


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("is_model", [True, False], ids=["model", "Bullet's ball"])
def test_a_ball_rolls_along_a_bar(is_model, rate):
    # A ball on top of a bar is about to fall off, and a push aside would grow.
    speed, aside = roll_along(
        bar(), pose_of((0, 0, -0.05), ALONG_X), make_ball(is_model), 0.03, rate
    )
    assert speed == pytest.approx(1.0, abs=0.02)
    assert aside < 1e-3


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("is_model", [True, False], ids=["model", "Bullet's ball"])
def test_a_ball_rolls_along_a_trough(is_model, rate):
    speed, aside = roll_along(
        trough(), pose_of((0, 0, 0), PROFILE), make_ball(is_model), -0.03, rate
    )
    assert speed == pytest.approx(1.0, abs=0.02)
    assert aside < 1e-4


def test_a_ball_swings_across_a_trough():
    """The bend of its way costs the tenth that steps without a bend cost a pendulum."""
    world = vx.World(gravity=(0.0, 0.0, -GRAVITY), time_step=1 / 1000)
    world.add(trough(), mass=0.0, pose=pose_of((0, 0, 0), PROFILE), friction=1.0)
    start = math.radians(30.0)
    center = 0.03 * np.array([0.0, math.sin(start), -math.cos(start)])
    body = world.add(ball(0.03), mass=1.0, pose=pose_of(center), friction=1.0)
    angles = []
    for _ in range(1000):
        world.step()
        angles.append(math.atan2(body.pose[1, 3], -body.pose[2, 3]))
    assert max(np.abs(angles[-400:])) > 0.97 * start


@pytest.mark.parametrize("rate", [1000, 200, 60])
def test_a_shaft_spins_in_its_bearing(rate):
    """Without friction: normals that lean turn it."""
    world = vx.World(gravity=(0.0, 0.0, -GRAVITY), time_step=1 / rate)
    world.add(bearing(), mass=0.0, pose=pose_of((0, 0, 0), ALONG_Y), friction=0.0)
    body = world.add(shaft(), mass=0.3, pose=pose_of((0, 0, -0.002), ALONG_Y), friction=0.0)
    body.angular_velocity = (0.0, 10.0, 0.0)
    world.step(rate // 2)
    assert body.angular_velocity[1] == pytest.approx(10.0, rel=0.01)


@pytest.mark.parametrize(("rate", "swing"), [(1000, 12e-6), (200, 5e-6), (60, 3e-6)])
def test_a_roller_lies_still_in_a_round_seat(rate, swing):
    """Contacts that stayed behind as it trembled rocked it by 52, 20 and 6 micrometers."""
    radius = 0.024
    angles = np.linspace(1.2 * math.pi, 1.8 * math.pi, 200)
    seat = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    right, low = seat[-1, 0], -1.3 * radius
    world = vx.World(gravity=(0.0, 0.0, -GRAVITY), time_step=1 / rate, sleeping=False)
    ground = extrude([*seat, (right, low), (-right, low)], 0.08)
    world.add(ground, mass=0.0, pose=pose_of((0, 0, 0), PROFILE), friction=1.0)
    roller = vx.Model.from_mesh(cylinder(0.02, 0.02, sections=256))
    turned = Rotation.from_euler("x", 0.3) * ALONG_X
    body = world.add(roller, mass=0.3, pose=pose_of((0, 0, -0.004), turned), friction=1.0)
    farthest = 0.0
    for _ in range(4 * rate):
        world.step()
        farthest = max(farthest, abs(body.position[1]))
    assert farthest < swing


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("degrees", [20.0, 45.0, 70.0])
@pytest.mark.parametrize("name", ["ball", "Bullet's ball", "Bullet's capsule"])
def test_round_bodies_lie_on_both_walls_of_a_groove(name, degrees, rate):
    """Bullet's balls and capsules touched one wall at a time, and sank by up to 7 mm."""
    radius = 0.01
    shape = {
        "ball": lambda: ball(radius),
        "Bullet's ball": lambda: vx.Sphere(radius),
        "Bullet's capsule": lambda: vx.Capsule(radius, 0.08),
    }[name]()
    world = vx.World(gravity=(0.0, 0.0, -GRAVITY), time_step=1 / rate)
    world.add(groove(degrees), mass=0.0, pose=pose_of((0, 0, 0), PROFILE))
    height = radius / math.cos(math.radians(degrees))
    body = world.add(shape, mass=0.3, pose=pose_of((0.0, 0.0, height + 0.002), ALONG_X))
    world.step(3 * rate // 2)
    assert np.abs(body.pose[:3, 3] - (0.0, 0.0, height)).max() < 2e-5


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("degrees", [30.0, 60.0])
def test_a_ball_lies_in_a_groove_of_coarse_cells(degrees, rate):
    """Between two walls a grid says nothing of either. From there, balls saw no wall at all, or hung
    in the air on one that they had not reached."""
    radius = 0.02
    world = vx.World(gravity=(0.0, 0.0, -GRAVITY), time_step=1 / rate)
    world.add(groove(degrees, 1.2), mass=0.0, pose=pose_of((0, 0, 0), PROFILE))
    height = radius / math.cos(math.radians(degrees))
    body = world.add(vx.Sphere(radius), mass=0.3, pose=pose_of((0.0, 0.0, height + 0.002)))
    world.step(3 * rate // 2)
    assert np.abs(body.pose[:3, 3] - (0.0, 0.0, height)).max() < 2e-5


@pytest.mark.parametrize("speed", [0.4, 0.8])
def test_a_ball_that_turns_far_in_a_step_rolls_on(speed):
    """By 0.4 and 0.9 radians. Facets ahead of it were taken for the end of an egg, and braked it."""
    world = vx.World(gravity=(0.0, 0.0, -GRAVITY), time_step=1 / 30)
    world.add(vx.Plane(), mass=0.0, friction=1.0)
    body = world.add(ball(0.03), mass=0.3, pose=pose_of((0.0, 0.0, 0.03)), friction=1.0)
    body.linear_velocity = (speed, 0.0, 0.0)
    body.angular_velocity = (0.0, speed / 0.03, 0.0)
    world.step(30)
    assert body.linear_velocity[0] == pytest.approx(speed, rel=0.02)


ROUND_SHAPES = {
    "cylinder": lambda radius, length: vx.Cylinder(radius, length),
    "capsule": lambda radius, length: vx.Capsule(radius, length),
}


def add_both(world, ground_first, *adds):
    """Returns what the last of `adds` returns; it comes last, or first."""
    if ground_first:
        return [add(world) for add in adds][-1]
    body = adds[-1](world)
    for add in adds[:-1]:
        add(world)
    return body


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("ground_first", [True, False])
@pytest.mark.parametrize("name", ROUND_SHAPES)
def test_wheels_of_bullets_roll_over_a_terrain(name, ground_first, rate):
    """They came 0.96, 0.78, 0.25 and 0.28 of the way."""
    radius, speed, seconds = 0.05, 1.0, 1.5
    inertia = 0.5 if name == "cylinder" else 0.45
    exact, center = way_over_terrain(radius, inertia, speed, seconds)
    world = vx.World(gravity=(0.0, 0.0, -GRAVITY), time_step=1 / rate)
    pose = pose_of((center[0], 0.0, center[1]), ALONG_Y)
    body = add_both(
        world,
        ground_first,
        lambda world: world.add(terrain(), mass=0.0, friction=1.0),
        lambda world: world.add(
            ROUND_SHAPES[name](radius, 0.04), mass=0.3, pose=pose, friction=1.0
        ),
    )
    uphill = np.array([1.0, 0.0, 2.0 * math.pi * WAVE / WAVE_LENGTH])
    body.linear_velocity = speed * uphill / np.linalg.norm(uphill)
    body.angular_velocity = (0.0, speed / radius, 0.0)
    world.step(round(seconds * rate))
    way = body.pose[0, 3] - center[0]
    assert way / exact > {1000: 0.99, 200: 0.98, 60: 0.95, 30: 0.91}[rate]
    assert way / exact < 1.01
    assert abs(body.pose[1, 3]) < 1e-3


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("ground_first", [True, False])
@pytest.mark.parametrize("name", ROUND_SHAPES)
def test_cylinders_of_bullets_roll_across_bars(name, ground_first, rate):
    """They kept 0.10 of 0.3 m/s at 60 Hz, and 0.05 at 30."""
    world = vx.World(gravity=(0.0, 0.0, -GRAVITY), time_step=1 / rate)

    def add_bar(y):
        pose = pose_of((0.0, y, -0.01), ALONG_X)
        return lambda world: world.add(thin_bar(), mass=0.0, pose=pose, friction=1.0)

    body = add_both(
        world,
        ground_first,
        add_bar(-0.06),
        add_bar(0.06),
        lambda world: world.add(
            ROUND_SHAPES[name](0.03, 0.2),
            mass=0.5,
            pose=pose_of((-0.4, 0.0, 0.03), ALONG_Y),
            friction=1.0,
        ),
    )
    body.linear_velocity = (0.3, 0.0, 0.0)
    body.angular_velocity = (0.0, 10.0, 0.0)
    world.step(3 * rate // 2)
    assert body.linear_velocity[0] == pytest.approx(0.3, rel=0.02)
    assert abs(body.pose[1, 3]) < 1e-3


@pytest.mark.parametrize(("rate", "left"), [(1000, 0.98), (200, 0.94), (60, 0.8)])
@pytest.mark.parametrize("name", ROUND_SHAPES)
def test_shafts_of_bullets_swing_in_a_bearing(name, left, rate):
    """They kept 0.90, 0.54 and 0.08 of the angle; steps without a bend cost what is allowed."""
    start = math.radians(30.0)
    world = vx.World(gravity=(0.0, 0.0, -GRAVITY), time_step=1 / rate)
    world.add(wide_bearing(0.06), mass=0.0, pose=pose_of((0, 0, 0), ALONG_Y), friction=1.0)
    center = 0.022 * np.array([math.sin(start), 0.0, -math.cos(start)])
    body = world.add(
        ROUND_SHAPES[name](0.018, 0.04), mass=0.3, pose=pose_of(center, ALONG_Y), friction=1.0
    )
    angles = []
    for _ in range(rate):
        world.step()
        angles.append(math.atan2(body.pose[0, 3], -body.pose[2, 3]))
    assert max(np.abs(angles[-2 * rate // 5 :])) > left * start


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("name", ROUND_SHAPES)
def test_cylinders_of_bullets_slide_along_a_trough(name, rate):
    """On its smooth surface: cylinders lay on its facets, 0.02 mm higher."""
    world = vx.World(gravity=(0.0, 0.0, -GRAVITY), time_step=1 / rate)
    world.add(trough(), mass=0.0, pose=pose_of((0, 0, 0), PROFILE), friction=0.0)
    pose = pose_of((-0.5, 0.0, -0.04), ALONG_X)
    body = world.add(ROUND_SHAPES[name](0.02, 0.06), mass=0.3, pose=pose, friction=0.0)
    body.linear_velocity = (0.4, 0.0, 0.0)
    world.step(rate)
    assert body.linear_velocity[0] == pytest.approx(0.4, rel=1e-3)
    assert np.abs(body.pose[:3, 3] - (-0.1, 0.0, -0.04)).max() < 1e-5


@pytest.mark.parametrize("rate", [200, 60])
@pytest.mark.parametrize("seed", [1, 19, 31, 43, 61, 67])
def test_cylinders_of_bullets_stop_at_a_thin_bar(seed, rate):
    """The place that is nearest before the step passes beside the bar, and others hit it."""
    world = vx.World(gravity=(0.0, 0.0, 0.0), time_step=1 / rate)
    world.add(thin_bar(), mass=0.0, pose=pose_of((0, 0, 0), ALONG_X))
    turned = Rotation.random(random_state=seed)
    body = world.add(vx.Cylinder(0.02, 0.05), mass=0.1, pose=pose_of((0.0, 0.0, 0.3), turned))
    body.linear_velocity = (0.0, 0.0, -20.0)
    body.angular_velocity = np.random.default_rng(seed).normal(size=3) * 5.0
    world.step(max(2, int(0.03 * rate)))
    assert body.linear_velocity[2] > -18.0
