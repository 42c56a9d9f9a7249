from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import trimesh
import voxshell as vx
from experiments import compute, draw
from voxshell_studies.pair import FALL_HEIGHT, PairSettings, find_falls, find_resting_poses, rests
from voxshell_studies.report.pair import PAIR
from voxshell_studies.scenes.bunny import BunnySettings


def test_pair_times_every_method_in_touching_poses(tmp_path):
    trimesh.creation.torus(0.1, 0.03, 24, 16).export(tmp_path / "torus.stl")
    settings = replace(
        PairSettings(),
        mesh=str(tmp_path / "torus.stl"),
        size=0.2,
        voxel_size=0.004,
        fine_points=2_000,
        coarse_points=300,
        poses=4,
        repeats=2,
        falls=2,
        fall_steps=20,
    )
    results = compute(PAIR, settings)
    found = results["times"]["contacts"]
    fine = found["method"] == "vps-fine"
    assert (found["contacts"][fine] > 0).all()
    assert (found["depth"][fine] < settings.most_depth + settings.voxel_size).all()
    rows = {row.quantity: row for row in PAIR.reduce(settings, results)}
    fine_time = rows["median time, VPS fine"].here
    assert rows["GImpact / VPS fine, bunny on bunny"].here == pytest.approx(
        rows["median time, GImpact"].here / fine_time
    )
    times = results["times"]["times"]
    whole, query = (
        times["seconds"][times["method"] == name] for name in ("vps-fine", "vps-fine-query")
    )
    assert (query < whole).all()
    assert "VPS takes query" in rows["decomposition / VPS fine, bunny on bunny"].note
    lengths = {key: int((times["method"] == key).sum()) for key in ("gimpact", "vps-fine")}
    assert lengths == {"gimpact": 2 * 4, "vps-fine": 2 * settings.turns * 4}
    falling = results["falling"]["times"]
    least = {
        key: np.median(
            falling["seconds"][falling["method"] == key].reshape(2 * settings.turns, -1).min(0)
        )
        for key in ("decomposition", "vps-coarse")
    }
    assert rows["Decomposition / VPS coarse, bunny on bunny, falling"].here == pytest.approx(
        least["decomposition"] / least["vps-coarse"]
    )
    assert "Decomposition / VPS fine, not followed, bunny on bunny, falling" in rows
    slow = {**times, "seconds": np.where(times["method"] == "vps-fine", 1.0, times["seconds"])}
    rows = PAIR.reduce(settings, {**results, "times": {**results["times"], "times": slow}})
    assert [row.holds for row in rows if row.bar] == [False, False]
    draw(PAIR, settings, results, tmp_path)


def test_falling_pairs_touch_at_speed():
    settings = replace(PairSettings(), size=0.2, falls=3, fall_steps=20)
    torus = vx.Model.from_mesh(
        trimesh.creation.torus(0.08, 0.03), voxel_size=0.004, target_points=2_000
    )
    falls = find_falls(settings, torus, "solid")
    fastest = np.sqrt(2 * 9.81 * FALL_HEIGHT * settings.size)
    for poses, velocities in falls:
        assert len(poses) == len(velocities) <= 20
        # The first touch is at the speed of the fall, and so near.
        assert 0.5 * fastest < np.linalg.norm(velocities[0, 0]) < fastest
        assert 0.0 < vx.distance(torus, torus, None, poses[0]).distance < fastest / settings.rate


def test_pairs_at_rest_touch_and_hardly_move():
    settings = replace(PairSettings(), rest_seconds=1.0, rest_steps=20)
    assert rests(settings)
    assert not rests(replace(settings, size=0.2))
    stacked = BunnySettings().build_model()
    pairs = find_resting_poses(settings, stacked)
    assert pairs.shape == (4, 20, 4, 4)
    assert np.abs(pairs - pairs[:, :1]).max() < 1e-4
    for poses in pairs:
        gap = vx.distance(stacked, stacked, None, poses[0]).distance
        assert -stacked.field.voxel_size < gap < 5e-4
