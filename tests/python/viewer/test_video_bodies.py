"""Bodies in videos are drawn with ambient occlusion in the part of the picture that has them, and nowhere else.

Tests that draw are skipped without PyVista, which ``./dev`` does not install; install it with ``pip install pyvista``.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from voxshell.viewer.video_bodies import BodyView

SIZE = (300, 240)
BALL = np.array([[-0.1, -0.1, -0.1], [0.1, 0.1, 0.1]])


def place(x: float, y: float = 0.0, z: float = 0.0) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


@pytest.fixture
def plotter() -> Iterator[Any]:
    """A ball that touches a plate; the camera looks along y."""
    pytest.importorskip("pyvista", reason="needs pyvista")
    pyvista = importlib.import_module("pyvista")
    plotter = pyvista.Plotter(off_screen=True, window_size=SIZE, lighting="none")
    plotter.render_window.SetMultiSamples(0)
    plotter.add_light(pyvista.Light(position=(-1, -1, 2), light_type="scene light"))
    plate = pyvista.Box((-1, 1, -1, 1, -0.2, -0.1))
    plotter.add_mesh(plate, color="white", lighting=False, render=False)
    ball = pyvista.Sphere(radius=0.1)
    plotter._ball = plotter.add_mesh(ball, color="red", render=False, ambient=0.5)
    plotter.camera_position = [(0, -2, 0.6), (0, 0, 0), (0, 0, 1)]
    plotter.renderer.ResetCameraClippingRange()
    yield plotter
    plotter.close()


def draw(plotter: Any) -> np.ndarray:
    plotter.render()
    return np.array(plotter.screenshot(return_img=True)).astype(int)


def test_the_part_has_the_bodies_and_no_more(plotter: Any):
    view = BodyView(plotter, [plotter._ball], size=SIZE, body_size=0.2)
    assert view._find_part([]) is None
    assert view._find_part([(BALL, place(50.0))]) is None, "beside the picture"
    part = view._find_part([(BALL, place(0.0))])
    assert part is not None
    low, high = part
    assert (low % 12 == 0).all()
    middle = np.array(SIZE) / 2
    assert (low < middle).all()
    assert (high > middle).all()
    assert (high - low).prod() < 0.25 * np.prod(SIZE)
    both = view._find_part([(BALL, place(0.0)), (BALL, place(0.3))])
    assert both is not None
    assert both[0] == pytest.approx(low)
    assert both[1][0] > high[0] + 30
    behind = view._find_part([(BALL, place(0.0, -3.0))])
    assert behind is not None
    assert (behind[0].tolist(), behind[1].tolist()) == ([0, 0], list(SIZE))


def test_a_part_is_drawn_as_if_it_were_the_whole_picture(plotter: Any, monkeypatch):
    view = BodyView(plotter, [plotter._ball], size=SIZE, body_size=0.2)
    view.look_at([])
    bare = draw(plotter)
    assert not (bare[..., 0] > bare[..., 1] + 60).any(), "no body"
    view.look_at([(BALL, place(0.0))])
    part = draw(plotter)
    whole = np.zeros(2, np.int64), np.array(SIZE)
    monkeypatch.setattr(view, "_find_part", lambda _: whole)
    view.look_at([(BALL, place(0.0))])
    full = draw(plotter)
    red = full[..., 0] > full[..., 1] + 60
    assert 500 < red.sum() < 5000
    assert np.abs(part - full).mean() < 0.1
    assert (np.abs(part - full).max(axis=-1) > 40).sum() < 5, "it lies where it belongs"


def test_bodies_are_darker_where_they_are_near_others(plotter: Any):
    view = BodyView(plotter, [plotter._ball], size=SIZE, body_size=0.6)
    view.look_at([(BALL, place(0.0))])
    occluded = draw(plotter)
    view._renderer.SetPass(None)
    darker = draw(plotter)[..., 0] - occluded[..., 0]
    ball = occluded[..., 0] > occluded[..., 1] + 60
    rows = np.flatnonzero(ball.any(axis=1))
    middle = rows.mean()
    lower = ball & (np.arange(SIZE[1])[:, None] > middle)
    assert darker[lower].mean() > 4
    assert darker[lower].mean() > 2 * darker[ball & ~lower].mean()
