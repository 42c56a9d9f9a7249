from __future__ import annotations

from dataclasses import replace

import pytest
from experiments import compute, draw
from voxshell_studies.report.scaling import SCALING
from voxshell_studies.scaling import ScalingSettings


@pytest.mark.slow
def test_growth_is_that_of_the_measured_times(tmp_path):
    """Benchmarks measure how much it is, and test_budgets.py counts the work."""
    settings = replace(
        ScalingSettings(),
        orientations=1,
        points=(500, 1_000),
        voxel_sizes=(0.01, 0.006),
        voxel_size=0.006,
        steps=20,
        bodies=(2,),
        poured=0.4,
    )
    results = compute(SCALING, settings)
    rows = {row.quantity: row for row in SCALING.reduce(settings, results)}
    for name in ("models at default settings", "models of voxels of 2 mm", "eight hulls in Bullet"):
        heap = rows[f"heaps, {name}: step with 2 bodies, median"]
        assert 0.0 < heap.here < 1e3
        assert "lost" not in heap.note
    assert "heaps, 2 bodies: eight hulls in Bullet over models at default settings" in rows
    for growth in (0.5, 1.0):
        points = results["points"]["times"]["points"]
        times = {**results["points"]["times"], "seconds": 1e-9 * points**growth}
        rows = SCALING.reduce(settings, {**results, "points": {"times": times}})
        (exponent,) = (r for r in rows if r.quantity == "growth of time with points, exponent")
        assert exponent.here == pytest.approx(growth)
    draw(SCALING, settings, results, tmp_path)
