from __future__ import annotations

import numpy as np
import trimesh
from experiments import compute, draw
from voxshell_studies.report.pour import POUR
from voxshell_studies.scenes.pour import PourSettings


def test_pour_keeps_all_bodies_in_the_bin(tmp_path):
    trimesh.creation.torus(0.1, 0.03, 24, 16).export(tmp_path / "torus.stl")
    settings = PourSettings(
        mesh=str(tmp_path / "torus.stl"),
        count=6,
        voxel_size=0.004,
        bin_voxel_size=0.02,
        bin_size=(0.45, 0.45, 0.2),
        seconds=0.8,
        slow_steps=1,
    )
    results = compute(POUR, settings)
    tables = results["pour"]
    rows = {row.quantity: row for row in POUR.reduce(settings, results)}
    assert rows["left the bin or lost, VPS"].holds
    assert rows["median speed in the heap, VPS"].here < 200.0
    assert (tables["voxshell"]["contacts"][-20:] >= 6).all()
    heap = tables["heap"]
    assert {str(method) for method in heap["method"]} == {"voxshell", "decomposition", "gimpact"}
    ends = {**tables["ends"], "lost": np.arange(len(tables["ends"]["lost"])) == 0}
    rows = {row.quantity: row for row in POUR.reduce(settings, {"pour": {**tables, "ends": ends}})}
    assert rows["left the bin or lost, VPS"].holds is False
    draw(POUR, settings, results, tmp_path)
