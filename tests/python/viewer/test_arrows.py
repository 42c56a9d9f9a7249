from __future__ import annotations

import numpy as np
import pytest
from trimesh.transformations import quaternion_matrix
from voxshell.recording import BodyTrack, ContactTrack, Recording
from voxshell.viewer.arrows import find_arrows, full_force, make_arrow, mesh_arrows, place_arrows


def pressed(*newtons: float) -> Recording:
    """A frame with contacts that press upward."""
    flag = BodyTrack("flag", np.eye(3), [[0, 1, 2]], None, np.eye(4)[None])
    count = len(newtons)
    up = np.tile([0.0, 0.0, 1.0], (count, 1))
    forces = np.array(newtons)[:, None] * up
    contacts = ContactTrack.from_frames([(np.zeros((count, 3)), up, np.zeros(count), forces)])
    return Recording(0.1, (flag,), contacts)


def test_the_longest_arrow_is_about_the_largest_force_in_round_numbers():
    assert full_force([pressed()]) == 0.0
    assert full_force([pressed(0.0, 0.0)]) == 0.0
    assert full_force([pressed(2.0, 2.0)]) == pytest.approx(2.0)
    assert full_force([pressed(0.3), pressed(4.1, 4.1)]) == pytest.approx(5.0)
    blow = pressed(1000.0, *[0.9] * 200)
    assert full_force([blow]) == pytest.approx(1.0), "one blow does not shorten all others"


def test_arrows_are_as_long_as_forces_up_to_the_longest():
    points = np.arange(12.0).reshape(4, 3)
    forces = np.array([[0.0, 0.0, 1.0], [0.0, 4.0, 0.0], [-2.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    arrows = find_arrows(points, forces, strongest=2.0, longest=0.5, limit=10)
    np.testing.assert_array_equal(arrows[:, 0], points[:3])
    spans = arrows[:, 1] - arrows[:, 0]
    np.testing.assert_allclose(spans, [[0, 0, 0.25], [0, 0.5, 0], [-0.5, 0, 0]])
    few = find_arrows(points, forces, strongest=2.0, longest=0.5, limit=1)
    np.testing.assert_array_equal(few[:, 0], points[1:2])
    assert find_arrows(points, 0.0 * forces, strongest=0.0, longest=1.0, limit=9).shape == (0, 2, 3)


def test_short_arrows_are_small_with_their_heads_and_reach_from_start_to_tip():
    starts = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    ways = np.array([[0.0, 0.0, 0.5], [0.0, 0.004, 0.0], [0.0, 0.0, -0.1]])
    arrows = np.stack([starts, starts + ways], axis=1)
    positions, turns, scales = place_arrows(arrows, body_size=1.0)
    vertices, _ = make_arrow()
    for arrow, way, position, turn, scale in zip(
        arrows, ways, positions, turns, scales, strict=True
    ):
        rotation = quaternion_matrix(turn)[:3, :3]
        placed = (vertices * scale) @ rotation.T + position
        length = np.linalg.norm(way)
        along = (placed - arrow[0]) @ way / length
        assert along.min() == pytest.approx(0.0, abs=1e-9)
        assert along.max() == pytest.approx(length)
        across = np.linalg.norm(placed - arrow[0] - along[:, None] * way / length, axis=1)
        assert across.max() < 0.2 * length
    assert scales[0, 0] > scales[2, 0] > scales[1, 0]


def test_one_surface_holds_all_arrows():
    arrows = np.array([[[0.0, 0.0, 0.0], [0.3, 0.4, 0.0]], [[1.0, 0.0, 0.0], [1.0, 0.0, -1.0]]])
    vertices, faces = mesh_arrows(arrows, body_size=1.0)
    count = len(make_arrow()[0])
    assert vertices.shape == (2 * count, 3)
    assert faces.max() == 2 * count - 1
    for number, (start, tip) in enumerate(arrows):
        part = vertices[number * count : (number + 1) * count]
        assert np.linalg.norm(part - start, axis=1).min() < 1e-9
        assert np.linalg.norm(part - tip, axis=1).min() < 1e-9
