"""Scenes of blows: their truths, and what they count."""

from __future__ import annotations

import math

import pytest
from voxshell_studies.scenes.limits import SCENES, blows


def test_a_slender_block_keeps_most_of_its_swing(monkeypatch):
    monkeypatch.setattr(blows, "_BLOCK", (0.001, 1.0))
    monkeypatch.setattr(blows, "_FIRST_SWING", 0.0005)
    assert blows.true_swing() == pytest.approx(math.degrees(0.0005), rel=1e-4)


def test_a_block_rocks_to_the_other_edge_in_short_steps():
    scene = SCENES["block of 12 by 30 cm rocks from edge to edge"]
    assert scene.run(1000.0, 0) == pytest.approx(scene.truth, rel=0.1)


@pytest.mark.parametrize(
    "name",
    [
        "balls of 40 mm at 5 m/s between walls 62 mm apart, restitution 0.8",
        "models of 1 by 1 by 40 cm at 50 m/s and 60 rad/s meet a slab of 5 cm",
        "Bullet's round shapes at 15 m/s in a pipe of 0.4 m with walls of 5 cm",
    ],
)
def test_nothing_leaves_in_short_steps(name):
    assert SCENES[name].run(1000.0, 0) == 0.0


def test_elastic_balls_keep_their_energy_in_short_steps():
    assert SCENES["break of ten elastic balls"].run(1000.0, 0) == pytest.approx(1.0, abs=0.02)


def test_cubes_do_not_gain_energy_in_short_steps():
    name = "five cubes of 10 cm fall with gaps, restitution 0.95"
    assert SCENES[name].run(1000.0, 0) < 0.1


def test_a_motor_does_not_push_a_slider_into_a_wall_in_short_steps():
    name = "motor of a slider reverses from -4 to 4 m/s beside a wall of 2 cm"
    assert SCENES[name].run(1000.0, 1) < 1.0


def test_two_balls_fall_one_above_the_other():
    assert SCENES["small ball falls with a large one, restitution 1"].run(1000.0, 0) < 1.0
