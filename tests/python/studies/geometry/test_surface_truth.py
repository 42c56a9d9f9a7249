"""The nearest faces of a mesh and their normals, against trimesh and closed forms."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from voxshell.model.meshes import Mesh
from voxshell_studies.geometry.surface_truth import Surface, measure_angle
from voxshell_studies.scenes.geometry_bodies import make_body


def test_nearest_places_are_those_of_trimesh():
    mesh = make_body("dented box")
    surface = Surface(mesh)
    places = np.random.default_rng(2).uniform(-0.06, 0.06, (50, 3))
    solid = trimesh.Trimesh(*mesh, process=False)
    _, distances, _ = trimesh.proximity.closest_point(solid, places)
    assert surface.measure_distances(places) == pytest.approx(distances, abs=1e-12)


def test_normals_of_a_cube_are_its_faces_edges_and_corners():
    surface = Surface(make_body("cube 50 mm"))
    up, side = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])

    def find_angle(place, normal):
        [(_, cones)] = surface.find_nearest(np.array([place]))
        return np.degrees(
            min(measure_angle(normal / np.linalg.norm(normal), each) for each in cones)
        )

    assert find_angle((0.001, 0.002, 0.02), up) == pytest.approx(0.0)
    assert find_angle((0.001, 0.002, 0.02), side) == pytest.approx(90.0)
    # Outside an edge all between both faces' normals are right; inside, in its plane of symmetry, these two.
    assert find_angle((0.026, 0.0, 0.026), up + 0.3 * side) == pytest.approx(0.0, abs=1e-6)
    assert find_angle((0.02, 0.0, 0.02), side) == pytest.approx(0.0, abs=1e-6)
    assert find_angle((0.02, 0.0, 0.02), up + side) == pytest.approx(45.0)
    entry = surface.find_entry(np.array([0.001, 0.002, 0.0]), up)
    assert entry is not None
    assert entry == pytest.approx(up)
    assert surface.find_entry(np.array([0.2, 0.0, 0.0]), up) is None


def test_many_places_at_once_are_each_on_its_own():
    surface = Surface(make_body("bunny 0.2 m"))
    places = np.random.default_rng(3).uniform(-0.1, 0.1, (20, 3))
    alone = [surface.measure_distances(place[None])[0] for place in places]
    assert surface.measure_distances(places).tolist() == alone
    assert [distance for distance, _ in surface.find_nearest(places)] == alone
    assert surface.find_nearest(places[:0]) == []


def test_a_mesh_of_no_area_is_left_out_of_the_surface():
    mesh = make_body("cube 50 mm")
    faces = np.concatenate([mesh.faces, [[0, 0, 1]]]).astype(np.uint32)
    assert len(Surface(Mesh(mesh.vertices, faces)).normals) == 12
