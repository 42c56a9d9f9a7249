"""Round bodies on round models, and in grooves of one, at default settings.

Meshes of models have facets. What rolls over these feels the smooth surface they stand for.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
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
