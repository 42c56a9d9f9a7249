"""Two bodies on sliders, one of which drives the other with its inclined face."""

from __future__ import annotations

import math

import pytest
import trimesh
import voxshell as vx
from shapely.geometry import Polygon


def build_prism(corners, length):
    mesh = trimesh.creation.extrude_polygon(Polygon(corners), length)
    mesh.apply_translation((0, 0, -length / 2))
    return mesh.apply_transform(trimesh.transformations.rotation_matrix(math.pi / 2, (1, 0, 0)))


# What passes the edge of a face that the other body is flush with held the bodies at the speed that they had: the wedge
# had as little as 0.48 of its speed at 60 Hz and 0.94 at 200 Hz.
@pytest.mark.parametrize("rate", [1000, 200, 60])
@pytest.mark.parametrize("driven_mass", [0.3, 3.0])
@pytest.mark.parametrize("angle", [15, 25, 45])
def test_a_wedge_drives_a_block_as_fast_as_it_should(angle, driven_mass, rate):
    slope, height, mass = math.tan(math.radians(angle)), 0.12, 2.0
    block = build_prism(
        [
            (0, 0),
            (0.2 + height * slope, 0),
            (0.2 + height * slope, height),
            (height * slope, height),
        ],
        0.12,
    )
    wedge = build_prism([(0, 0), (0.05, 0), (0.05 + 0.15 * slope, 0.15), (0, 0.15)], 0.12)
    world = vx.World(1 / rate)
    start = (0.05 - 0.08 * slope + 2e-5, 0, 0)
    driven = world.add(block, mass=driven_mass, friction=0, pose=start)
    driver = world.add(wedge, mass=mass, friction=0, pose=(0, 0, 0.08))
    world.add_joint(vx.SliderJoint(axis=(1, 0, 0)), None, driven)
    world.add_joint(vx.SliderJoint(axis=(0, 0, 1)), None, driver)
    acceleration = 9.81 * mass / (mass + driven_mass * slope**2)
    steps = int(math.sqrt(2 * 0.06 / acceleration) * rate)
    world.step(steps)
    assert -driver.linear_velocity[2] == pytest.approx(acceleration / rate * steps, rel=0.01)
