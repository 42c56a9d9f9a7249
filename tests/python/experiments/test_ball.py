from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from voxshell.experiments import ball
from voxshell.experiments.part import compute_part
from voxshell.experiments.report.ball import BALL
from voxshell.scenes.ball import BallSettings

SETTINGS = replace(BallSettings(), phases=4, steps=200)


@pytest.fixture(scope="module")
def results():
    return {part.name: compute_part(part).tables for part in ball.plan(SETTINGS)}


def test_verdicts_are_those_of_the_section(results):
    rows = {row.quantity: row for row in BALL.reduce(SETTINGS, results)}
    deepest = rows["maximum penetration, c 0.5, VPS, 25,880 points, published rule"]
    assert deepest.published == 4.0
    assert deepest.here == pytest.approx(4.0, abs=0.1)
    assert deepest.reproduced
    assert rows["contacts in a step with contact, VPS, 25,880 points"].here == 1
    for ground in ("block of voxels", "analytic plane"):
        who = f"VPS, 25,880 points, {ground}, 4 start heights"
        assert rows[f"rebound off c2 at most, {who}"].holds
        assert rows[f"energy gained at most, c < 1, {who}"].holds
        assert rows[f"deepest the ball is in the ground, {who}"].holds
    # Bullet 3.24 does not show what was published of its sphere, and the report says so.
    assert rows["maximum penetration, c 0.1, Bullet's sphere, published rule"].reproduced is False


def test_a_ball_that_sinks_or_gains_fails_its_bars(results):
    worse = dict(results)
    runs = {
        name: values.copy()
        for name, values in results["phases-voxshell-high-plane"]["runs"].items()
    }
    runs["depth"] = runs["depth"] + 0.05
    runs["energy"] = runs["energy"] + 0.01
    runs["rebound"] = runs["rebound"] * 1.05
    worse["phases-voxshell-high-plane"] = {"runs": runs}
    failed = [row.quantity for row in BALL.reduce(SETTINGS, worse) if row.holds is False]
    assert len(failed) == 3
    assert all("analytic plane" in quantity for quantity in failed)


def test_energy_is_kept_in_free_flight(results):
    steps = results["fall-published-bullet"]["steps"]
    mine = steps["restitution"] == 0.9
    fall = {name: values[mine] for name, values in steps.items()}
    energy = ball.compute_energy(SETTINGS, fall)
    np.testing.assert_allclose(energy[:60], 1.0, rtol=1e-9)
    apex = ball.find_apex(fall)
    assert fall["height"][apex] == fall["height"][64:120].max()


def test_pictures_and_replay_are_drawn(results, tmp_path):
    pictures = BALL.draw(SETTINGS, results, tmp_path)
    assert sorted(picture.path for picture in pictures) == sorted(
        path.name for path in tmp_path.iterdir()
    )
    assert len(pictures) == 5
