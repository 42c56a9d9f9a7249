"""Meshes with open edges: solids and sheets."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
import trimesh
import voxshell as vx
from poses import at
from splinters import make_open_splinter


def tube(radius: float = 0.05, length: float = 0.3) -> trimesh.Trimesh:
    whole = trimesh.creation.cylinder(radius=radius, height=length, sections=64)
    return trimesh.Trimesh(whole.vertices, whole.faces[np.abs(whole.face_normals[:, 2]) < 0.5])


def bowl(radius: float = 0.1) -> trimesh.Trimesh:
    ball = trimesh.creation.icosphere(subdivisions=4, radius=radius)
    low = (ball.vertices[ball.faces][:, :, 2] < 1e-6).all(axis=1)
    return trimesh.Trimesh(ball.vertices, ball.faces[low])


def quietly(mesh: trimesh.Trimesh, **options: object) -> vx.Model:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", vx.MeshWarning)
        return vx.Model.from_mesh(mesh, **options)


def test_a_tube_lets_a_ball_through_and_collides_from_both_sides():
    with pytest.warns(
        vx.MeshWarning, match="2 of them are ends of a tube, so voxshell kept it"
    ) as said:
        model = vx.Model.from_mesh(tube())
    [warning] = said
    for words in (
        "2 openings",
        "the largest 0.1 m across",
        "near [0.04988, 0.00245, -0.15]",
        "open='solid'",
    ):
        assert words in str(warning.message)
    half = model.thickness / 2
    ball = vx.Sphere(0.02)
    for z in np.linspace(-0.3, 0.3, 31):
        assert not vx.collide(model, ball, b_pose=at(z=z))
    for x in (0.05 - half - 0.02 + 0.001, 0.05 + half + 0.02 - 0.001):
        assert vx.collide(model, ball, b_pose=at(x=x))
    plugged = quietly(tube(), open="solid")
    assert plugged.field.sample([[0.0, 0.0, 0.0]]) < 0.0


def test_a_tube_has_depths_and_normals_on_both_sides():
    model = quietly(tube(), resolution=100)
    half = model.thickness / 2
    ball = vx.Sphere(0.02)
    inside = vx.contacts(model, ball, b_pose=at(x=0.05 - half - 0.02 + 0.001))
    outside = vx.contacts(model, ball, b_pose=at(x=0.05 + half + 0.02 - 0.001))
    for found in (inside, outside):
        assert found.depths.max() == pytest.approx(0.001, abs=0.0003)
    # Normals point from the ball to the wall.
    assert inside.normals[inside.depths.argmax()][0] == pytest.approx(1.0, abs=0.05)
    assert outside.normals[outside.depths.argmax()][0] == pytest.approx(-1.0, abs=0.05)


def test_a_bowl_holds_a_ball():
    model = quietly(bowl())
    assert not vx.collide(model, vx.Sphere(0.03), b_pose=at(z=-0.05))
    assert vx.collide(model, vx.Sphere(0.03), b_pose=at(z=-0.07))
    assert quietly(bowl(), open="solid").field.sample([[0.0, 0.0, -0.05]]) < 0.0


def test_a_square_is_a_plate():
    square = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    model = vx.Model.from_mesh(square, resolution=100, open="sheet", sheet_thickness=0.04)
    assert model.thickness == pytest.approx(0.04)
    for side in (-1, 1):
        ball = at(0.5, 0.5, side * (0.02 + 0.1 - 0.005))
        assert vx.contacts(model, vx.Sphere(0.1), b_pose=ball).depths.max() == pytest.approx(
            0.005, 0.1
        )


@pytest.mark.parametrize("seed", [1, 2, 7])
def test_a_sheet_has_all_of_the_surface_of_an_open_splinter(seed: int):
    # Around its sharp ends, the mean of the normals points away from some faces. Up to half of the
    # surface was missing.
    mesh = make_open_splinter(seed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = vx.Model.from_mesh(mesh, open="sheet")
        places = trimesh.sample.sample_surface(mesh, 200, seed=1)[0]
        apart = [vx.distance(model, vx.Sphere(1e-9), None, place).distance for place in places]
    assert max(apart) <= 2e-5  # the sheet is 0.1 mm thick


def test_a_ball_on_a_plate_by_tolerance_is_as_deep_as_it_is():
    square = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    model = vx.Model.from_mesh(square, open="sheet", sheet_thickness=0.04)
    found = vx.contacts(model, vx.Sphere(0.1), b_pose=at(0.5, 0.5, 0.02 + 0.1 - 0.005))
    assert found.depths.max() == pytest.approx(0.005, 0.1)


def test_doubled_faces_are_no_openings():
    box = trimesh.creation.box((0.1, 0.1, 0.1))
    doubled = (box.vertices, np.vstack([box.faces, box.faces[:2]]))
    with pytest.warns(vx.MeshWarning):
        model = vx.Model.from_mesh(doubled)
    assert model.field.sample([[0, 0, 0]]) == pytest.approx(-0.05, abs=1e-3)


def test_mass_properties_of_a_sheet_are_those_of_its_plate():
    square = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    matter = vx.Model.from_mesh(square, open="sheet", sheet_thickness=0.04).mass_properties(12.0)
    np.testing.assert_allclose(matter.center_of_mass, [0.5, 0.5, 0.0], atol=1e-12)
    plate = 1.0 + 0.04**2
    np.testing.assert_allclose(np.diag(matter.inertia), [plate, plate, 2.0], rtol=1e-9)


def test_a_bunny_with_holes_stays_a_solid(bunny_mesh: trimesh.Trimesh):
    size = np.ptp(bunny_mesh.vertices, axis=0).max()
    centers = bunny_mesh.triangles_center
    chosen = centers[np.random.default_rng(1).integers(0, len(centers), 5)]
    near = np.linalg.norm(centers[:, None] - chosen[None], axis=2).min(axis=1) < 0.03 * size
    pierced = trimesh.Trimesh(bunny_mesh.vertices, bunny_mesh.faces[~near])
    with pytest.warns(vx.MeshWarning, match=r"5 openings.*closed it to a solid; pass open='sheet'"):
        model = vx.Model.from_mesh(pierced, resolution=50)
    asked = quietly(pierced, resolution=50, open="solid")
    for one, other in zip(
        vars(model.mass_properties()).values(), vars(asked.mass_properties()).values(), strict=True
    ):
        np.testing.assert_array_equal(one, other)
    whole = vx.Model.from_mesh(bunny_mesh, resolution=50).mass_properties()
    np.testing.assert_allclose(
        model.mass_properties().center_of_mass, whole.center_of_mass, atol=0.01 * size
    )


def test_what_is_asked_for_is_not_warned_of():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        vx.Model.from_mesh(bowl(), resolution=30, open="sheet")
        vx.Model.from_mesh(bowl(), resolution=30, sign="winding")


def test_winding_numbers_that_are_asked_for_make_a_solid():
    model = vx.Model.from_mesh(bowl(), resolution=30, sign="winding")
    assert model.field.sample([[0.0, 0.0, -0.05]]) < 0.0


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"open": "shell"}, "open must be 'auto', 'solid' or 'sheet', not 'shell'"),
        ({"open": "solid", "sheet_thickness": 0.01}, "not for open='solid'"),
        ({"sheet_thickness": -1.0}, "sheet_thickness"),
        ({"open": "sheet", "sheet_thickness": 5.0}, "below the mesh's longest side"),
    ],
)
def test_settings_that_cannot_be_are_refused(options, words):
    with pytest.raises(vx.SettingsError, match=words):
        vx.Model.from_mesh(bowl(), resolution=20, **options)


def test_model_files_keep_what_was_made(tmp_path):
    model = quietly(bowl(), resolution=30)
    model.save(tmp_path / "bowl.vxs")
    again = vx.Model.load(tmp_path / "bowl.vxs")
    np.testing.assert_array_equal(again.mesh.vertices, model.mesh.vertices)
    assert again.accuracy == model.accuracy


def test_a_model_from_the_cache_warns_again(tmp_path, monkeypatch):
    monkeypatch.setenv("VOXSHELL_CACHE_DIR", str(tmp_path))
    monkeypatch.setenv("VOXSHELL_CACHE_SIZE", "1 GB")
    for _ in range(2):
        with pytest.warns(vx.MeshWarning, match="kept it as a sheet"):
            vx.Model.from_mesh(bowl())
