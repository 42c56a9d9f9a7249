"""Where the bodies of an inspector begin, and what its camera sees of them."""

from __future__ import annotations

import math

import numpy as np
import pytest
import voxshell as vx
from voxshell.viewer.inspector_stage import find_view, place_partner

BOUNDS = np.array([[-0.1, -0.1, 0.0], [0.2, 0.1, 0.1]])


def test_a_body_without_a_pose_begins_beside_the_model():
    partner = place_partner(vx.Sphere(0.05), BOUNDS, None)
    assert partner.pose[:3, 3] == pytest.approx([0.25, 0.0, 0.0])
    assert partner.grip == pytest.approx([0.0, 0.0, 0.0], abs=1e-3)
    assert partner.low == pytest.approx([-0.1, -0.1, -0.05], abs=1e-3)
    assert partner.high == pytest.approx([0.3, 0.1, 0.1], abs=1e-3)


def test_a_plane_is_a_plate_whose_handle_is_in_view():
    partner = place_partner(vx.Plane(offset=-0.02), BOUNDS, None)
    assert np.array_equal(partner.pose, np.eye(4))
    diagonal = float(np.linalg.norm(BOUNDS[1] - BOUNDS[0]))
    assert np.ptp(partner.mesh.vertices, axis=0).max() == pytest.approx(1.5 * diagonal)
    assert (partner.low <= np.minimum(BOUNDS[0], partner.grip)).all()
    assert (partner.high >= np.maximum(BOUNDS[1], partner.grip)).all()


@pytest.mark.parametrize("window", [(760, 420), (1024, 768), (1920, 1080)])
def test_the_first_view_shows_all_beside_the_controls(window: tuple[int, int]):
    low, high = np.array([-1.0, -0.5, 0.0]), np.array([1.5, 0.5, 1.0])
    camera = find_view(low, high, has_controls=True)
    away = (camera.target - camera.position) / np.linalg.norm(camera.target - camera.position)
    right = np.cross(away, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    above = np.cross(right, away)
    corners = np.array(np.meshgrid(*np.stack([low, high], axis=1))).reshape(3, -1).T
    seen = corners - camera.position
    width, height = window
    focal = 0.5 * height / math.tan(0.5 * camera.field_of_view)  # pixels
    x = 0.5 * width + focal * (seen @ right) / (seen @ away)
    y = 0.5 * height - focal * (seen @ above) / (seen @ away)
    assert 0.0 < x.min() < x.max() < width - 330.0
    assert 0.0 < y.min() < y.max() < height
