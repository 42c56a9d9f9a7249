"""Round bodies that meet an edge, a wire or a bar within a step do not enter it: the place that will touch is not the
one that is nearest at its start."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx
from trimesh.transformations import random_rotation_matrix, rotation_matrix

RADIUS = 0.03  # meters
RATES = (200, 60, 30)


@pytest.fixture(scope="module")
def ball() -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.icosphere(4, RADIUS))


def rod(radius: float) -> vx.Model:
    mesh = trimesh.creation.cylinder(radius, 0.3, sections=64)
    mesh.apply_transform(rotation_matrix(np.pi / 2, (1, 0, 0)))
    return vx.Model.from_mesh(mesh)


SLABS = {
    "model": lambda: vx.Model.from_mesh(trimesh.creation.box((0.1, 0.3, 0.1))),
    "box": lambda: vx.Box((0.05, 0.15, 0.05)),
}


@pytest.mark.parametrize(
    ("name", "rate"), [("model", 200), ("model", 60), ("model", 30), ("box", 60), ("box", 30)]
)
def test_a_ball_that_falls_past_an_edge_stays_outside(ball: vx.Model, name: str, rate: int) -> None:
    slab = SLABS[name]()
    worst = 0.0
    for seed in range(7):
        rng = np.random.default_rng(seed)
        world = vx.World(time_step=1 / rate)
        world.add(slab, mass=0, pose=(-0.05, 0, -0.05))
        pose = random_rotation_matrix(rng.random(3))
        fall = rng.uniform(0.01, 0.3)
        pose[:3, 3] = rng.uniform(0.1, 0.9) * RADIUS, rng.uniform(-0.02, 0.02), RADIUS + fall
        body = world.add(ball, mass=0.1, pose=pose)
        for _ in range(int(rate * (np.sqrt(2 * fall / 9.81) + 0.1))):
            world.step()
            place = body.position
            apart = place - np.clip(place, (-0.1, -0.15, -0.1), (0, 0.15, 0))
            worst = max(worst, RADIUS - np.linalg.norm(apart))
    assert worst < 0.03 * RADIUS


@pytest.mark.parametrize("rate", RATES)
def test_a_ball_that_is_thrown_aslant_at_a_wire_does_not_pass_it(rate: int) -> None:
    radius, wire_radius, speed = 0.005, 0.0005, 3.0
    ball = vx.Model.from_mesh(trimesh.creation.icosphere(4, radius))
    wire = rod(wire_radius)
    for seed in range(12):
        rng = np.random.default_rng(seed)
        world = vx.World(time_step=1 / rate, gravity=(0, 0, 0))
        world.add(wire, mass=0, friction=0)
        velocity = np.array((*rng.normal(size=2) * 0.3, -1))
        velocity *= speed / np.linalg.norm(velocity)
        pose = random_rotation_matrix(rng.random(3))
        across = np.array((-velocity[2], 0, velocity[0])) / np.hypot(velocity[0], velocity[2])
        middle = rng.uniform(-0.6, 0.6) * radius * across
        pose[:3, 3] = middle - velocity * rng.uniform(0.1, 0.15)
        body = world.add(ball, mass=0.001, pose=pose, friction=0)
        body.linear_velocity = velocity
        world.step(int(0.25 * rate))
        assert np.linalg.norm(body.linear_velocity - velocity) > 0.1 * speed, seed


@pytest.mark.parametrize("rate", RATES)
def test_a_ball_that_falls_on_a_rod_stays_outside(ball: vx.Model, rate: int) -> None:
    radius, fall = 0.005, 0.45
    bar = rod(radius)
    for seed in range(7):
        rng = np.random.default_rng(seed)
        world = vx.World(time_step=1 / rate)
        world.add(bar, mass=0)
        pose = random_rotation_matrix(rng.random(3))
        pose[:3, 3] = (
            rng.uniform(-0.5, 0.5) * RADIUS,
            rng.uniform(-0.02, 0.02),
            RADIUS + radius + fall,
        )
        body = world.add(ball, mass=0.1, pose=pose)
        for _ in range(int(rate * (np.sqrt(2 * fall / 9.81) + 0.06))):
            world.step()
            x, _, z = body.position
            assert np.hypot(x, z) > 0.95 * (RADIUS + radius), seed
