from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from experiments import compute
from voxshell.errors import SettingsError
from voxshell_studies import segments
from voxshell_studies.motion import read_poses
from voxshell_studies.report.segments import SEGMENTS
from voxshell_studies.segments import LEVELS, SegmentsSettings

SETTINGS = replace(
    SegmentsSettings(), orientations=1, repeats=2, fine_points=3_000, voxel_size=0.004
)


@pytest.fixture(scope="module")
def results():
    return compute(SEGMENTS, SETTINGS)


def test_every_level_has_its_times_in_own_falls_and_equal_poses(results):
    steps = results["orientation-0-fine"]["steps"]
    assert sorted(set(steps["level"].tolist())) == list(LEVELS)
    assert len(steps["step"]) == len(LEVELS) * SETTINGS.last_step
    same = results["orientation-0-fine"]["same_poses"]
    assert same["step"].min() == SETTINGS.first_step + 1
    assert len(same["step"]) == len(LEVELS) * (SETTINGS.last_step - SETTINGS.first_step)
    assert (same["narrow_phase"] >= same["query"]).all()
    assert (same["query"] > 0.0).mean() > 0.9
    rest = steps["step"] > SETTINGS.first_step
    one, five = (steps["contacts"][rest & (steps["level"] == level)] for level in (1, 5))
    assert one.max() <= 4  # one manifold
    assert five.mean() > 2.0


def test_rows_follow_the_data(results):
    rows = {row.quantity: row for row in SEGMENTS.reduce(SETTINGS, results)}
    assert rows["mean time, high, L = 3"].holds
    told = rows["max/min over L, high, whole narrow phase, equal poses"].note
    same = results["orientation-0-fine"]["same_poses"]
    five, one = (same["manifold"][same["level"] == level].mean() for level in (5, 1))
    assert f"manifold {1e6 * (five - one):+.2f} " in told
    slow = {}
    timed = {name: tables for name, tables in results.items() if name.startswith("orientation")}
    for name, tables in timed.items():
        columns = {key: values.copy() for key, values in tables["steps"].items()}
        columns["narrow_phase"] = np.where(columns["level"] == 5, 1e-3, 1e-4)
        slow[name] = {**tables, "steps": columns}
    rows = {row.quantity: row for row in SEGMENTS.reduce(SETTINGS, slow)}
    flat = rows["max/min over L, high, whole narrow phase, own falls"]
    assert flat.here == pytest.approx(10.0)
    assert flat.reproduced is False
    assert flat.holds is False
    assert rows["mean time, high, L = 5"].holds is False


def test_steps_are_in_order():
    with pytest.raises(SettingsError, match="last_step must be after first_step"):
        SegmentsSettings(first_step=300, last_step=300)


def test_shown_falls_have_contacts_of_more_segments_at_higher_levels(results):
    shown = results["shown"]
    frames = segments.RECORDED_STEPS // segments.RECORDED_EVERY + 1
    most = []
    for level in LEVELS:
        poses = read_poses({"poses": shown[f"{level}_poses"]}, "bunny")
        assert len(poses) == frames
        assert poses[0, 2, 3] > poses[-1, 2, 3] > 0.0
        most.append(int(np.bincount(shown[f"{level}_contacts"]["frame"]).max()))
    assert most[0] < most[-1]


def test_picture_and_replay_are_made(results, tmp_path):
    assert [picture.path for picture in SEGMENTS.draw(SETTINGS, results, tmp_path)] == [
        "levels.png",
        "replay.html",
    ]
    assert (tmp_path / "levels.png").stat().st_size > 10_000
    assert (tmp_path / "replay.html").stat().st_size > 100_000
