from __future__ import annotations

from dataclasses import replace

import numpy as np
from experiments import compute, draw
from voxshell_studies.part import compute_part
from voxshell_studies.report.nut import NUT
from voxshell_studies.scenes.bolt import BoltSettings


def test_nut_stays_on_its_thread(tmp_path):
    settings = replace(
        BoltSettings(),
        voxel_size=0.0004,
        segments=24,
        seconds=0.15,
        length=0.04,
        rate=500.0,
        fit_methods=("voxshell", "gimpact", "hull"),
    )
    results = compute(NUT, settings)
    rows = {row.quantity: row for row in NUT.reduce(settings, results)}
    assert rows["off its thread at most, no friction, regular"].holds
    hulls = next(row for name, row in rows.items() if name.endswith("apart, convex hulls"))
    ours = next(row for name, row in rows.items() if name.endswith("apart, VPS"))
    assert hulls.here > 5.0
    assert ours.here == 0.0
    assert ours.holds
    steps = results["turn-regular"]["steps"]
    assert steps["height"][-1] < 0.0  # it fell by its play at least
    through = {"steps": {**steps, "height": steps["height"] - 0.01}}
    rows = {row.quantity: row for row in NUT.reduce(settings, {**results, "turn-regular": through})}
    assert rows["off its thread at most, no friction, regular"].holds is False
    draw(NUT, settings, results, tmp_path)


def test_coarse_cuts_take_the_nuts_clearance():
    """As it was once: twelve cuts a pitch left a quarter of the clearance that the description told."""
    holds = {}
    for sections in (12, NUT.settings.sections):
        settings = replace(NUT.settings, sections=sections, fit_methods=("voxshell",))
        assert f"{sections} cuts per pitch" in NUT.describe(settings)
        fit = next(part for part in NUT.plan(settings) if part.name == "fit")
        still = {"steps": {name: np.zeros(9) for name in ("height", "turns", "depth")}}
        results = {part.name: still for part in NUT.plan(settings)}
        results["fit"] = compute_part(fit).tables
        rows = {row.quantity: row for row in NUT.reduce(settings, results)}
        holds[sections] = rows["distance of the threads in the middle of their play"].holds
    assert holds == {12: False, NUT.settings.sections: True}
