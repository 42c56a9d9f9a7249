"""The study of geometry, small: its truth against closed forms and other judges, and its verdicts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import trimesh
import voxshell as vx
from manifold3d import Manifold, Mesh64
from voxshell.errors import SettingsError
from voxshell.experiments import geometry
from voxshell.experiments.first_touch import find_first_touch
from voxshell.experiments.geometry import GeometrySettings, Pair, name_pair, name_scene
from voxshell.experiments.part import compute_part
from voxshell.experiments.report.geometry import GEOMETRY
from voxshell.experiments.surface_truth import Surface, measure_angle
from voxshell.meshes import Mesh
from voxshell.scenes.geometry import PAIRS, SCENES, random_rotation
from voxshell.scenes.geometry_bodies import make_body

DOWN = np.array([0.0, 0.0, -1.0])
SMALL = GeometrySettings(
    scenes=("ball on slab 0.3 m", "crossed knives", "ring on peg, sideways", "cup on cup"),
    poses=2,
    rotations=1,
    retriangulated=1,
    copied_poses=1,
    judged=6,
    pairs=1,
    pair_poses=40,
    optimized=6,
    builds=2,
)


def lift(height: float, rotation: np.ndarray | None = None) -> np.ndarray:
    pose = np.eye(4)
    pose[2, 3] = height
    if rotation is not None:
        pose[:3, :3] = rotation
    return pose


# ---- the truth -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("a", "b", "turn", "height"),
    [
        ("cube 50 mm", "slab 1 m", (0.0, 0.0, 0.0), 0.025),
        ("cube 50 mm", "slab 5 m", (45.0, 0.0, 0.0), 0.025 * np.sqrt(2.0)),
        # On a corner, the diagonal is upright.
        (
            "cube 50 mm",
            "slab 1 m",
            (45.0, np.degrees(np.arctan(np.sqrt(0.5))), 0.0),
            0.025 * np.sqrt(3.0),
        ),
        ("ball 30 mm", "slab 2 m", (0.0, 0.0, 0.0), 0.015),
        ("pyramid", "slab 1 m", (0.0, 0.0, 33.0), 0.0),
        # Only edges cross: no corner of either is over a face of the other.
        ("blade", "blade", (180.0, 0.0, 77.0), 0.0),
        ("bar 1 m x 10 mm", "bar 1 m x 10 mm", (0.0, 0.0, 50.0), 0.01),
    ],
)
def test_first_touch_is_the_closed_form(a, b, turn, height):
    from voxshell.scenes.geometry import turn_about

    pose = lift(0.4, turn_about(np.radians(turn)))
    touch = find_first_touch(make_body(a), make_body(b), pose, DOWN)
    assert touch == pytest.approx(0.4 - height, abs=1e-12)


def test_first_touch_from_inside_a_hole_is_the_play():
    ring, peg = make_body("ring"), make_body("peg")
    along = np.array([1.0, 0.0, 0.0])
    assert find_first_touch(ring, peg, np.eye(4), along, from_here=True) == pytest.approx(5e-4)
    # From far away the ring's outside meets the foot or the pin before.
    assert find_first_touch(ring, peg, np.eye(4), along) < -0.02


def test_first_touch_of_bodies_that_pass_each_other_is_never():
    cube = make_body("cube 50 mm")
    beside = lift(0.3)
    beside[0, 3] = 0.051
    assert find_first_touch(cube, cube, beside, DOWN) == np.inf


@pytest.mark.parametrize("name", SCENES)
def test_first_touch_is_where_the_solids_begin_to_overlap(name):
    scene = SCENES[name]
    solids = [
        Manifold(Mesh64(np.array(m.vertices), np.array(m.faces, dtype=np.uint64)))
        for m in (make_body(scene.a), make_body(scene.b))
    ]
    pose = scene.place(1)
    touch = find_first_touch(
        make_body(scene.a),
        make_body(scene.b),
        pose,
        scene.direction,
        from_here=scene.start == "here",
    )
    for offset, overlaps in ((-1e-6, False), (1e-4, True)):
        moved = geometry.move(pose, scene.direction, touch + offset)
        common = solids[0].transform(moved[:3]) ^ solids[1]
        assert (common.volume() > 0.0) == overlaps, offset


def test_nearest_places_are_those_of_trimesh():
    mesh = make_body("dented box")
    surface = Surface(mesh)
    places = np.random.default_rng(2).uniform(-0.06, 0.06, (50, 3))
    solid = trimesh.Trimesh(*mesh, process=False)
    _, distances, _ = trimesh.proximity.closest_point(solid, places)
    found = [surface.measure_distance(place) for place in places]
    assert found == pytest.approx(distances, abs=1e-12)


def test_normals_of_a_cube_are_its_faces_edges_and_corners():
    surface = Surface(make_body("cube 50 mm"))
    up, side = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])

    def find_angle(place, normal):
        _, cones = surface.find_nearest(np.array(place))
        return np.degrees(
            min(measure_angle(normal / np.linalg.norm(normal), each) for each in cones)
        )

    assert find_angle((0.001, 0.002, 0.02), up) == pytest.approx(0.0)
    assert find_angle((0.001, 0.002, 0.02), side) == pytest.approx(90.0)
    # Outside an edge all between both faces' normals are right; inside, in its plane of symmetry, these two.
    assert find_angle((0.026, 0.0, 0.026), up + 0.3 * side) == pytest.approx(0.0, abs=1e-6)
    assert find_angle((0.02, 0.0, 0.02), side) == pytest.approx(0.0, abs=1e-6)
    assert find_angle((0.02, 0.0, 0.02), up + side) == pytest.approx(45.0)
    entry = surface.find_entry(np.array([0.001, 0.002, 0.0]), up)
    assert entry is not None
    assert entry == pytest.approx(up)
    assert surface.find_entry(np.array([0.2, 0.0, 0.0]), up) is None


# ---- measures ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def results():
    return {part.name: compute_part(part).tables for part in GEOMETRY.plan(SMALL)}


def test_copies_and_orders_are_asked_about_the_same_pose():
    rng = np.random.default_rng(4)
    a, b = "dented box", "tetrahedron"
    pairs = [Pair(a, b, copy) for copy in (0, 1, geometry.RETRIANGULATED)]
    pose = lift(0.07, random_rotation(rng))
    told = [pair.ask(vx.distance, pose, order) for pair in pairs for order in (0, 1)]
    # Two voxels of the larger.
    assert np.ptp([each.distance for each in told]) < 0.0016
    assert np.ptp([each.distance for each in told[::2]]) > 0.0
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
    assert pair.ask(vx.collide, geometry.move(pose, scene.direction, first), order)
    assert not pair.ask(vx.collide, geometry.move(pose, scene.direction, first - 2e-7), order)


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
        "two bodies in the same pose, no contact",
        f"answers wrong beyond the stated bounds, {' and '.join(PAIRS[0])}",
        f"stated bounds at most, {' and '.join(PAIRS[0])}",
        f"stated bound over the worst overlap that is denied, {' and '.join(PAIRS[0])}",
        "default builds beyond 3 s or 64 MB without a warning",
    ):
        assert isinstance(rows[quantity].holds, bool), quantity
    pictures = GEOMETRY.draw(SMALL, results, tmp_path)
    assert all((tmp_path / picture.path).is_file() for picture in pictures)


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


def test_overlaps_that_are_denied_are_found_and_made_worse(monkeypatch):
    settings = replace(SMALL, pair_poses=60, optimized=12)

    def deny_shallow(*arguments: object, **options: object) -> bool:
        return vx.distance(*arguments, **options).distance < -0.002

    monkeypatch.setattr(geometry, "collide", deny_shallow)
    tables = geometry.measure_pair(settings, PAIRS.index(("star", "dented box")))
    worst, poses = tables["worst"], tables["poses"]
    assert ((poses["overlaps"] == 1.0) & (poses["yes"] == 0.0)).sum() > 10
    assert (worst["random"] > 1e-4).all()
    assert (worst["optimized"] >= worst["random"]).all()
    assert (worst["optimized"] > 1.01 * worst["random"]).any()


def test_wrong_settings_are_refused():
    with pytest.raises(SettingsError, match="scenes: unknown scene 'tea party'"):
        GeometrySettings(scenes=("tea party",))
    with pytest.raises(SettingsError, match="retriangulated"):
        GeometrySettings(retriangulated=2)


def test_a_mesh_of_no_area_is_left_out_of_the_surface():
    mesh = make_body("cube 50 mm")
    faces = np.concatenate([mesh.faces, [[0, 0, 1]]]).astype(np.uint32)
    assert len(Surface(Mesh(mesh.vertices, faces)).normals) == 12
