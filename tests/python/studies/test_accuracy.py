from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from experiments import compute, draw
from voxshell_studies.accuracy import AccuracySettings
from voxshell_studies.report.accuracy import ACCURACY


def test_depths_are_true_to_a_voxel(tmp_path):
    settings = replace(
        AccuracySettings(),
        poses=4,
        least_depth=0.001,
        fine_points=4_000,
        voxel_size=0.004,
        reference_voxel_size=0.002,
    )
    results = compute(ACCURACY, settings)
    rows = {row.quantity: row for row in ACCURACY.reduce(settings, results)}
    assert rows["depth off the truth at most, fine"].holds
    assert rows["overlaps deeper than a voxel that the fine shell misses"].holds
    assert rows["meshes overlap, no contact, fine"].unit.startswith("of ")
    table = results["depths"]["depths"]
    assert (table["volume"] > 0.0).sum() >= 3  # the poses do overlap
    ratio = rows["areas by depths over the exact volume, all poses together, fine"].here
    assert ratio == pytest.approx(table["fine_volume"].sum() / table["volume"].sum())
    assert 0.6 < ratio < 1.4
    blind = {"depths": table | {"fine": np.zeros(4), "truth": np.full(4, 0.005)}}
    rows = {row.quantity: row for row in ACCURACY.reduce(settings, {"depths": blind})}
    assert rows["depth off the truth at most, fine"].holds is False
    assert rows["overlaps deeper than a voxel that the fine shell misses"].holds is False
    draw(ACCURACY, settings, results, tmp_path)
