"""The ground of videos: where shadows fall, and how the ground ends.

Tests that draw are skipped without PyVista, which ``./dev`` does not install; install it with ``pip install pyvista``.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import trimesh
from voxshell.viewer import video_ground
from voxshell.viewer.video_ground import BACKGROUND, Ground, sample_surface


@pytest.fixture
def plotter() -> Iterator[Any]:
    pytest.importorskip("pyvista", reason="needs pyvista")
    plotter = importlib.import_module("pyvista").Plotter(off_screen=True, window_size=(64, 64))
    yield plotter
    plotter.close()


def colors_of(ground: Ground) -> np.ndarray:
    picture = ground._picture.to_image()
    width, height, _ = picture.dimensions
    return np.array(picture.point_data.active_scalars).reshape(height, width, 3).astype(float)


@pytest.mark.parametrize("up", ["+z", "+y"])
def test_a_shadow_lies_where_the_sun_sends_it_and_farther_from_a_higher_body(plotter: Any, up: str):
    corner = np.full(3, 0.5)
    ground = Ground(
        importlib.import_module("pyvista"),
        plotter,
        up=up,
        place=np.zeros(3),
        low=-corner,
        high=corner,
        cell=0.1,
        color=(200, 200, 200),
    )
    ball = trimesh.creation.icosphere(2, 0.1)
    points = sample_surface(ball.vertices, np.asarray(ball.faces, np.int64))
    ground.cast([])
    bare = colors_of(ground)
    assert bare[0, 0] == pytest.approx(BACKGROUND), "the ground ends in the background"
    assert bare[240, 240] == pytest.approx((200, 200, 200))
    middles = []
    for height in (0.1, 0.6):
        pose = np.eye(4)
        pose["xyz".index(up[1]), 3] = height
        ground.cast([(points, pose)])
        darker = (bare - colors_of(ground))[..., 0] > 20
        rows, columns = np.nonzero(darker)
        # The side of 480 texels is 5 m; the sun moves shadows by 0.42 and 0.30 of a height.
        middles.append(np.array([columns.mean(), rows.mean()]) * 5.0 / 479 - 2.5)
        assert middles[-1] == pytest.approx((0.42 * height, 0.30 * height), abs=0.02)
        area = darker.sum() * (5.0 / 479) ** 2
        assert 1.0 < area / (np.pi * 0.1**2) < 2.5, "soft, and longer than wide"
    assert np.linalg.norm(middles[1]) > np.linalg.norm(middles[0]) + 0.2


def test_points_of_a_surface_lie_on_it_and_evenly():
    box = trimesh.creation.box((1.0, 1.0, 4.0))
    points = sample_surface(np.asarray(box.vertices), np.asarray(box.faces, np.int64))
    assert np.abs(np.abs(points) / (0.5, 0.5, 2.0)).max(axis=1) == pytest.approx(1.0)
    assert (np.abs(points[:, 2]) == 2.0).mean() == pytest.approx(2.0 / 18.0, abs=0.01)


@pytest.mark.parametrize("places", [[(0.0, 0.0, 0.1)], [(-0.5, 0.4, 0.1), (2.2, 2.3, 0.3)], []])
def test_shadows_are_the_same_as_if_the_whole_ground_were_blurred(
    plotter: Any, monkeypatch, places: list[tuple[float, float, float]]
):
    ground = Ground(
        importlib.import_module("pyvista"),
        plotter,
        up="+z",
        place=np.zeros(3),
        low=np.full(3, -0.5),
        high=np.full(3, 0.5),
        cell=0.1,
        color=(200, 200, 200),
    )
    ball = trimesh.creation.icosphere(2, 0.1)
    points = sample_surface(ball.vertices, np.asarray(ball.faces, np.int64))
    shown = []
    for place in places:
        pose = np.eye(4)
        pose[:3, 3] = place
        shown.append((points, pose))
    sizes = []
    blur = video_ground._blur
    monkeypatch.setattr(
        video_ground, "_blur", lambda picture: sizes.append(picture.size) or blur(picture)
    )
    ground.cast(shown)
    part = colors_of(ground)
    assert all(size < 0.5 * 480 * 480 for size in sizes)
    monkeypatch.setattr(video_ground, "_find_part", lambda _: (slice(0, 480), slice(0, 480)))
    ground.cast(shown)
    assert np.abs(colors_of(ground) - part).max() <= 1, "sums of other parts round otherwise"
