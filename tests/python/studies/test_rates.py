from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from experiments import compute, draw
from trimesh.transformations import rotation_matrix
from voxshell.errors import SettingsError
from voxshell_studies import rates
from voxshell_studies.motion import read_poses
from voxshell_studies.rates import RatesSettings
from voxshell_studies.report.rates import RATES, is_carried
from voxshell_studies.scenes.bunny import find_lowest

SETTINGS = replace(
    RatesSettings(),
    orientations=1,
    rates=(50, 10),
    seconds=1.5,
    fine_points=2_000,
    voxel_size=0.004,
)


@pytest.fixture(scope="module")
def results():
    return compute(RATES, SETTINGS)


def test_more_segments_hold_at_lower_rates(results):
    rows = {row.quantity: row for row in RATES.reduce(SETTINGS, results)}
    one = rows["lowest rate that holds, L = 1, published rule, half-space"].here
    five = rows["lowest rate that holds, L = 5, published rule, half-space"]
    assert five.reproduced is (five.here < one)
    assert all(
        r.reproduced is not None for r in rows.values() if r.published in (10.0, "less at higher L")
    )
    thrown = rows["went through when thrown at 50 m/s, 60 Hz, auto, half-space"]
    assert thrown.holds


def test_bodies_hardly_sink_at_the_lowest_rates():
    """Found in time, and with iterations enough for what gravity adds in steps of 0.2 s."""
    settings = replace(SETTINGS, orientations=10, rates=(7.5, 5), seconds=4.0)
    runs = rates.run_falls(settings, "voxshell", "slab", "auto")["runs"]
    assert runs["later_depth"].max() < 0.002


def test_bars_are_held_to_the_data(results):
    name = "fall-voxshell-plane-auto"
    runs = {key: values.copy() for key, values in results[name]["runs"].items()}
    runs["later_depth"][:] = runs["rest_depth"][:] = 0.0041
    runs["middle"][:] = -0.1
    rows = {r.quantity: r for r in RATES.reduce(SETTINGS, {**results, name: {"runs": runs}})}
    assert rows["lowest rate that holds, auto, our rule, half-space"].holds is False
    for what in ("deepest after the first contact", "deepest at rest"):
        row = rows[f"{what}, 50 to 5 Hz, auto, our rule, half-space"]
        assert row.here == pytest.approx(4.1)
        assert row.holds is False
        assert "2 of 2 runs above the bar, at 50 Hz and less" in row.note


def test_lowest_rate_ends_where_one_run_is_lost():
    every = np.array([50.0, 20.0, 10.0])
    assert rates.find_lowest_rate(every, np.array([True, False, True])) == 50.0
    assert rates.find_lowest_rate(every, np.array([False, True, True])) == math.inf
    assert rates.find_lowest_rate(every, np.array([True, True, True])) == 10.0


def test_beside_the_slab_is_not_carried():
    runs = {"middle": np.array([0.1, 0.1, -0.1]), "sideways": np.array([0.0, 0.6, 0.0])}
    assert is_carried(runs, "slab").tolist() == [True, False, False]
    assert is_carried(runs, "plane").tolist() == [True, True, False]


def test_what_hangs_over_the_slabs_edge_is_not_deep():
    mesh = trimesh.creation.box((0.2, 0.2, 0.2))
    pose = np.eye(4)
    pose[2, 3] = -0.05
    assert rates._find_lowest_over_slab(mesh, pose) == find_lowest(mesh, pose)
    pose[0, 3] = 0.55
    turned = pose @ rotation_matrix(0.3, (0.0, 1.0, 0.0))
    assert find_lowest(mesh, turned) < rates._find_lowest_over_slab(mesh, turned) < math.inf
    pose[0, 3] = 0.7
    assert rates._find_lowest_over_slab(mesh, pose) == math.inf


def test_low_rates_run_long_enough_to_come_to_rest():
    assert rates._count_steps(SETTINGS, 2.0) == rates.LEAST_STEPS
    assert rates._count_steps(SETTINGS, 50.0) == 75


def test_shown_falls_are_those_of_their_rule(results):
    """At 10 Hz the contact of one segment lets the bunny sink by many voxels, ours do not."""
    mesh = SETTINGS.build_mesh()
    depths = {}
    for number, case in enumerate(rates.SHOWN):
        poses = read_poses({"poses": results["shown"][f"{number}_poses"]}, "bunny")
        depths[case] = -min(find_lowest(mesh, pose) for pose in poses)
    assert depths["voxshell", "auto", 10.0] < SETTINGS.voxel_size
    assert depths["published", "level 1", 10.0] > 5 * SETTINGS.voxel_size


def test_rates_descend():
    with pytest.raises(SettingsError, match="rates must descend"):
        RatesSettings(rates=(10.0, 20.0))


def test_pictures_are_drawn(results, tmp_path):
    draw(RATES, SETTINGS, results, tmp_path)
