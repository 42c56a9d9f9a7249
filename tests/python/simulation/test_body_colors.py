"""Colors of bodies: what is refused, by the view and by the recorder alike."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import voxshell as vx
from voxshell.simulation.body_colors import as_body_colors


@pytest.fixture
def ball() -> vx.Body:
    return vx.World().add(vx.Sphere(0.1), name="ball")


def test_integers_of_any_kind_are_taken(ball: vx.Body):
    assert as_body_colors(None) == {}
    assert as_body_colors({ball: np.array([1, 2, 3], np.uint8)}) == {ball: (1, 2, 3)}


@pytest.mark.parametrize("color", ["red", (1.0, 0.5, 0.0), (300, 0, 0), (-1, 0, 0), (1, 2), 7])
def test_what_is_no_color_is_refused(ball: vx.Body, color: Any):
    with pytest.raises(vx.SettingsError, match=r"color of 'ball' must be three integers"):
        as_body_colors({ball: color})


@pytest.mark.parametrize(
    ("colors", "message"), [([1], "must be a mapping"), ({"ball": (1, 2, 3)}, "bodies as keys")]
)
def test_what_is_no_mapping_from_bodies_is_refused(colors: Any, message: str):
    with pytest.raises(vx.InputTypeError, match=message):
        as_body_colors(colors)


def test_a_recorder_refuses_what_it_would_ignore():
    world = vx.World()
    world.add(vx.Sphere(0.1))
    with pytest.raises(vx.InputTypeError, match="bodies as keys"):
        world.record().recording(colors={"ball": (1, 2, 3)})  # pyright: ignore[reportArgumentType]
