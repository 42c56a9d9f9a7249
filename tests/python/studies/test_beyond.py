"""Experiments beyond the section, small: what they find, and that their bars follow the data."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.model.mass_properties import MassProperties
from voxshell_studies import convex_parts, rest, slope
from voxshell_studies.accuracy import AccuracySettings
from voxshell_studies.gears import GearsSettings, turn_gears
from voxshell_studies.pair import FALL_HEIGHT, PairSettings, find_falls, find_resting_poses
from voxshell_studies.pair import rests as rests_as_a_stack
from voxshell_studies.part import compute_part
from voxshell_studies.report.accuracy import ACCURACY
from voxshell_studies.report.gears import GEARS
from voxshell_studies.report.nut import NUT
from voxshell_studies.report.pair import PAIR
from voxshell_studies.report.pour import POUR
from voxshell_studies.report.rest import REST, count_below, find_stills
from voxshell_studies.report.scaling import SCALING
from voxshell_studies.report.slope import SLOPE
from voxshell_studies.rest_mujoco import MuJoCoFall
from voxshell_studies.scaling import ScalingSettings
from voxshell_studies.scenes.bolt import BoltSettings, measure_turns
from voxshell_studies.scenes.bunny import BunnySettings
from voxshell_studies.scenes.pour import PourSettings


def compute(experiment, settings):
    return {part.name: compute_part(part).tables for part in experiment.plan(settings)}


def draw(experiment, settings, results, folder):
    pictures = experiment.draw(settings, results, folder)
    assert pictures
    assert all((folder / picture.path).is_file() for picture in pictures)


@pytest.fixture(scope="module")
def rests():
    settings = replace(
        rest.RestSettings(),
        orientations=2,
        others=2,
        settle_seconds=1.0,
        drift_seconds=1.0,
        roll_rates=(200.0, 500.0),
        fine_points=2_000,
        voxel_size=0.004,
    )
    return settings, compute(REST, settings)


def test_rest_has_every_ground_shell_and_mode(rests, tmp_path):
    settings, results = rests
    rows = REST.reduce(settings, results)
    assert len([row for row in rows if row.holds is not None]) == 72
    assert len([row for row in rows if "rad/s after 1 s, " in row.quantity]) == 10
    for name, tables in results.items():
        if name.startswith("roll-"):
            continue
        assert tables["runs"]["depth"].max() < 0.006, name
        assert (tables["runs"]["end_angular_speed"] < 20.0).all()
    draw(REST, settings, results, tmp_path)


@pytest.mark.parametrize("held", [False, True])
def test_rest_bars_follow_the_data(rests, held):
    settings, results = rests
    name = rest.name_rest("plane", "fine", "regular", held=held)
    who = "fine, regular, analytic plane" + (", 8 mm of rolling friction" if held else "")
    for value, holds in ((1e-5, True), (1e-2, False)):
        runs = results[name]["runs"] | {
            "angular_speed": np.full(2, value),
            "drift": np.full(2, value),
            "asleep": np.full(2, float(holds)),
        }
        rows = REST.reduce(settings, {**results, name: {"runs": runs}})
        mine = [row for row in rows if row.quantity.endswith(who)]
        assert [row.holds for row in mine] == [holds] * 3


def test_other_orientations_are_others_and_are_counted(rests):
    settings, results = rests
    name = rest.name_rest("plane", "coarse", "auto", held=True, others=True)
    runs = results[name]["runs"]
    np.testing.assert_array_equal(runs["orientation"], [20, 21])
    calm = {
        other: {"runs": tables["runs"] | {"angular_speed": np.zeros(2), "drift": np.zeros(2), "asleep": np.ones(2)}}
        for other, tables in results.items()
        if other.endswith("-others")
    }  # fmt: skip
    assert len(calm) == 12
    quantity = (
        "rest in 2 other orientations, coarse, all modes, analytic plane, 8 mm of rolling friction"
    )

    def find_row(runs):
        data = {**results, **calm, name: {"runs": calm[name]["runs"] | runs}}
        return next(row for row in REST.reduce(settings, data) if row.quantity == quantity)

    row = find_row({})
    assert (row.here, row.unit, row.note) == (6, "of 6", "")
    row = find_row({"angular_speed": np.array([0.3, 0.0])})
    assert (row.here, row.note) == (5, "auto at 0.3 rad/s, drift 0 mm")
    assert find_row({"asleep": np.array([1.0, 0.0])}).here == 5
    assert find_row({"drift": np.array([2e-4, 2e-4])}).here == 4


def test_bodies_that_roll_are_told_from_those_that_lie_still(rests):
    settings, results = rests
    times = np.array([0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0])
    turning = {
        "orientation": np.repeat([0, 1], 8),
        "time": np.tile(times, 2),
        # One is still from 0.5 s on; the other trembles at 1 s, and rolls at the end.
        "angular_speed": np.array([1, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0.01, 0, 0, 0, 0.3]),
    }
    tables = {"turning": turning}
    np.testing.assert_array_equal(find_stills(tables), [0.5, np.inf])
    assert [count_below(settings, tables, limit) for limit in (0.002, 0.1)] == [1, 2]
    data = {**results, "roll-fine-500": tables, "roll-whole-hull-500": tables}
    data = {name: each for name, each in data.items() if "mujoco" not in name}
    rows = {row.quantity: row for row in REST.reduce(settings, data)}
    row = rows["below 0.002 rad/s after 1 s, VPS fine, 500 Hz, analytic plane"]
    assert row.here == 1
    assert row.note == (
        "0 roll at 0.1 rad/s or more; still to the end: half from 0.5 s on, "
        "nine of ten not within 2 s, all not within 2 s"
    )
    missing = rows[
        "below 0.002 rad/s after 1 s, MuJoCo's hull of all vertices, 500 Hz, analytic plane"
    ]
    assert np.isnan(missing.here)
    assert "voxshell-studies[peers]" in missing.note
    ours = rows["angular speed after 1 s, worst, fine, auto, analytic plane"]
    assert "; whole hull at 500 Hz: Bullet's 1)" in ours.note


def test_rolling_friction_stops_bodies_that_roll(rests):
    _, results = rests
    for shell in rest.SHELLS:
        bare, held = (
            results[rest.name_rest("plane", shell, "auto", held=held)]["runs"]
            for held in (False, True)
        )
        assert bare["end_angular_speed"].max() > 0.1 > 0.02 > held["end_angular_speed"].max()


def test_what_rolls_is_let_go_at_its_height_and_has_the_whole_hull(rests):
    settings, results = rests
    directions = np.random.default_rng(0).normal(size=(50, 3))
    mesh, hull = settings.build_mesh().vertices, rest.find_hull(settings)
    assert len(hull) < len(mesh) / 10
    np.testing.assert_allclose(
        (hull @ directions.T).max(0), (mesh @ directions.T).max(0), atol=1e-7
    )
    for roller in ("fine", "hull", "whole-hull"):
        turning = results[f"roll-{roller}-200"]["turning"]
        # Hulls float by their margin, and touch so much earlier.
        falls = turning["time"] < -0.01
        assert falls.any()
        assert (turning["angular_speed"][falls] == 0.0).all()
        assert turning["angular_speed"].max() > 0.1


def test_mujoco_lets_a_box_fall_and_lie():
    pytest.importorskip("mujoco", reason="of voxshell-studies[peers]")
    corners = np.array(list(itertools.product((-0.1, 0.1), repeat=3)))
    matter = MassProperties(1.0, np.zeros(3), np.eye(3) * 0.2**2 / 6.0)
    pose = trimesh.transformations.rotation_matrix(0.3, (1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    pose[2, 3] = 0.2
    fall = MuJoCoFall(corners, matter, 1000.0, pose)
    turning = np.array([fall.step() for _ in range(2000)])
    assert (turning[:50] < 1e-12).all()
    assert turning.max() > 1.0
    assert turning[-1] < 1e-3


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


@pytest.fixture(scope="module")
def gear_results():
    settings = GearsSettings(
        teeth=(10, 20),
        voxel_size=0.0004,
        speed=2.0,
        methods=("voxshell", "gimpact", "coacd"),
    )
    parts = [part for part in GEARS.plan(settings) if part.name != "coacd"]
    results = {part.name: compute_part(part).tables for part in parts}
    # As where CoACD is not installed, whether it is or not.
    return settings, {**results, "coacd": turn_gears(settings, "coacd", "")}


def test_gears_turn_at_the_ratio_of_their_teeth(gear_results, tmp_path):
    settings, results = gear_results
    rows = {row.quantity: row for row in GEARS.reduce(settings, results)}
    ours = rows["turns of the driven gear for one of the other, VPS"]
    assert ours.holds
    assert ours.here == pytest.approx(2.0, rel=0.01)
    assert rows["deepest true overlap of the teeth, VPS"].holds
    draw(GEARS, settings, results, tmp_path)


def test_bars_of_gears_follow_the_data(gear_results):
    settings, results = gear_results
    steps, frames = results["voxshell"]["steps"], results["voxshell"]["frames"]
    for changed, ratio in (
        ({"other": 0.97 * steps["other"]}, 2.0 / 0.97),  # slips
        ({"other": np.minimum(-0.5, steps["other"]).clip(-0.5)}, np.nan),  # is stuck
        ({"other": -steps["other"]}, np.nan),  # turns the wrong way
    ):
        mine = {**results["voxshell"], "steps": {**steps, **changed}}
        row = GEARS.reduce(settings, {**results, "voxshell": mine})[0]
        assert row.holds is False
        assert row.here == pytest.approx(ratio, rel=0.005, nan_ok=True)
    deep = {"overlap": frames["overlap"] + 0.001}
    row = GEARS.reduce(settings, {**results, "voxshell": {**results["voxshell"], "frames": deep}})[
        1
    ]
    assert row.holds is False


def test_decomposition_that_is_not_installed_is_a_row_that_says_so(gear_results, monkeypatch):
    settings, results = gear_results
    row = GEARS.reduce(settings, results)[-1]
    assert np.isnan(row.here)
    assert "pip install coacd" in row.note
    (missing,) = (part for part in plan_without_coacd(settings, monkeypatch))
    monkeypatch.setattr(convex_parts.metadata, "version", lambda library: "1.2.3")
    (installed,) = (part for part in GEARS.plan(settings) if part.name == "coacd")
    assert installed.address != missing.address  # it is run once it is there


def plan_without_coacd(settings, monkeypatch):
    def find_none(library):
        raise convex_parts.metadata.PackageNotFoundError(library)

    monkeypatch.setattr(convex_parts.metadata, "version", find_none)
    return [part for part in GEARS.plan(settings) if part.name == "coacd"]


def test_gears_fit_with_their_backlash():
    settings = GearsSettings()
    first, second = settings.build_models()
    apart = vx.distance(first, second, *settings.compute_start()).distance
    # Two flanks a side, each thinner by half the backlash, seen square to the flank.
    assert apart == pytest.approx(settings.backlash * np.cos(np.radians(20.0)), rel=0.15)


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


def test_lost_bodies_are_found():
    settings = PourSettings(count=4)
    poses = settings.compute_starts()
    assert not settings.find_lost(poses).any()
    poses[1, 0, 3] = 0.5 * settings.bin_size[0] + 0.01
    poses[2, 2, 3] = -0.01
    poses[3, 0, 0] = np.nan
    assert settings.find_lost(poses).tolist() == [False, True, True, True]


def test_turns_are_those_of_the_pose():
    settings = BoltSettings()
    assert measure_turns(settings.compute_fit(3.25)) == pytest.approx(0.25)
    assert settings.compute_fit(3.25)[2, 3] == pytest.approx(3.25 * settings.pitch)


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
    assert rests_as_a_stack(settings)
    assert not rests_as_a_stack(replace(settings, size=0.2))
    stacked = BunnySettings().build_model()
    pairs = find_resting_poses(settings, stacked)
    assert pairs.shape == (4, 20, 4, 4)
    assert np.abs(pairs - pairs[:, :1]).max() < 1e-4
    for poses in pairs:
        gap = vx.distance(stacked, stacked, None, poses[0]).distance
        assert -stacked.field.voxel_size < gap < 5e-4


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


@pytest.mark.slow
def test_growth_is_that_of_the_measured_times(tmp_path):
    """Benchmarks measure how much it is, and test_queries.py counts the work."""
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
