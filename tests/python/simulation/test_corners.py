"""Bodies that touch several walls of one mesh within a step rebound from each."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx

RATES = (1000, 200, 60)


def hollow(outer: tuple[float, float, float], inner: trimesh.Trimesh) -> vx.Model:
    block = trimesh.creation.box(outer)
    return vx.Model.from_mesh(trimesh.boolean.difference([block, inner], engine="manifold"))


@pytest.fixture(scope="module")
def tray() -> vx.Model:
    """Its floor is at z = 0, and its walls at x = -0.25 and 0.25 m."""
    inner = trimesh.creation.box((0.5, 0.3, 0.2))
    inner.apply_translation((0.0, 0.0, 0.1))
    return hollow((0.54, 0.34, 0.1), inner)


BODIES = {
    "ball": lambda: vx.Model.from_mesh(trimesh.creation.icosphere(4, 0.03)),
    "cube": lambda: vx.Model.from_mesh(trimesh.creation.box((0.06, 0.06, 0.06))),
    "sphere": lambda: vx.Sphere(0.03),
}


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("name", BODIES)
def test_what_slides_in_a_tray_rebounds_from_its_wall(tray: vx.Model, name: str, rate: int) -> None:
    world = vx.World(time_step=1 / rate)
    world.add(tray, mass=0, friction=0, restitution=0.9)
    body = world.add(BODIES[name](), mass=0.2, friction=0, restitution=0.9, pose=(0, 0, 0.03))
    world.step(rate // 4)
    body.linear_velocity = (1, 0, 0)
    world.step(int(0.4 * rate))
    assert body.linear_velocity == pytest.approx((-0.81, 0, 0), abs=0.01)
    assert body.position[2] == pytest.approx(0.03, abs=3e-4)


def test_a_ball_in_a_closed_can_keeps_its_speed() -> None:
    """It meets the lid and the wall within a step, near one and the same part of its shell."""
    can = vx.Model.from_mesh(
        trimesh.boolean.difference(
            [
                trimesh.creation.cylinder(0.11, 0.22, sections=96),
                trimesh.creation.cylinder(0.1, 0.2, sections=96),
            ],
            engine="manifold",
        )
    )
    ball = vx.Model.from_mesh(trimesh.creation.icosphere(4, 0.02))
    for seed in range(4):
        world = vx.World(time_step=1 / 200, gravity=(0, 0, 0))
        world.add(can, mass=0, friction=0, restitution=1)
        body = world.add(ball, mass=0.01, friction=0, restitution=1)
        direction = np.random.default_rng(seed).normal(size=3)
        body.linear_velocity = 5 * direction / np.linalg.norm(direction)
        world.step(400)
        assert np.linalg.norm(body.linear_velocity) == pytest.approx(5.0, rel=0.02), seed


@pytest.mark.parametrize("rate", RATES)
def test_a_ball_in_a_closed_box_keeps_its_speed(rate: int) -> None:
    """It is smooth and elastic."""
    box = hollow((0.22, 0.22, 0.22), trimesh.creation.box((0.2, 0.2, 0.2)))
    ball = BODIES["ball"]()
    for seed in range(4):
        world = vx.World(time_step=1 / rate, gravity=(0, 0, 0))
        world.add(box, mass=0, friction=0, restitution=1)
        body = world.add(ball, mass=0.01, friction=0, restitution=1)
        direction = np.random.default_rng(seed).normal(size=3)
        body.linear_velocity = direction / np.linalg.norm(direction)
        world.step(2 * rate)
        assert np.linalg.norm(body.linear_velocity) == pytest.approx(1.0, abs=0.02), seed
        assert np.abs(body.position).max() < 0.0701, seed
