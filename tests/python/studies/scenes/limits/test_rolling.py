"""Scenes of bodies that roll: their truths, and runs at rates at which they are known to hold."""

from __future__ import annotations

import pytest
from voxshell_studies.scenes.limits import SCENES, rolling


def test_a_disc_on_flat_ground_would_keep_its_speed(monkeypatch):
    monkeypatch.setattr(rolling, "_WAVE", 0.0)
    way, x, z = rolling.way_over_waves(0.05, 1.0, 1.5)
    assert (way, x, z) == pytest.approx((1.5, 0.0, 0.05))


def test_the_foot_of_a_ramp_and_a_step_cost_speed():
    assert 0.9 < rolling.true_speed_over_a_step() < 1.0
    assert 0.065 < rolling.true_rise() < 1.4 / (2.0 * 9.81)


@pytest.mark.parametrize(
    ("name", "rate"),
    [
        ("Bullet's cylinder of 50 mm in radius rolls over waves of 2 cm", 200.0),
        ("ball of 60 mm swings in a trough of 60 mm in radius", 200.0),
        ("ball of 100 mm rolls up a ramp of 10 degrees at 1 m/s", 1000.0),
        ("ellipsoid of 20 by 30 mm rolls on a plane", 200.0),
    ],
)
def test_scenes_are_near_their_truths_in_short_steps(name, rate):
    scene = SCENES[name]
    assert scene.run(rate, 0) == pytest.approx(scene.truth, rel=0.05)


# It was 0.924 and 0.957: facets of the wheel came to lie in the waves, which braked it.
@pytest.mark.parametrize("rate", [1000.0, 200.0])
def test_a_small_wheel_of_facets_rolls_over_waves(rate):
    scene = SCENES["model wheel of 5 mm in radius rolls over waves of 2 cm"]
    assert scene.run(rate, 0) == pytest.approx(scene.truth, rel=0.01)
