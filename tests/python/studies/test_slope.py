from __future__ import annotations

from dataclasses import replace

import numpy as np
from experiments import compute, draw
from voxshell_studies import slope
from voxshell_studies.report.slope import SLOPE


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
