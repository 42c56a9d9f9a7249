"""The study of geometry, small: what it measures, and its verdicts."""

from __future__ import annotations

from itertools import groupby

import numpy as np
import pytest
import voxshell as vx
from experiments import compute
from poses import lift
from voxshell.errors import SettingsError
from voxshell_studies.geometry import costs
from voxshell_studies.geometry.models import RETRIANGULATED, Pair, move
from voxshell_studies.geometry.study import GeometrySettings, name_pair, name_scene
from voxshell_studies.report.geometry.experiment import GEOMETRY
from voxshell_studies.scenes.geometry import PAIRS, SCENES, random_rotation

SMALL = GeometrySettings(
    scenes=("ball on slab 0.3 m", "crossed knives", "ring on peg, sideways", "cup on cup"),
    poses=2,
    rotations=1,
    retriangulated=1,
    copied_poses=1,
    judged=6,
    judged_pairs=3,
    pairs=1,
    pair_poses=40,
    optimized=6,
    builds=2,
    compared_poses=3,
    compared_resolution=30,
)


# ---- measures ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def results():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(costs, "COMPARED", "ellipsoid")  # the bunny takes long to build
        return compute(GEOMETRY, SMALL)


def test_copies_and_orders_are_asked_about_the_same_pose():
    rng = np.random.default_rng(4)
    a, b = "dented box", "tetrahedron"
    pairs = [Pair(a, b, copy) for copy in (0, 1, RETRIANGULATED)]
    pose = lift(0.07, random_rotation(rng))
    told = [pair.ask(vx.distance, pose, order) for pair in pairs for order in (0, 1)]
    # Two voxels of the larger.
    assert np.ptp([each.distance for each in told]) < 0.0016
    # Copies are other models; distances to exact cells may be equal to the bit all the same.
    assert np.ptp([each.point_a for each in told[::2]], axis=0).max() > 0.0
    assert told[0].point_a == pytest.approx(told[1].point_b, abs=0.0016)


def test_every_scene_pose_copy_and_order_has_its_row(results):
    for name in SMALL.scenes:
        tables = results[name_scene(name)]
        # Two poses, and one of each copy, in two orders.
        assert len(tables["approaches"]["onset"]) == 8
        assert len(tables["depths"]["yes"]) == 8 * len(SCENES[name].looked_at)
        assert (tables["approaches"]["slope"] > 0.0).all()
        assert (tables["approaches"]["slope"] <= 1.0 + 1e-9).all()
        assert (tables["depths"]["way_out"] <= tables["depths"]["depth"] + 1e-9).all()
    ball = results[name_scene("ball on slab 0.3 m")]
    assert np.abs(ball["approaches"]["onset"]).max() < 0.0005
    assert np.degrees(np.median(ball["contacts"]["angle"])) < 5.0


def test_onset_is_where_collide_begins_to_say_yes(results):
    scene = SCENES["cup on cup"]
    table = results[name_scene(scene.name)]["approaches"]
    pair = Pair(scene.a, scene.b)
    row = 0
    assert np.isfinite(table["onset"][row])
    pose = scene.place(int(table["pose"][row]))
    first = table["touch"][row] + table["onset"][row]
    order = int(table["order"][row])
    assert pair.ask(vx.collide, move(pose, scene.direction, first), order)
    assert not pair.ask(vx.collide, move(pose, scene.direction, first - 2e-7), order)


def test_rows_have_verdicts_by_the_data(results, tmp_path):
    rows = {row.quantity: row for row in GEOMETRY.reduce(SMALL, results)}
    part = name_scene("ball on slab 0.3 m")
    quantity = "first contact beyond the first touch, ball on slab 0.3 m"
    assert rows[quantity].bar == "<= 0.15"
    for onset, holds in (
        (1e-5, True),
        (-1e-5, True),
        (1e-3, False),
        (-1e-3, False),
        (np.inf, False),
    ):
        table = results[part]["approaches"]
        table = table | {"onset": np.full(8, onset), "slope": np.ones(8)}
        changed = {**results, part: {**results[part], "approaches": table}}
        row = {row.quantity: row for row in GEOMETRY.reduce(SMALL, changed)}[quantity]
        assert row.holds is holds
        assert row.here == pytest.approx(onset * 1e3)
    for quantity in (
        "wrong answers at least the bar off the first touch, bodies at rest",
        "deepest contact off the true depth at most, ball on slab 0.3 m",
        "normals off the nearest surface's cone, 99 %, cup on cup",
        "points_b off b at most, cup on cup",
        "normals within 10 degrees of the nearest surface's cone, bracket 6 mm, 1 mm deep in any pose",
        "points_b within a quarter voxel of b, cup 1.5 mm, 1 mm deep in any pose",
        "two bodies in the same pose, no contact",
        f"answers wrong beyond the stated bounds, {' and '.join(PAIRS[0])}",
        f"stated bounds at most, {' and '.join(PAIRS[0])}",
        f"stated bound over the worst overlap that is denied, {' and '.join(PAIRS[0])}",
        "default builds beyond 3 s or 64 MB without a warning",
        "memory of field and shell",
        "time to build",
        "time of contacts, one shell, median of poses",
        "time of contacts, both shells, 99 % of poses",
    ):
        assert isinstance(rows[quantity].holds, bool), quantity
    pictures = GEOMETRY.draw(SMALL, results, tmp_path)
    assert all((tmp_path / picture.path).is_file() for picture in pictures)


def test_an_overlap_that_is_denied_after_others_were_seen_falls_short(results):
    quantity = "approaches with an overlap that is denied, edges, corners and tips"
    part = name_scene("crossed knives")
    table = results[part]["approaches"]
    assert _reduce(results)[quantity].holds
    unseen = np.zeros(8)
    unseen[3] = 0.01
    changed = {**results, part: {**results[part], "approaches": table | {"unseen": unseen}}}
    row = _reduce(changed)[quantity]
    assert (row.here, row.holds) == (1, False)


def test_stated_bounds_that_are_violated_fall_short(results):
    name = name_pair(0)
    poses = results[name]["poses"]
    assert ((poses["offset"] > 0.0) & (poses["yes"] == 1.0)).any()
    assert (poses["yes"] == 0.0).any()
    quantity = f"answers wrong beyond the stated bounds, {' and '.join(PAIRS[0])}"
    proven = poses["proven"].copy()
    proven[0] = 2.0 * max(poses["overlap"][0], poses["clearance"][0])
    changed = {**results, name: {**results[name], "poses": poses | {"proven": proven}}}
    assert {row.quantity: row for row in GEOMETRY.reduce(SMALL, changed)}[quantity].holds is False


def test_builds_without_a_warning_have_to_be_small_and_fast(results):
    quantity = "default builds beyond 3 s or 64 MB without a warning"
    table = results["builds"]["builds"]
    for change, holds in (
        ({}, True),
        ({"seconds": np.full(2, 4.0), "warnings": np.zeros(2)}, False),
        ({"bytes": np.full(2, 1e8), "warnings": np.zeros(2)}, False),
        ({"bytes": np.full(2, 1e8), "warnings": np.ones(2)}, True),
    ):
        changed = {**results, "builds": {"builds": table | change}}
        rows = {row.quantity: row for row in GEOMETRY.reduce(SMALL, changed)}
        assert rows[quantity].holds is holds


def test_costs_are_those_of_models_that_are_as_exact(results):
    builds = results["costs"]["builds"]
    uniform, tolerance = (builds["field"][builds["kind"] == kind] for kind in (0, 1))
    assert (tolerance <= uniform[0]).all()
    assert (tolerance > 0.3 * uniform[0]).all()
    assert (builds["segments"][builds["kind"] == 0] == 0).all()
    for column, bar, names in (
        ("bytes", 1.0, ["memory of field and shell"]),
        ("seconds", 1.5, ["time to build"]),
    ):
        for factor, holds in ((0.99 * bar, True), (1.01 * bar, False)):
            values = np.where(builds["kind"] == 1, factor, 1.0)
            changed = {"builds": builds | {column: values}}
            rows = _reduce({**results, "costs": {**results["costs"], **changed}})
            assert [rows[name].holds for name in names] == [holds]
    queries = results["costs"]["queries"]
    assert all(len(seconds) == 3 and (seconds > 0.0).all() for seconds in queries.values())
    slow = queries | {"tolerance_both": 1.4 * queries["uniform_both"]}
    rows = _reduce({**results, "costs": {"builds": builds, "queries": slow}})
    assert rows["time of contacts, both shells, median of poses"].holds is False
    assert rows["time of contacts, both shells, median of poses"].here == pytest.approx(1.4)


def test_rows_are_grouped_and_groups_are_not_torn(results):
    groups = [row.group for row in GEOMETRY.reduce(SMALL, results)]
    assert all(groups)
    assert len([group for group, _ in groupby(groups)]) == len(set(groups)) == 12


def _reduce(results):
    return {row.quantity: row for row in GEOMETRY.reduce(SMALL, results)}


def test_wrong_settings_are_refused():
    with pytest.raises(SettingsError, match="scenes: unknown scene 'tea party'"):
        GeometrySettings(scenes=("tea party",))
    with pytest.raises(SettingsError, match="retriangulated"):
        GeometrySettings(retriangulated=2)
