"""Rows and tables of the study of limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from voxshell_studies.limits import LimitsSettings, name_run
from voxshell_studies.report.limits import LIMITS, TABLE, Line, make_lines
from voxshell_studies.scenes.limits import SCENES

NAME = "ball of 100 mm rolls over tiles of 0.2 m at 1 m/s"
SETTINGS = LimitsSettings(scenes=(NAME,), rates=(200.0, 30.0))


@pytest.fixture
def results():
    """Of three placements at 200 Hz, and of one at 30 Hz."""
    values = {200.0: [0.9, 0.95, 0.7], 30.0: [0.25]}
    return {
        name_run(SCENES[NAME], rate): {"runs": {"value": np.array(found)}}
        for rate, found in values.items()
    }


def test_a_line_has_the_median_and_the_worst(results):
    (line,) = make_lines(SETTINGS, results)
    assert line.format(200.0) == "0.9 (0.7)"
    assert line.format(30.0) == "0.25"
    assert line.format(60.0) == ""


def test_the_worst_is_farthest_from_the_truth():
    scene = replace(SCENES[NAME], truth=1.0)
    line = Line(scene, {60.0: np.array([0.8, 1.3, 1.0]), 30.0: np.array([0.8, np.nan, 1.0])})
    assert line.worst(60.0) == 1.3
    assert np.isnan(line.worst(30.0))
    assert line.format(30.0) == "-"


def test_a_row_names_the_worst_rate(results):
    (row,) = LIMITS.reduce(SETTINGS, results)
    assert row.here == 0.25
    assert row.below_heading == f"{NAME}, speed after 1.5 s"
    assert row.note == "worst at 30 Hz, to be 1; 200 Hz 0.9 (0.7), 30 Hz 0.25"


def test_tables_are_written(results, tmp_path):
    assert LIMITS.draw(SETTINGS, results, tmp_path) == []
    table = (tmp_path / TABLE).read_text()
    assert f"### {SCENES[NAME].group}" in table
    assert f"| {NAME}: speed after 1.5 s, m/s | 1 |  | 0.9 (0.7) |  | 0.25 |" in table
