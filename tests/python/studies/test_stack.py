from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from experiments import compute, draw
from voxshell.errors import SettingsError
from voxshell_studies import stack
from voxshell_studies.motion import read_poses
from voxshell_studies.report.stack import STACK
from voxshell_studies.scenes.stack import StackSettings

SETTINGS = replace(
    StackSettings(), seeds=3, seconds=4.0, resolutions=(275, 800, 2_700), bunny_seeds=2
)


@pytest.fixture(scope="module")
def results():
    return compute(STACK, SETTINGS)


def test_every_published_row_has_a_verdict(results):
    rows = STACK.reduce(SETTINGS, results)
    assert all(row.reproduced is not None for row in rows if row.published is not None)
    assert any(row.quantity.startswith("growth of that time") for row in rows)


def test_collapse_is_when_the_top_has_fallen_by_a_radius(results):
    tables = results["published-275"]
    for seed, collapse in zip(*tables["runs"].values(), strict=True):
        mine = tables["heights"]["seed"] == seed
        last = tables["heights"]["step"][mine][-1] / SETTINGS.rate
        assert 0.0 <= collapse - last <= stack.KEPT_EVERY / SETTINGS.rate
        assert tables["heights"]["top"][mine][0] == pytest.approx(4.5)
        assert np.all(tables["heights"]["top"][mine] > 3.9)


def test_a_stack_that_stands_holds_the_bar_and_one_that_falls_does_not(results):
    name = "voxshell-2700"
    for collapse, holds in ((np.inf, True), (3.0, False)):
        runs = results[name]["runs"] | {"collapse": np.full(SETTINGS.seeds, collapse)}
        rows = STACK.reduce(SETTINGS, {**results, name: {**results[name], "runs": runs}})
        bar = next(row for row in rows if row.bar)
        assert bar.holds is holds


def test_seeds_turn_the_spheres(results):
    poses = results["published-275"]["poses"]
    entries = np.stack([poses[key] for key in ("xx", "yy", "zz")])[:, poses["frame"] == 0]
    assert len(np.unique(entries.round(6), axis=1).T) == SETTINGS.count + 1  # the ground is one


def test_bunnies_stand_on_each_other_and_their_bar_follows_the_data(results):
    tables = results["bunnies"]
    assert np.isinf(tables["runs"]["collapse"]).all()
    heights = [read_poses(tables, f"bunny {n + 1}")[-1][2, 3] for n in range(5)]
    assert (np.diff(heights) > 0.05).all()
    tops = tables["heights"]["top"]
    assert tops.max() - tops.min() < stack.BUNNY_FALL
    assert len(np.unique(tops[tables["heights"]["step"] == 0])) == 2  # each is shaken its own way
    for collapse, holds in (((np.inf, np.inf), True), ((np.inf, 3.0), False)):
        runs = {**tables["runs"], "collapse": np.array(collapse)}
        rows = STACK.reduce(SETTINGS, {**results, "bunnies": {**tables, "runs": runs}})
        bar = next(row for row in rows if row.quantity.startswith("5 bunnies stand"))
        assert bar.holds is holds


def test_resolutions_ascend():
    with pytest.raises(SettingsError, match="resolutions must ascend"):
        StackSettings(resolutions=(2_000, 1_000))


def test_pictures_are_drawn(results, tmp_path):
    draw(STACK, SETTINGS, results, tmp_path)
