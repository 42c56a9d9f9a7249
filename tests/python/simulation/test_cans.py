"""Cans that land on their side while they roll: their rims touch with their lowest places, which roll on."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import trimesh
import voxshell as vx


@cache
def build_can(radius: float, height: float) -> vx.Model:
    mesh = trimesh.creation.cylinder(radius=radius, height=height, sections=96)
    mesh.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, (1, 0, 0)))
    return vx.Model.from_mesh(mesh)


@cache
def build_slab() -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.box((4, 1, 0.1)))


@pytest.mark.parametrize("rate", [200, 60, 30])
@pytest.mark.parametrize("speed", [0.5, 1.0])
@pytest.mark.parametrize("height", [0.002, 0.02])
def test_a_rolling_can_that_lands_goes_on_rolling(rate: int, speed: float, height: float) -> None:
    # At 30 Hz it lost up to two thirds of its speed.
    radius = 0.05
    world = vx.World(time_step=1 / rate)
    world.add(build_slab(), mass=0, pose=(1, 0, -0.05))
    can = world.add(build_can(radius, 0.06), mass=1, pose=(0, 0, radius + height))
    can.linear_velocity = (speed, 0, 0)
    can.angular_velocity = (0, speed / radius, 0)
    world.step(rate // 2)
    assert can.linear_velocity[0] == pytest.approx(speed, rel=0.02)
    assert can.position[1] == pytest.approx(0, abs=1e-3)
