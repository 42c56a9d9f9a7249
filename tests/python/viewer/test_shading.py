from __future__ import annotations

import numpy as np
import trimesh
from voxshell.viewer.shading import find_vertex_normals, split_creases


def test_edges_get_vertices_on_both_sides_and_round_sides_none():
    tube = trimesh.creation.cylinder(1.0, 2.0, sections=64)
    vertices, faces = split_creases(tube.vertices, tube.faces)
    # A ring for each cap and for each end of the side, and the middles of the caps.
    assert len(vertices) == 4 * 64 + 2
    ball = trimesh.creation.icosphere(3)
    assert len(split_creases(ball.vertices, ball.faces)[0]) == len(ball.vertices)
    np.testing.assert_array_equal(vertices[faces], tube.vertices[tube.faces])


def test_smooth_normals_of_a_split_box_are_those_of_its_faces():
    box = trimesh.creation.box()
    vertices, faces = split_creases(box.vertices, box.faces)
    split = trimesh.Trimesh(vertices, faces, process=False)
    np.testing.assert_allclose(np.abs(split.vertex_normals).max(axis=1), 1.0)


def test_edges_of_three_faces_and_open_ones_are_kept():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1.0]])
    faces = np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]])
    points, corners = split_creases(vertices, faces)
    np.testing.assert_array_equal(points[corners], vertices[faces])


def test_normals_of_vertices_are_those_of_trimesh():
    ring = trimesh.creation.torus(3.0, 1.0)
    normals = find_vertex_normals(ring.vertices, ring.faces)
    np.testing.assert_allclose(normals, ring.vertex_normals, atol=1e-9)


def test_vertices_without_area_have_unit_normals():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [5, 5, 5.0]])
    normals = find_vertex_normals(vertices, np.array([[0, 1, 2]]))
    np.testing.assert_array_equal(normals, np.tile([0.0, 0.0, 1.0], (4, 1)))
