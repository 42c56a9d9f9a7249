"""Round bodies that roll down narrow models, beside closed forms, at default settings.

Rails have their samples far apart, and a body touches them along their edges.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
import voxshell as vx
from poses import pose_of
from scipy.spatial.transform import Rotation
from trimesh.creation import box, cylinder, icosphere

GRAVITY = 9.81  # m/s2
SLOPE = math.radians(10.0)
SECONDS = 0.6

# Shape, height of its center over the rails, their places across and width, and the moment of
# inertia as a fraction of that of a thin hoop of that radius.
LOW = math.sqrt(0.06**2 - 0.025**2)
BODIES = {
    "barrel": (lambda: model_of(cylinder(0.1, 0.5, sections=128)), 0.1, (-0.15, 0.15), 0.04, 0.5),
    "Bullet's cylinder": (lambda: vx.Cylinder(0.1, 0.5), 0.1, (-0.15, 0.15), 0.04, 0.5),
    "Bullet's cylinder on wide rails": (
        lambda: vx.Cylinder(0.1, 0.5),
        0.1,
        (-0.15, 0.15),
        0.1,
        0.5,
    ),
    "Bullet's ball on one rail": (lambda: vx.Sphere(0.1), 0.1, (0.0,), 0.1, 0.4),
    "ball between two rails": (
        lambda: model_of(icosphere(5, radius=0.06)),
        LOW,
        (-0.045, 0.045),
        0.04,
        0.4 * (0.06 / LOW) ** 2,
    ),
    "Bullet's ball between two rails": (
        lambda: vx.Sphere(0.06),
        LOW,
        (-0.045, 0.045),
        0.04,
        0.4 * (0.06 / LOW) ** 2,
    ),
}


def model_of(mesh):
    return vx.Model.from_mesh(mesh)


@cache
def build(name):
    return BODIES[name][0]()


@cache
def build_rail(length, width):
    return model_of(box((length, width, 0.04)))


def roll_down(name, length, *, rate, heading=0.0, rails_first=True):
    """Returns the way down the rails, that of theory, and the speed across them."""
    _, height, places, width, inertia = BODIES[name]
    turned = Rotation.from_euler("z", heading) * Rotation.from_euler("y", SLOPE)
    slope = pose_of((0.0, 0.0, 0.0), turned)
    world = vx.World(gravity=(0.0, 0.0, -GRAVITY), time_step=1 / rate)

    def add_rails():
        for place in places:
            pose = slope @ pose_of((0.35 * length, place, -0.02))
            world.add(build_rail(length, width), mass=0.0, pose=pose, friction=1.0)

    if rails_first:
        add_rails()
    lying = pose_of((0.0, 0.0, height), Rotation.from_euler("x", 90.0, degrees=True))
    body = world.add(build(name), mass=1.0, pose=slope @ lying, friction=0.8)
    if not rails_first:
        add_rails()
    world.step(round(SECONDS * rate))
    pull = GRAVITY * math.sin(SLOPE) / (1.0 + inertia)
    way = (np.linalg.inv(slope) @ body.pose)[0, 3]
    across = slope[:3, 1] @ body.linear_velocity
    return way, 0.5 * pull * SECONDS * (SECONDS + 1 / rate), across


@pytest.mark.parametrize("rate", [1000, 200, 60, 30])
@pytest.mark.parametrize("length", [1.5, 4.0])
@pytest.mark.parametrize("name", BODIES)
def test_round_bodies_roll_down_rails(name, length, rate):
    for heading, rails_first in [(0.0, True), (0.7, False), (2.0, True)]:
        way, expected, across = roll_down(
            name, length, rate=rate, heading=heading, rails_first=rails_first
        )
        assert way == pytest.approx(expected, rel=0.01)
        assert abs(across) < 2e-3


def test_a_cylinder_touches_rails_up_to_their_edges():
    world = vx.World(time_step=1 / 200)
    for place in (-0.15, 0.15):
        world.add(build_rail(4.0, 0.04), mass=0.0, pose=pose_of((1.0, place, -0.02)))
    lying = pose_of((0.0123, 0.0, 0.1), Rotation.from_euler("x", 90.0, degrees=True))
    world.add(build("Bullet's cylinder"), mass=1.0, pose=lying)
    world.step()
    contacts = world.contacts()
    assert np.abs(contacts["point_a"][:, 0] - 0.0123) == pytest.approx(0.0, abs=1e-4)
    assert np.abs(contacts["normal"][:, 2]) == pytest.approx(1.0, abs=1e-6)
    ends = np.unique(np.abs(contacts["point_a"][:, 1]).round(4))
    assert ends[0] == pytest.approx(0.13, abs=1e-3)
    assert ends[-1] == pytest.approx(0.17, abs=1e-3)
