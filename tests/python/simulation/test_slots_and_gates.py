"""Bodies that pass close by the edges of a concave one: nothing that they do not touch stops them, all that they fall on does."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import trimesh
import voxshell as vx
from shapely.geometry import LineString
from trimesh.creation import box, cylinder, extrude_polygon

RATES = (200, 60, 30)
PHASES = 4


def box_at(size: tuple[float, float, float], place: tuple[float, float, float]) -> trimesh.Trimesh:
    mesh = box(size)
    mesh.apply_translation(place)
    return mesh


@cache
def gate(clearance: float) -> vx.Model:
    """A floor and a gate on it in one mesh, wider and higher than a cube of 60 mm."""
    top = 0.06 + clearance
    side = 0.03 + clearance + 0.025
    parts = [
        box_at((1.2, 0.5, 0.05), (0, 0, -0.025)),
        box_at((0.05, 0.3, 0.05), (0, 0, top + 0.025)),
        *(box_at((0.05, 0.05, top + 0.02), (0, y, top / 2)) for y in (-side, side)),
    ]
    return vx.Model.from_mesh(trimesh.boolean.union(parts, engine="manifold"))


@cache
def cube() -> vx.Model:
    return vx.Model.from_mesh(box((0.06, 0.06, 0.06)))


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("clearance", [0.002, 0.01])
def test_a_cube_slides_through_a_gate_that_is_one_mesh_with_its_floor(
    rate: int, clearance: float
) -> None:
    for phase in range(PHASES):
        world = vx.World(time_step=1 / rate)
        world.add(gate(clearance), mass=0, friction=0)
        start = -0.25 - phase / PHASES / rate
        body = world.add(cube(), mass=0.2, friction=0, pose=(start, 0, 0.03))
        body.linear_velocity = (1, 0, 0)
        world.step(round(0.5 * rate))
        assert body.linear_velocity[0] == pytest.approx(1.0, abs=1e-3)


@cache
def slotted_plate(width: float) -> vx.Model:
    """A plate of 4 mm, upright, with a slot of 25 mm between its ends."""
    outline = LineString([(0, -0.0125), (0, 0.0125)])
    plate = outline.buffer(0.015).difference(outline.buffer(width / 2, quad_segs=32))
    mesh = extrude_polygon(plate, 0.004)
    mesh.apply_translation((0, 0, -0.002))
    # Along x, upright.
    mesh.apply_transform([[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    return vx.Model.from_mesh(mesh)


@cache
def rod(radius: float) -> vx.Model:
    mesh = cylinder(radius, 0.1, sections=64)
    mesh.apply_transform([[0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]])
    return vx.Model.from_mesh(mesh)


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("width", [0.0042, 0.005])
def test_a_slot_that_falls_on_a_rod_hangs_on_it(rate: int, width: float) -> None:
    # Where the upper end of the slot lies on the rod.
    hangs = 0.002 - (0.0125 + width / 2)
    for height in (0.008, 0.0125, 0.018):
        world = vx.World(time_step=1 / rate)
        world.add(rod(0.002), mass=0)
        plate = world.add(slotted_plate(width), mass=0.05, pose=(0, 0, hangs + height))
        lowest = np.inf
        for _ in range(rate):
            world.step()
            lowest = min(lowest, plate.position[2])
        assert lowest == pytest.approx(hangs, abs=3e-4)
        assert plate.position[2] == pytest.approx(hangs, abs=1e-4)


@cache
def peg_between_panes() -> vx.Model:
    """Two panes that are 20 mm apart, and a peg of 8 mm from one to the other; samples 3 mm apart."""
    peg = cylinder(0.004, 0.03, sections=32)
    peg.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, (1, 0, 0)))
    panes = [box_at((0.65, 0.01, 0.6), (0, y, 0)) for y in (-0.015, 0.015)]
    return vx.Model.from_mesh(trimesh.boolean.union([peg, *panes], engine="manifold"))


def test_a_ball_that_hits_a_peg_between_panes_stays_between_them() -> None:
    """In 4 of 100 falls, what touched the panes was taken for samples of what touched the peg."""
    random = np.random.default_rng(0)
    ball = vx.Model.from_mesh(trimesh.creation.icosphere(5, radius=0.008))
    deepest = 0.0
    for _ in range(100):
        world = vx.World(time_step=1 / 60)
        world.add(peg_between_panes(), mass=0, friction=0.3, restitution=0.55)
        position = random.uniform((-0.004, -0.0019, 0.0125), (0.004, 0.0019, 0.0425))
        pose = vx.pose(position, euler=random.uniform(-np.pi, np.pi, 3))
        body = world.add(ball, mass=0.01, friction=0.3, restitution=0.55, pose=pose)
        body.linear_velocity = (random.uniform(-0.2, 0.2), 0, -0.9)
        body.angular_velocity = random.normal(size=3) * 30
        for _ in range(15):
            world.step()
            deepest = max(deepest, abs(body.position[1]) - 0.002)
    assert deepest < 1.5e-3


def test_cones_on_a_slab_as_thin_as_a_voxel_do_not_end_the_process():
    """Halfway through such a slab its field has no gradient. A null pointer was read there."""
    cone = vx.Model.from_mesh(trimesh.creation.cone(radius=0.05, height=0.08))
    slab = vx.Model.from_mesh(trimesh.creation.box((0.6, 0.6, 0.02)), voxel_size=0.02)
    world = vx.World()
    world.add(slab, mass=0.0, pose=(0, 0, -0.01))
    for i in range(8):
        place = ((i % 3 - 1) * 0.15 + 0.003 * i, (i // 3 - 1) * 0.15, 0.01 + 0.002 * i)
        world.add(cone, pose=place)
    world.step(60)
    assert all(np.isfinite(body.pose).all() for body in world.bodies)
