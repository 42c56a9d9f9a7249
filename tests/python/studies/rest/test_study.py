from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from experiments import compute, draw
from voxshell_studies.report.rest import REST, count_below, find_stills
from voxshell_studies.rest import study


@pytest.fixture(scope="module")
def rests():
    settings = replace(
        study.RestSettings(),
        orientations=2,
        others=2,
        settle_seconds=1.0,
        drift_seconds=1.0,
        roll_rates=(200.0, 500.0),
        fine_points=2_000,
        voxel_size=0.004,
    )
    return settings, compute(REST, settings)


def test_rest_has_every_ground_shell_and_mode(rests, tmp_path):
    settings, results = rests
    rows = REST.reduce(settings, results)
    assert len([row for row in rows if row.holds is not None]) == 72
    assert len([row for row in rows if "rad/s after 1 s, " in row.quantity]) == 10
    for name, tables in results.items():
        if name.startswith("roll-"):
            continue
        assert tables["runs"]["depth"].max() < 0.006, name
        assert (tables["runs"]["end_angular_speed"] < 20.0).all()
    draw(REST, settings, results, tmp_path)


@pytest.mark.parametrize("held", [False, True])
def test_rest_bars_follow_the_data(rests, held):
    settings, results = rests
    name = study.name_rest("plane", "fine", "regular", held=held)
    who = "fine, regular, analytic plane" + (", 8 mm of rolling friction" if held else "")
    for value, holds in ((1e-5, True), (1e-2, False)):
        runs = results[name]["runs"] | {
            "angular_speed": np.full(2, value),
            "drift": np.full(2, value),
            "asleep": np.full(2, float(holds)),
        }
        rows = REST.reduce(settings, {**results, name: {"runs": runs}})
        mine = [row for row in rows if row.quantity.endswith(who)]
        assert [row.holds for row in mine] == [holds] * 3


def test_other_orientations_are_others_and_are_counted(rests):
    settings, results = rests
    name = study.name_rest("plane", "coarse", "auto", held=True, others=True)
    runs = results[name]["runs"]
    np.testing.assert_array_equal(runs["orientation"], [20, 21])
    calm = {
        other: {"runs": tables["runs"] | {"angular_speed": np.zeros(2), "drift": np.zeros(2), "asleep": np.ones(2)}}
        for other, tables in results.items()
        if other.endswith("-others")
    }  # fmt: skip
    assert len(calm) == 12
    quantity = (
        "rest in 2 other orientations, coarse, all modes, analytic plane, 8 mm of rolling friction"
    )

    def find_row(runs):
        data = {**results, **calm, name: {"runs": calm[name]["runs"] | runs}}
        return next(row for row in REST.reduce(settings, data) if row.quantity == quantity)

    row = find_row({})
    assert (row.here, row.unit, row.note) == (6, "of 6", "")
    row = find_row({"angular_speed": np.array([0.3, 0.0])})
    assert (row.here, row.note) == (5, "auto at 0.3 rad/s, drift 0 mm")
    assert find_row({"asleep": np.array([1.0, 0.0])}).here == 5
    assert find_row({"drift": np.array([2e-4, 2e-4])}).here == 4


def test_bodies_that_roll_are_told_from_those_that_lie_still(rests):
    settings, results = rests
    times = np.array([0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0])
    turning = {
        "orientation": np.repeat([0, 1], 8),
        "time": np.tile(times, 2),
        # One is still from 0.5 s on; the other trembles at 1 s, and rolls at the end.
        "angular_speed": np.array([1, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0.01, 0, 0, 0, 0.3]),
    }
    tables = {"turning": turning}
    np.testing.assert_array_equal(find_stills(tables), [0.5, np.inf])
    assert [count_below(settings, tables, limit) for limit in (0.002, 0.1)] == [1, 2]
    data = {**results, "roll-fine-500": tables, "roll-whole-hull-500": tables}
    data = {name: each for name, each in data.items() if "mujoco" not in name}
    rows = {row.quantity: row for row in REST.reduce(settings, data)}
    row = rows["below 0.002 rad/s after 1 s, VPS fine, 500 Hz, analytic plane"]
    assert row.here == 1
    assert row.note == (
        "0 roll at 0.1 rad/s or more; still to the end: half from 0.5 s on, "
        "nine of ten not within 2 s, all not within 2 s"
    )
    missing = rows[
        "below 0.002 rad/s after 1 s, MuJoCo's hull of all vertices, 500 Hz, analytic plane"
    ]
    assert np.isnan(missing.here)
    assert "voxshell-studies[peers]" in missing.note
    ours = rows["angular speed after 1 s, worst, fine, auto, analytic plane"]
    assert "; whole hull at 500 Hz: Bullet's 1)" in ours.note


def test_rolling_friction_stops_bodies_that_roll(rests):
    _, results = rests
    for shell in study.SHELLS:
        bare, held = (
            results[study.name_rest("plane", shell, "auto", held=held)]["runs"]
            for held in (False, True)
        )
        assert bare["end_angular_speed"].max() > 0.1 > 0.02 > held["end_angular_speed"].max()


def test_what_rolls_is_let_go_at_its_height_and_has_the_whole_hull(rests):
    settings, results = rests
    directions = np.random.default_rng(0).normal(size=(50, 3))
    mesh, hull = settings.build_mesh().vertices, study.find_hull(settings)
    assert len(hull) < len(mesh) / 10
    np.testing.assert_allclose(
        (hull @ directions.T).max(0), (mesh @ directions.T).max(0), atol=1e-7
    )
    for roller in ("fine", "hull", "whole-hull"):
        turning = results[f"roll-{roller}-200"]["turning"]
        # Hulls float by their margin, and touch so much earlier.
        falls = turning["time"] < -0.01
        assert falls.any()
        assert (turning["angular_speed"][falls] == 0.0).all()
        assert turning["angular_speed"].max() > 0.1
