"""Pairs in any pose: the worst overlap that is denied is found."""

from __future__ import annotations

from dataclasses import replace

import voxshell as vx
from voxshell_studies.geometry import pairs
from voxshell_studies.geometry.study import GeometrySettings
from voxshell_studies.scenes.geometry import PAIRS


def test_overlaps_that_are_denied_are_found_and_made_worse(monkeypatch):
    settings = replace(GeometrySettings(), pairs=1, pair_poses=60, optimized=12)

    def deny_shallow(*arguments: object, **options: object) -> bool:
        return vx.distance(*arguments, **options).distance < -0.002

    monkeypatch.setattr(pairs, "collide", deny_shallow)
    tables = pairs.measure_pair(settings, PAIRS.index(("star", "dented box")))
    worst, poses = tables["worst"], tables["poses"]
    assert ((poses["overlaps"] == 1.0) & (poses["yes"] == 0.0)).sum() > 10
    assert (worst["random"] > 1e-4).all()
    assert (worst["optimized"] >= worst["random"]).all()
    assert (worst["optimized"] > 1.01 * worst["random"]).any()
