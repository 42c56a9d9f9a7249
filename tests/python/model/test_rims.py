from __future__ import annotations

import numpy as np
import pytest
import trimesh
from voxshell.model.rims import measure_widest_rim


def open_cylinder(radius: float, sections: int) -> trimesh.Trimesh:
    mesh = trimesh.creation.cylinder(radius=radius, height=0.3, sections=sections)
    mesh.update_faces(np.abs(mesh.face_normals[:, 2]) < 0.5)
    return mesh


def test_a_round_rim_is_as_wide_as_its_diameter():
    mesh = open_cylinder(0.05, 64)
    assert measure_widest_rim(mesh.vertices, mesh.faces) == pytest.approx(0.1, rel=1e-12)


def test_the_wider_of_two_rims_counts_and_not_their_distance():
    parts = [
        open_cylinder(radius, 32).apply_translation((x, 0, 0))
        for radius, x in ((0.05, 0), (0.2, 5))
    ]
    mesh = trimesh.util.concatenate(parts)
    assert measure_widest_rim(mesh.vertices, mesh.faces) == pytest.approx(0.4, rel=1e-12)


def test_a_rim_without_shared_vertices_is_one_rim():
    mesh = open_cylinder(0.05, 64)
    corners = mesh.triangles.reshape(-1, 3)
    faces = np.arange(len(corners)).reshape(-1, 3)
    assert measure_widest_rim(corners, faces) == pytest.approx(0.1, rel=1e-12)


def test_a_rectangular_rim_is_as_wide_as_its_diagonal():
    mesh = trimesh.creation.box((3.0, 4.0, 1.0))
    mesh.update_faces(mesh.face_normals[:, 2] < 0.5)
    assert measure_widest_rim(mesh.vertices, mesh.faces) == pytest.approx(5.0, rel=1e-12)


def test_a_closed_mesh_has_no_rim():
    mesh = trimesh.creation.icosphere()
    assert measure_widest_rim(mesh.vertices, mesh.faces) == 0.0


def test_a_ragged_rim_has_the_largest_distance_of_its_points():
    for seed in range(20):
        rng = np.random.default_rng(seed)
        angles = np.linspace(0, 2 * np.pi, 30, endpoint=False)
        rim = np.c_[np.cos(angles), np.sin(angles), np.zeros(30)] * rng.uniform(0.5, 1.5, (30, 1))
        vertices = np.vstack([rim, [[0.0, 0.0, 1.0]]])
        faces = np.array([(i, (i + 1) % 30, 30) for i in range(30)])
        largest = np.linalg.norm(rim[:, None] - rim[None], axis=2).max()
        found = measure_widest_rim(vertices, faces)
        assert found == pytest.approx(largest, rel=1e-12)


def test_a_rim_of_many_points_is_measured_as_well():
    mesh = open_cylinder(0.05, 5000)
    assert measure_widest_rim(mesh.vertices, mesh.faces) == pytest.approx(0.1, rel=1e-5)
