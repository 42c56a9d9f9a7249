"""Scenes of loads and of bodies that are nearly at rest."""

from __future__ import annotations

import pytest
from voxshell_studies.scenes.limits import SCENES, loads


def test_a_feeder_begins_at_rest_and_feeds_forward():
    assert loads.feeder_place(0.0) == 0.0
    assert abs(loads.feeder_place(0.3)) < 3e-5
    assert loads.true_feed(0.2, 0.5) != pytest.approx(0.0, abs=1.0)
    # What sticks moves with the feeder, which ends where it began.
    assert loads.true_feed(1e3, 0.5) == pytest.approx(0.0, abs=0.5)


def test_a_thick_box_tips_at_its_point_of_balance():
    assert SCENES["box of 1:4 on a slab that tilts slowly"].run(200.0, 0) == pytest.approx(
        0.0, abs=0.3
    )


def test_a_ball_carries_a_load_in_short_steps():
    depth = SCENES["depth of a model ball of 0.3 kg pressed with 3 kN"].run(200.0, 0)
    assert depth == pytest.approx(0.0, abs=0.01)
    share = SCENES["force through a vx.Sphere of 0.3 kg pressed with 3 kN"].run(200.0, 0)
    assert share == pytest.approx(1.0, abs=0.01)


def test_joints_hold_by_default_better_than_with_few_iterations():
    few, default = (
        SCENES[f"capsule of 30 g pinned to the world, with a ball of 8 kg, {name} iterations"]
        for name in ("10", "default")
    )
    assert default.run(200.0, 0) < 1.0 < few.run(200.0, 0)


def test_light_links_hold_in_short_steps():
    assert SCENES["two links of 12 and 19 g swing 35 kg"].run(1000.0, 0) < 10.0


def test_a_plate_of_100_kg_stands_on_light_cubes():
    assert SCENES["plate of 100 kg on four cubes of 1 g"].run(60.0, 0) < 1.0
