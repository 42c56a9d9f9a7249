"""Scenes of shafts and balls in bores."""

from __future__ import annotations

import math

import pytest
from voxshell_studies.scenes.limits import SCENES


@pytest.mark.parametrize(
    "name",
    [
        "model shaft of 36 mm spins in a bearing of 40 mm",
        "Bullet's cylinder of 36 mm spins in a bearing of 40 mm",
        "Bullet's cylinder of 40 mm swings in a bearing of 60 mm",
    ],
)
def test_shafts_turn_in_short_steps(name):
    assert SCENES[name].run(200.0, 0) == pytest.approx(1.0, rel=0.05)


def test_placements_of_a_tube_differ():
    scene = SCENES["model ball falls in a tube of 50 mm with 0.5 mm of clearance"]
    values = [scene.run(60.0, placement) for placement in range(2)]
    assert values[0] != values[1]
    assert all(math.isfinite(value) for value in values)


def test_spheres_stay_in_a_thin_tube_in_short_steps():
    scene = SCENES["spheres of 10 mm thrown in tubes with walls of 1.5 mm"]
    assert scene.run(200.0, 0) == 0.0
