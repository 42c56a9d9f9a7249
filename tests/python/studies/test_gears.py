from __future__ import annotations

import numpy as np
import pytest
import voxshell as vx
from experiments import draw
from voxshell_studies import convex_parts
from voxshell_studies.gears import GearsSettings, turn_gears
from voxshell_studies.part import compute_part
from voxshell_studies.report.gears import GEARS


@pytest.fixture(scope="module")
def gear_results():
    settings = GearsSettings(
        teeth=(10, 20),
        voxel_size=0.0004,
        speed=2.0,
        methods=("voxshell", "gimpact", "coacd"),
    )
    parts = [part for part in GEARS.plan(settings) if part.name != "coacd"]
    results = {part.name: compute_part(part).tables for part in parts}
    # As where CoACD is not installed, whether it is or not.
    return settings, {**results, "coacd": turn_gears(settings, "coacd", "")}


def test_gears_turn_at_the_ratio_of_their_teeth(gear_results, tmp_path):
    settings, results = gear_results
    rows = {row.quantity: row for row in GEARS.reduce(settings, results)}
    ours = rows["turns of the driven gear for one of the other, VPS"]
    assert ours.holds
    assert ours.here == pytest.approx(2.0, rel=0.01)
    assert rows["deepest true overlap of the teeth, VPS"].holds
    draw(GEARS, settings, results, tmp_path)


def test_bars_of_gears_follow_the_data(gear_results):
    settings, results = gear_results
    steps, frames = results["voxshell"]["steps"], results["voxshell"]["frames"]
    for changed, ratio in (
        ({"other": 0.97 * steps["other"]}, 2.0 / 0.97),  # slips
        ({"other": np.minimum(-0.5, steps["other"]).clip(-0.5)}, np.nan),  # is stuck
        ({"other": -steps["other"]}, np.nan),  # turns the wrong way
    ):
        mine = {**results["voxshell"], "steps": {**steps, **changed}}
        row = GEARS.reduce(settings, {**results, "voxshell": mine})[0]
        assert row.holds is False
        assert row.here == pytest.approx(ratio, rel=0.005, nan_ok=True)
    deep = {"overlap": frames["overlap"] + 0.001}
    row = GEARS.reduce(settings, {**results, "voxshell": {**results["voxshell"], "frames": deep}})[
        1
    ]
    assert row.holds is False


def test_decomposition_that_is_not_installed_is_a_row_that_says_so(gear_results, monkeypatch):
    settings, results = gear_results
    row = GEARS.reduce(settings, results)[-1]
    assert np.isnan(row.here)
    assert "pip install coacd" in row.note
    (missing,) = (part for part in plan_without_coacd(settings, monkeypatch))
    monkeypatch.setattr(convex_parts.metadata, "version", lambda library: "1.2.3")
    (installed,) = (part for part in GEARS.plan(settings) if part.name == "coacd")
    assert installed.address != missing.address  # it is run once it is there


def plan_without_coacd(settings, monkeypatch):
    def find_none(library):
        raise convex_parts.metadata.PackageNotFoundError(library)

    monkeypatch.setattr(convex_parts.metadata, "version", find_none)
    return [part for part in GEARS.plan(settings) if part.name == "coacd"]


def test_gears_fit_with_their_backlash():
    settings = GearsSettings()
    first, second = settings.build_models()
    apart = vx.distance(first, second, *settings.compute_start()).distance
    # Two flanks a side, each thinner by half the backlash, seen square to the flank.
    assert apart == pytest.approx(settings.backlash * np.cos(np.radians(20.0)), rel=0.15)
