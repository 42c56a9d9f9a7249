"""Scenes of mechanisms, at a rate at which they are known to work."""

from __future__ import annotations

import pytest
from voxshell_studies.scenes.limits import SCENES, mechanisms


def test_what_play_allows_is_small():
    assert mechanisms.true_backlash() == pytest.approx(0.477, abs=0.001)
    assert mechanisms.true_coupling_lag() == pytest.approx(1.432, abs=0.001)


@pytest.mark.parametrize(
    ("name", "error"),
    [
        ("Scotch yoke with 0.3 mm of play, turned once a second", 0.01),
        ("Geneva drive with 0.3 mm of play, driven by half a turn a second", 0.02),
        ("brick is pulled off the studs of another", 0.05),
        ("keyhole plate is pulled against the head of its screw", 0.1),
        ("gears of 12 and 24 teeth, turned by a constant torque", 0.1),
        ("gears of 12 and 24 teeth, started at a turn a second", 1.0),
    ],
)
def test_mechanisms_work_at_200_hz(name, error):
    scene = SCENES[name]
    assert scene.run(200.0, 0) == pytest.approx(scene.truth, abs=error)


def test_contacts_of_turned_bodies_come_after_those_that_stop_them():
    """It was 0.07 mm deep, and 0.28 mm with contacts of where its first solution turned it."""
    scene = SCENES["keyhole plate is pulled against the head of its screw"]
    assert max(scene.run(60.0, placement) for placement in range(2)) < 0.05
