"""Experiments beyond the section, small: what they find, and that their bars follow the data."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from voxshell.experiments import rest, slope
from voxshell.experiments.part import compute_part
from voxshell.experiments.report.rest import REST
from voxshell.experiments.report.slope import SLOPE


def compute(experiment, settings):
    return {part.name: compute_part(part).tables for part in experiment.plan(settings)}


def draw(experiment, settings, results, folder):
    pictures = experiment.draw(settings, results, folder)
    assert pictures
    assert all((folder / picture.path).is_file() for picture in pictures)


@pytest.fixture(scope="module")
def rests():
    settings = replace(
        rest.RestSettings(),
        orientations=2,
        settle_seconds=1.0,
        drift_seconds=1.0,
        fine_points=2_000,
        voxel_size=0.004,
    )
    return settings, compute(REST, settings)


def test_rest_has_every_ground_shell_and_mode(rests, tmp_path):
    settings, results = rests
    rows = REST.reduce(settings, results)
    assert len([row for row in rows if row.holds is not None]) == 36
    for name, tables in results.items():
        assert tables["runs"]["depth"].max() < 0.006, name
        assert (tables["runs"]["end_angular_speed"] < 20.0).all()
    draw(REST, settings, results, tmp_path)


def test_rest_bars_follow_the_data(rests):
    settings, results = rests
    name = "plane-fine-regular"
    for value, holds in ((1e-5, True), (1e-2, False)):
        runs = results[name]["runs"] | {
            "angular_speed": np.full(2, value),
            "drift": np.full(2, value),
            "asleep": np.full(2, float(holds)),
        }
        rows = REST.reduce(settings, {**results, name: {"runs": runs}})
        mine = [row for row in rows if row.quantity.endswith("fine, regular, analytic plane")]
        assert [row.holds for row in mine] == [holds] * 3


def test_box_slides_at_coulombs_angle(tmp_path):
    settings = replace(slope.SlopeSettings(), frictions=(0.5,), seconds=1.0)
    results = compute(SLOPE, settings)
    rows = {row.quantity: row for row in SLOPE.reduce(settings, results)}
    for kind in ("regular", "segmented"):
        assert rows[f"angle of sliding off Coulomb's, friction 0.5, {kind} contacts"].holds
    assert rows["angle of sliding off Coulomb's, friction 0.5, Bullet's box"].here < 1.0
    wrong = {"angles": results["regular"]["angles"] | {"angle": np.array([20.0])}}
    rows = {row.quantity: row for row in SLOPE.reduce(settings, {**results, "regular": wrong})}
    assert rows["angle of sliding off Coulomb's, friction 0.5, regular contacts"].holds is False
    draw(SLOPE, settings, results, tmp_path)
