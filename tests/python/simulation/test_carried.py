"""Bodies at rest that gravity would move far within a step: what carries them is known from the step before."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
import trimesh
import voxshell as vx


@cache
def build_box(*sides: float) -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.box(sides))


@cache
def build_ellipsoid(*axes: float) -> vx.Model:
    mesh = trimesh.creation.icosphere(4)
    mesh.apply_scale(axes)
    return vx.Model.from_mesh(mesh)


@pytest.mark.parametrize(("side", "rate"), [(0.1, 60), (0.5, 30), (0.005, 200), (0.5, 200)])
def test_a_stack_rests_on_its_corners_at_every_rate(side: float, rate: int) -> None:
    # Within a step, gravity moves them by up to 11 mm. All points of the sides that it could bring to
    # the ground were contacts: 14 times as many, and 25 times the time of a step.
    world = vx.World(time_step=1 / rate, sleeping=False)
    world.add(build_box(20 * side, 20 * side, side), mass=0, pose=(0, 0, -side / 2))
    bodies = [
        world.add(build_box(side, side, side), mass=1000 * side**3, pose=(0, 0, side * (i + 0.5)))
        for i in range(5)
    ]
    world.step(2 * rate)
    assert len(world.contacts()) == 20
    for i, body in enumerate(bodies):
        assert body.position[2] == pytest.approx(side * (i + 0.5), abs=2e-4 * side)


@pytest.mark.parametrize("rate", [200, 60, 30])
def test_a_body_between_two_tables_is_carried_by_both(rate: int) -> None:
    world = vx.World(time_step=1 / rate, sleeping=False)
    for x in (-0.15, 0.15):
        world.add(build_box(0.2, 0.2, 0.1), mass=0, pose=(x, 0, -0.05))
    bar = world.add(build_box(0.3, 0.06, 0.04), mass=1, pose=(0, 0, 0.02))
    world.step(2 * rate)
    assert len(world.contacts()) <= 12
    assert bar.position == pytest.approx([0, 0, 0.02], abs=2e-5)


@pytest.mark.parametrize("rate", [200, 60, 30])
def test_what_loses_its_support_lands_on_what_is_close_below(rate: int) -> None:
    # Nearer than gravity takes it in the first step.
    world = vx.World(time_step=1 / rate, sleeping=False)
    world.add(build_box(1, 1, 0.1), mass=0, pose=(0, 0, -0.05))
    plate = world.add(build_box(0.3, 0.3, 0.002), mass=0, pose=(0, 0, 0.0015 + 0.001))
    cube = world.add(build_box(0.1, 0.1, 0.1), mass=1, pose=(0, 0, 0.0015 + 0.002 + 0.05))
    world.step(rate)
    world.remove(plate)
    for _ in range(rate):
        world.step()
        assert cube.position[2] > 0.05 - 3e-4
    assert cube.position[2] == pytest.approx(0.05, abs=1e-4)


@pytest.mark.parametrize(("rate", "most"), [(200, 2e-3), (60, 4.5e-3), (30, 6.5e-3)])
def test_an_ellipsoid_that_lands_aslant_rocks_on_a_slab_as_on_a_plane(
    rate: int, most: float
) -> None:
    # The slab's own samples lead to the place that touches now. The places of the ellipsoid that
    # come next were dropped for it, and were up to 7.5 and 16 mm deep.
    axes = np.array((0.08, 0.05, 0.03))
    for ground in (build_box(2, 2, 0.1), vx.Box((1, 1, 0.05))):
        world = vx.World(time_step=1 / rate)
        world.add(ground, mass=0, pose=(0, 0, -0.05))
        pose = trimesh.transformations.rotation_matrix(math.radians(30), (0, 1, 0))
        pose[2, 3] = np.linalg.norm(axes * pose[2, :3]) + 0.05
        body = world.add(build_ellipsoid(*axes), mass=0.1, pose=pose)
        for _ in range(rate // 2):
            world.step()
            depth = np.linalg.norm(axes * body.pose[2, :3]) - body.position[2]
            assert depth < most
