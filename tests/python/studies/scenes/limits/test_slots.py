"""Scenes of bodies in slots."""

from __future__ import annotations

import numpy as np
import pytest
import voxshell as vx
from voxshell_studies.everyday.worlds import build_model
from voxshell_studies.scenes.limits import SCENES, bodies, slots


@pytest.mark.parametrize("play", [0.0003, 0.002])
def test_a_carriage_fits_its_rail_with_its_play(play):
    rail = build_model(bodies.profile("dovetail rail", slots._RAIL, 1.0))
    carriage = build_model(slots.carriage(play))
    for aside, touches in ((0.0, False), (0.4, False), (0.6, True)):
        at = vx.pose((0.0, aside * play, 1e-5))
        assert vx.collide(rail, carriage, None, at) is touches


def test_a_plate_has_a_hole_of_the_given_size():
    plate = slots.plate_with_hole(0.03, 0.02, 0.01)
    inside = np.abs(plate.vertices[:, :2]) <= (0.015 + 1e-9, 0.01 + 1e-9)
    assert int(inside.all(axis=1).sum()) == 8


def test_a_bar_falls_no_faster_than_freely():
    scene = SCENES["square bar of 20 mm falls tilted through a hole with 2 mm of play"]
    assert 0.2 < scene.run(200.0, 1) < 1.01
