from __future__ import annotations

import numpy as np
import trimesh
from voxshell.model.meshes import Mesh
from voxshell_studies.report.paint import Camera, Canvas, Solid, thin_out

CUBE = trimesh.creation.box((0.2, 0.2, 0.2))
SIDE = Camera((0.0, 0.0, 0.0), 1.0, (100, 80), azimuth=0.0, elevation=0.0)


def paint(*solids):
    canvas = Canvas(SIDE)
    canvas.paint(solids)
    return np.asarray(canvas.finish(), dtype=int)


def solid(place, color):
    pose = np.eye(4)
    pose[:3, 3] = place
    return Solid(Mesh(CUBE.vertices, CUBE.faces), pose, color)


def test_a_body_is_where_the_camera_sees_it():
    pixels = paint(solid((0.2, 0.0, 0.1), (200, 0, 0)))
    rows, columns = np.nonzero(np.ptp(pixels, axis=2) > 50)
    # A meter is 100 pixels; up is z, right is x.
    np.testing.assert_allclose([columns.min(), columns.max()], [60, 79], atol=1.5)
    np.testing.assert_allclose([rows.min(), rows.max()], [20, 39], atol=1.5)


def test_the_nearer_body_hides_the_other():
    near, far = solid((0.0, -0.5, 0.0), (200, 0, 0)), solid((0.0, 0.5, 0.0), (0, 0, 200))
    for order in ((near, far), (far, near)):
        red, _, blue = paint(*order)[40, 50]
        assert red > 50 > blue


def test_thinned_mesh_keeps_its_place():
    ball = trimesh.creation.icosphere(4, radius=0.1)
    thin = thin_out(Mesh(ball.vertices, ball.faces), 0.03)
    assert 20 < len(thin.faces) < len(ball.faces) / 10
    assert np.abs(np.linalg.norm(thin.vertices, axis=1) - 0.1).max() < 0.01
