from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx
from parts import random_rotation
from voxshell.model.meshes import Mesh
from voxshell.robots.sheets import find_sheet


def as_mesh(made: trimesh.Trimesh) -> Mesh:
    return Mesh(np.array(made.vertices), made.faces.astype(np.uint32))


def make_panels(count: int) -> Mesh:
    """A row of squares, every second one facing the other way."""
    corners = [(x, y, 0.0) for x in range(count + 1) for y in (0, 1)]
    faces = []
    for i in range(count):
        two = np.array([(2 * i, 2 * i + 2, 2 * i + 1), (2 * i + 1, 2 * i + 2, 2 * i + 3)])
        faces.append(two if i % 2 else two[:, ::-1])
    return Mesh(np.array(corners, dtype=float), np.concatenate(faces).astype(np.uint32))


def area_of(mesh: Mesh) -> float:
    return float(trimesh.Trimesh(*mesh, process=False).area)


def test_panels_that_face_both_ways_stay_whole():
    panels = make_panels(10)
    sheet = find_sheet(panels)
    assert sheet is not None
    assert area_of(sheet.mesh) == pytest.approx(10.0)
    normals = trimesh.Trimesh(*sheet.mesh, process=False).face_normals
    np.testing.assert_allclose(normals, np.tile(sheet.normal, (20, 1)), atol=1e-12)


def test_both_sides_of_a_plate_are_one_also_where_corners_are_repeated():
    plate = trimesh.creation.box((2, 1, 0))
    soup = Mesh(
        np.array(plate.triangles.reshape(-1, 3)),
        np.arange(36, dtype=np.uint32).reshape(-1, 3),
    )
    for mesh in (as_mesh(plate), soup):
        sheet = find_sheet(mesh)
        assert sheet is not None
        assert area_of(sheet.mesh) == pytest.approx(2.0)
        assert sheet.thickness == 0.005


@pytest.mark.parametrize("decimals", [6, 8, 12])
def test_a_plate_in_any_direction_with_few_digits_is_flat(decimals: int):
    rng = np.random.default_rng(1)
    for _ in range(20):
        plate = trimesh.creation.box((0.05, 0.03, 0))
        vertices = np.round(plate.vertices @ random_rotation(rng).T + rng.normal(size=3), decimals)
        sheet = find_sheet(Mesh(vertices, plate.faces.astype(np.uint32)))
        assert sheet is not None
        assert sheet.thickness == pytest.approx(0.05 / 200, rel=0.5)


@pytest.mark.parametrize(
    "mesh",
    [
        as_mesh(trimesh.creation.box((1, 1, 1e-3))),
        Mesh(np.eye(3)[[0, 0, 0]] * [[1], [2], [3]], np.array([[0, 1, 2]], np.uint32)),
        Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.uint32)),
    ],
    ids=["a thin box", "a line", "nothing"],
)
def test_what_has_a_volume_or_no_area_is_no_sheet(mesh: Mesh):
    assert find_sheet(mesh) is None


@pytest.mark.parametrize("side", [0.02, 1.0, 100.0])
def test_a_ball_rests_on_sheets_of_all_sizes(side: float):
    sheet = find_sheet(as_mesh(trimesh.creation.box((side, side, 0))))
    assert sheet is not None
    radius = 0.2 * min(side, 1.0)
    world = vx.World()
    shape = vx.Model.from_mesh(sheet.mesh, open="sheet", sheet_thickness=sheet.thickness)
    world.add(shape, mass=0)
    ball = world.add(vx.Sphere(radius), pose=(0.1 * side, 0.05 * side, 2.0 * radius))
    world.step(400)
    assert ball.position[2] == pytest.approx(radius + 0.5 * sheet.thickness, abs=1e-3 * radius)
