"""Everyday scenes: closed forms where an engine is right, what is planned, and verdicts of a tiny run."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from voxshell.errors import SettingsError
from voxshell_studies.everyday import study
from voxshell_studies.everyday.study import EverydaySettings, measure_scene, name_part, plan
from voxshell_studies.part import compute_part
from voxshell_studies.report.everyday.experiment import EVERYDAY, TABLE
from voxshell_studies.report.everyday.table import Line, Worst, format_error
from voxshell_studies.scenes.everyday import SCENES, drops, forms, held_out, laws
from voxshell_studies.scenes.everyday.scene import ENGINES, Engine, Measure, Track, heading, turn
from voxshell_studies.scenes.geometry_bodies import make_body
from voxshell_studies.scenes.solids import import_manifold

SMALL = EverydaySettings(
    scenes=("cube stops, plane", "cradle of five balls", "pendulum on a hinge"),
    placements=1,
    longest=0.6,
    rates=(200.0, 30.0),
    engines=("voxshell", "bullet"),
)


def errors(name: str, engine: Engine, rates: tuple[float, ...], placements: int = 1) -> np.ndarray:
    """The worst error over the bar of each measure."""
    settings = EverydaySettings(placements=placements, rates=rates, longest=6.0)
    runs = measure_scene(settings, name, engine)["runs"]
    return np.array(
        [
            runs["error"][runs["measure"] == number].max() / measure.bar
            for number, measure in enumerate(SCENES[name].measures)
        ]
    )


# ---- closed forms --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "rates"),
    [
        ("cube slides down 35 degrees, slab", (1000.0, 200.0, 60.0, 30.0)),
        ("cube stops, slab", (1000.0, 200.0, 60.0)),
        ("cube holds on a slope, plane", (1000.0,)),
        ("cube of 0.1 m glides on a slab of 1 m", (1000.0, 200.0)),
        ("ball rolls down 15 degrees, plane", (1000.0, 200.0, 60.0, 30.0)),
        ("ball rolls off 0.5 degrees, plane", (1000.0, 200.0, 60.0)),
        ("ball rolls level at 0.2 m/s, slab", (1000.0, 200.0, 60.0, 30.0)),
        ("ball bowled at 1 m/s ends up rolling", (1000.0, 200.0, 60.0, 30.0)),
        ("ball drops straight, slab of 1 m", (1000.0, 200.0, 60.0, 30.0)),
        ("billiard balls, off center", (1000.0, 200.0, 60.0)),
        ("cradle of five balls", (1000.0, 200.0, 60.0, 30.0)),
        ("coin rolls upright at 1 m/s", (1000.0, 200.0, 60.0)),
        ("pendulum on a hinge", (1000.0, 200.0)),
        ("wedge slides away below a block", (1000.0, 200.0)),
        ("conveyor carries a cube", (1000.0, 200.0, 60.0, 30.0)),
        ("gripper lets a cube slip with 1.5 N", (1000.0,)),
        ("tori that overlap by half", (1000.0, 200.0, 60.0, 30.0)),
    ],
)
def test_shapes_of_bullet_do_what_the_closed_form_says(name, rates):
    assert errors(name, "bullet", rates).max() <= 1.0


def test_another_friction_is_told_from_the_closed_form(monkeypatch):
    name = "cube slides down 35 degrees, slab"
    scene = SCENES[name]
    slippery = replace(scene, stage=lambda i: replace(scene.stage(i), friction=0.45))
    monkeypatch.setitem(SCENES, name, slippery)
    assert errors(name, "bullet", (200.0,)).max() > 1.0


def test_free_body_keeps_what_euler_says():
    still = laws.tumble((1.0, 2.0, 3.0), (0.0, 0.0, 2.0), 1.0)
    np.testing.assert_allclose(still, turn((0.0, 0.0, 1.0), 2.0)[:3, :3], atol=1e-10)
    # A symmetric top precesses about its angular momentum with L / I1.
    moments, spin = np.array((1.0, 1.0, 2.0)), np.array((0.3, 0.0, 1.0))
    momentum = moments * spin
    rate = float(np.linalg.norm(momentum))
    about = momentum / rate
    axis = np.array(laws.tumble((1.0, 1.0, 2.0), (0.3, 0.0, 1.0), 1.5))[:, 2]
    x, y, z = about.tolist()
    np.testing.assert_allclose(axis, turn((x, y, z), 1.5 * rate)[:3, 2], atol=1e-9)


def test_ways_without_steps_are_the_textbooks():
    assert laws.way(0.5, 2.0, 3.0, 1e-5) == pytest.approx(10.5, rel=1e-4)
    assert laws.way_to_stop(1.0, 4.0, 1e-5) == pytest.approx(1 / 8, rel=1e-4)
    assert laws.pendulum_period(1.0, 0.4) == pytest.approx(
        2 * math.pi / math.sqrt(laws.G) * (1 + 0.4**2 / 16 + 11 * 0.4**4 / 3072), rel=1e-5
    )


# ---- scenes --------------------------------------------------------------------------------------


def test_scenes_are_plausible():
    assert len(SCENES) >= 40
    for scene in SCENES.values():
        assert scene.engines
        assert scene.engines[0] == "voxshell"
        assert scene.measures
        assert all(measure.bar >= 0.0 for measure in scene.measures)
        assert scene.law.endswith(".")
    names = [name_part(name, engine) for name in SCENES for engine in (*ENGINES, "shown")]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize(
    "name",
    [
        *("arch of seven stones", "chain of ten links carries 50 kg", "ring hangs on a hook"),
        *("carton of 2 mm shaken with 14 objects", "gripper holds a mug with 20 N"),
        *("wedge slides away below a block", "brick, mug, brick, mug, stacked"),
    ],
)
def test_bodies_begin_apart(name):
    solids = import_manifold()
    for placement in range(2):
        placed = [
            solids.Manifold(
                solids.Mesh64(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.uint64))
            ).transform(item.pose[:3])
            for item in SCENES[name].stage(placement).items
            if (mesh := item.form.mesh) is not None
        ]
        for a, b in itertools.combinations(placed, 2):
            assert (a ^ b).volume() < 1e-12


def test_parts_elsewhere_are_about_as_large_as_the_mesh():
    for form in (forms.mug(), forms.torus(0.04, 0.01), forms.hook(), forms.spinning_top()):
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        for piece in form.pieces:
            if piece.points is not None:
                points = piece.points
            else:
                half = 0.5 * piece.size[1] * np.array((0.0, 0.0, 1.0))
                points = np.array((half, -half)) if piece.kind == "capsule" else np.zeros((1, 3))
            points = points @ piece.pose[:3, :3].T + piece.pose[:3, 3]
            low, high = np.minimum(low, points.min(axis=0)), np.maximum(high, points.max(axis=0))
        assert (low >= form.vertices.min(axis=0) - 1e-3).all()
        assert (high <= form.vertices.max(axis=0) + 1e-3).all()


def test_settled_body_stands_on_three_points_below_its_center():
    form = forms.named("dented box")
    pose = forms.settled(form)
    heights = form.vertices @ pose[2, :3] + pose[2, 3]
    assert heights.min() == pytest.approx(0.0, abs=1e-9)
    assert (heights < 1e-6).sum() >= 3
    center = pose[:3, :3] @ forms.center_of(form) + pose[:3, 3]
    np.testing.assert_allclose(center[:2], 0.0, atol=1e-9)


def test_gap_to_the_terrain_is_zero_at_its_vertices():
    top = make_body("terrain 5 m").vertices[: 101**2]
    inside = top[(np.abs(top[:, :2]) < 2.49).all(axis=1)]
    np.testing.assert_allclose(drops.gap_to_terrain(inside), 0.0, atol=1e-9)
    np.testing.assert_allclose(
        drops.gap_to_terrain(inside + np.array((0.0, 0.0, 0.3))), 0.3, atol=1e-9
    )


def test_a_turn_about_the_normal_is_no_tipping():
    scene = SCENES["tall box slides, does not tip"]
    stage = scene.stage(1)
    start = stage.items[1].pose
    ramp = np.eye(4)
    ramp[:3, :3] = stage.world_from_ramp
    about_normal = np.array([ramp @ turn((0.0, 0.0, 1.0), a) @ ramp.T @ start for a in (0.0, 1.0)])
    across = np.array([ramp @ turn((0.0, 1.0, 0.0), a) @ ramp.T @ start for a in (0.0, 1.0)])
    still = {"body": np.zeros((2, 3))}
    upright = scene.measures[0].value
    assert upright(Track(stage, 0.005, {"body": about_normal}, still, still)) == 1.0
    assert upright(Track(stage, 0.005, {"body": across}, still, still)) == 0.0


def test_placements_differ_and_the_first_is_straight():
    assert heading(0) == 0.0
    poses = [SCENES["mug on a table"].stage(i).items[1].pose for i in range(4)]
    assert all(not np.allclose(a, b) for a, b in itertools.combinations(poses, 2))


# ---- plan and settings ---------------------------------------------------------------------------


def test_plan_has_a_part_a_scene_and_engine_that_is_there(monkeypatch):
    monkeypatch.setattr(study, "is_installed", lambda engine: engine != "mujoco")
    parts = plan(EverydaySettings(scenes=("cube stops, plane", "cradle of five balls")))
    assert [part.name for part in parts] == [
        "cube-stops-plane-voxshell",
        "cube-stops-plane-bullet",
        "cradle-of-five-balls-voxshell",
        "cradle-of-five-balls-bullet",
        "cradle-of-five-balls-shown",
    ]
    assert not any(part.timed for part in parts)


@pytest.mark.parametrize(
    "wrong",
    [{"scenes": ("cube stpos",)}, {"engines": ("box2d",)}, {"placements": 0}, {"longest": 0.0}],
)
def test_wrong_settings_are_refused(wrong):
    with pytest.raises(SettingsError, match=next(iter(wrong))):
        EverydaySettings(**wrong)


def test_held_out_scenes_are_last_and_marked():
    assert all(scene.held_out for scene in held_out.SCENES)
    marked = [scene.held_out for scene in SCENES.values()]
    assert marked == sorted(marked)


# ---- report --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def results():
    return {part.name: compute_part(part).tables for part in plan(SMALL)}


def test_rows_tell_value_truth_error_bar_and_verdict(results):
    rows = {row.below_heading: row for row in EVERYDAY.reduce(SMALL, results)}
    stop = rows["cube stops, plane, stopping distance"]
    assert stop.bar == "<= 5 %"
    assert stop.unit == "% off"
    assert stop.holds is (stop.here <= 5.0)
    for word in ("worst", " of ", "200 Hz", "30 Hz", "Bullet's own shapes"):
        assert word in stop.note
    ours = rows["measures within their limits, voxshell"]
    held = sum(bool(row.holds) for row in rows.values() if row.group)
    assert (ours.here, ours.unit) == (held, "of 5")
    # Half a period fits into 0.6 s, and a period needs three zeros.
    assert rows["pendulum on a hinge, period"].holds is False
    assert rows["held-out measures within their limits"].holds is None


def test_held_out_rows_are_counted(results, monkeypatch):
    name = "cradle of five balls"
    monkeypatch.setitem(SCENES, name, replace(SCENES[name], held_out=True))
    rows = EVERYDAY.reduce(SMALL, results)
    counted = next(row for row in rows if row.quantity.startswith("held-out"))
    assert counted.unit == "of 2"
    assert sum(row.quantity.endswith(", held out") for row in rows) == 2


def test_figures_tables_and_replays_are_written(results, tmp_path):
    pictures = EVERYDAY.draw(SMALL, results, tmp_path)
    assert {picture.path for picture in pictures} == {
        "errors.png",
        "replay-cradle-of-five-balls.html",
    }
    assert all((tmp_path / picture.path).stat().st_size > 1000 for picture in pictures)
    table = (tmp_path / TABLE).read_text()
    # A heading for the counts and for each of three groups, two engines, five measures.
    assert table.count("\n| ") == 4 + 2 + 5
    assert "| engine | 200 Hz | 30 Hz | all rates |" in table
    assert "| cube stops, plane: stopping distance | <= 5 % |" in table


def test_verdict_says_whether_another_engine_is_better():
    measure = Measure("way", "m", lambda _: 0.0, lambda _: 0.0, 0.1)

    def judge(ours: float, other: float) -> str:
        worst: dict[Engine, Worst] = {
            "voxshell": Worst(ours, 0.0, 0.0, 200.0, 0),
            "bullet": Worst(other, 0.0, 0.0, 200.0, 0),
        }
        return Line(SCENES["cube stops, plane"], measure, worst, {}).verdict

    assert judge(0.1, 0.0) == "holds"
    assert judge(0.2, 0.3) == "falls short, best"
    assert judge(0.3, 0.2) == "falls short"
    assert judge(math.inf, math.inf) == "falls short"


def test_errors_read_as_the_bar_is_meant():
    way = Measure("way", "mm", lambda _: 0.0, lambda _: 0.0, 1e-4, scale=1e3)
    assert format_error(way, 0.00025) == "0.25 mm"
    assert format_error(way, math.inf) == "no value"
    assert format_error(way, 123.0) == "> 10 m"
    assert format_error(replace(way, relative=True), 0.05) == "5 %"
    assert format_error(replace(way, relative=True), 54.0) == "> 1,000 %"
    assert format_error(replace(way, bar=0.0, unit="of 40"), 2.0) == "2 off"
    yes = Measure("stands", "", lambda _: 1.0, lambda _: 1.0, 0.0)
    assert (format_error(yes, 0.0), format_error(yes, 1.0)) == ("right", "wrong")
