from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
import voxshell as vx
from trimesh.transformations import (
    quaternion_from_matrix,
    quaternion_matrix,
    quaternion_slerp,
    random_rotation_matrix,
    rotation_matrix,
    translation_matrix,
)
from voxshell.model import shape_shells

COUNT = 60


def moved(rotation: np.ndarray, translation: object) -> np.ndarray:
    pose = rotation.copy()
    pose[:3, 3] = translation
    return pose


@pytest.fixture(scope="module")
def torus() -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.torus(0.08, 0.025))


@pytest.fixture(scope="module")
def box() -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.box((0.12, 0.05, 0.02)))


@pytest.fixture(scope="module")
def motions() -> tuple[np.ndarray, np.ndarray]:
    """Of the box, from beside the torus to its other side, or into it."""
    rng = np.random.default_rng(7)
    starts, ends = [], []
    for _ in range(COUNT):
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        start = random_rotation_matrix(rng.random(3))
        end = rotation_matrix(rng.uniform(0.0, math.pi), rng.normal(size=3)) @ start
        starts.append(moved(start, rng.uniform(0.18, 0.3) * direction))
        ends.append(moved(end, rng.uniform(-0.1, 0.1, 3) - rng.uniform(-0.2, 0.3) * direction))
    return np.array(starts), np.array(ends)


def test_nothing_touches_before_and_bodies_are_near_then(torus, box, motions):
    tolerance = 2e-5
    rng = np.random.default_rng(8)
    touching = 0
    for start, end in zip(*motions, strict=True):
        found = vx.sweep(box, torus, start, a_end=end, tolerance=tolerance)
        before = found.fraction * np.concatenate(
            [rng.random(100), 1.0 - 10.0 ** rng.uniform(-7.0, 0.0, 100)]
        )
        assert not vx.collide_batch(box, torus, vx.interpolate_pose(start, end, before)).any()
        np.testing.assert_allclose(
            found.a_pose, vx.interpolate_pose(start, end, found.fraction), atol=1e-15
        )
        np.testing.assert_array_equal(found.b_pose, np.eye(4))
        if not found.touches:
            assert found.fraction == 1.0
            assert found.shell is None
            assert math.isinf(found.distance)
            assert np.isnan([found.point_a, found.point_b, found.normal]).all()
            continue
        touching += 1
        assert 0.0 <= found.distance < 3.0 * tolerance
        apart = found.point_a - found.point_b
        np.testing.assert_allclose(apart, found.distance * found.normal, atol=1e-7)
        near = vx.distance(box, torus, found.a_pose, max_distance=1e-3)
        assert near.distance == pytest.approx(found.distance, abs=1e-6)
    assert COUNT // 3 < touching < COUNT


def test_order_and_frame_do_not_matter(torus, box, motions):
    """The same relative motion: of a, of b in the opposite sense, or of both carried along."""
    for start, end in list(zip(*motions, strict=True))[:20]:
        one = vx.sweep(box, torus, start, a_end=end)
        other = vx.sweep(torus, box, b_pose=start, b_end=end)
        assert other.touches == one.touches
        assert other.fraction == pytest.approx(one.fraction, abs=1e-3)
        if one.touches:
            np.testing.assert_allclose(other.point_a, one.point_b, atol=5e-4)
        carried = translation_matrix((0.3, -0.2, 0.1))
        ahead = carried @ end
        both = vx.sweep(box, torus, start, a_end=ahead, b_end=carried)
        assert both.touches == one.touches
        assert both.fraction == pytest.approx(one.fraction, abs=1e-3)


@pytest.mark.parametrize("size", [0.005, 0.1, 5.0])
def test_a_ball_touches_where_its_middle_is_a_radius_away(size):
    radius = 0.5 * size
    mesh = trimesh.creation.icosphere(subdivisions=4, radius=radius)
    ball = vx.Model.from_mesh(mesh)
    start, end = translation_matrix((0, 0, 3 * size)), translation_matrix((size, 0, -3 * size))
    down = vx.sweep(ball, vx.Plane(), start, a_end=end)
    assert down.a_pose[2, 3] == pytest.approx(radius, abs=3e-3 * size)
    np.testing.assert_allclose(down.normal, (0, 0, 1), atol=1e-6)

    # About an axis, by half a turn, onto a ball that stands at a quarter.
    arm = vx.Model.from_mesh(mesh.copy().apply_translation((2 * size, 0, 0)))
    around = vx.sweep(
        arm,
        vx.Sphere(radius=radius),
        a_end=rotation_matrix(math.pi, (0, 0, 1)),
        b_pose=translation_matrix((0, 2 * size, 0)),
    )
    angle = math.pi / 2 - 2 * math.asin(0.25)
    assert around.fraction * math.pi == pytest.approx(angle, abs=3e-3)


def test_a_thin_plate_is_hit_at_any_speed(box):
    plate = vx.Model.from_mesh(trimesh.creation.box((0.3, 0.3, 0.0005)))
    for way in (0.1, 10.0, 1000.0):
        shot = vx.sweep(
            box,
            plate,
            translation_matrix((0, 0, 0.05)),
            a_end=translation_matrix((0, 0, 0.05 - way)),
        )
        assert shot.touches
        # The box is 2 cm thick.
        assert shot.fraction * way == pytest.approx(0.05 - 0.01 - 0.00025, abs=1e-4)
        assert not vx.collide(box, plate, translation_matrix((0, 0, 0.05 - way)))


@pytest.fixture(scope="module")
def peg_and_plate():
    peg = trimesh.creation.cylinder(radius=0.0098, height=0.05, sections=256)
    plate = trimesh.creation.annulus(r_min=0.01, r_max=0.03, height=0.02, sections=256)
    return vx.Model.from_mesh(peg), vx.Model.from_mesh(plate)


@pytest.mark.parametrize(("aside", "touches"), [(0.0, False), (0.00015, False), (0.00025, True)])
def test_a_peg_passes_through_a_hole_with_two_tenths_of_play(peg_and_plate, aside, touches):
    found = vx.sweep(
        *peg_and_plate,
        translation_matrix((aside, 0, 0.05)),
        a_end=translation_matrix((aside, 0, -0.05)),
        tolerance=1e-5,
    )
    assert found.touches == touches
    if touches:
        assert found.a_pose[2, 3] == pytest.approx(0.035, abs=1e-4)


def test_margin_keeps_away_or_lets_in(box):
    start, end = translation_matrix((0, 0, 0.1)), translation_matrix((0, 0, 0.0))
    heights = [
        vx.sweep(box, vx.Plane(), start, a_end=end, margin=margin).a_pose[2, 3]
        for margin in (0.02, 0.0, -0.005)
    ]
    np.testing.assert_allclose(heights, (0.03, 0.01, 0.005), atol=3e-5)


@pytest.mark.parametrize("uniform", [False, True])
@pytest.mark.parametrize("margin", [0.002, 0.005, 0.01, 0.02])
def test_bodies_that_pass_beyond_the_margin_do_not_touch(uniform, margin):
    """Cubes of 10 cm, face beside face; fields reach 25 mm around them."""
    options = {"voxel_size": 0.002} if uniform else {}
    cube = vx.Model.from_mesh(trimesh.creation.box((0.1, 0.1, 0.1)), padding=0.025, **options)
    for gap, touches in ((margin - 3e-4, True), (margin + 5e-4, False)):
        found = vx.sweep(
            cube,
            cube,
            translation_matrix((-0.4, 0.1 + gap, 0.003)),
            a_end=translation_matrix((0.4, 0.1 + gap, 0.003)),
            margin=margin,
        )
        assert found.touches == touches
        if touches:
            # Corners come within the margin a little before faces are side by side.
            along = 0.1 + math.sqrt(margin**2 - gap**2)
            assert found.a_pose[0, 3] == pytest.approx(-along, abs=2e-3)


@pytest.mark.parametrize("margin", [0.03, 0.05])
def test_a_margin_beyond_the_grid_stops_no_earlier_than_the_grid_reaches(margin):
    cube = vx.Model.from_mesh(trimesh.creation.box((0.1, 0.1, 0.1)))
    reach = 24 * cube.field.voxel_size  # 16 voxels, filled up to bricks of 8
    assert reach < margin
    gap = margin + reach
    for aside, touches in ((margin - 1e-3, True), (gap, False)):
        found = vx.sweep(
            cube,
            cube,
            translation_matrix((-0.4, 0.1 + aside, 0.003)),
            a_end=translation_matrix((0.4, 0.1 + aside, 0.003)),
            margin=margin,
        )
        assert found.touches == touches


def test_the_shell_of_fewest_points_misses_nothing_on_the_way():
    """Which shell that is may change from pose to pose."""
    plate = vx.Model.from_mesh(trimesh.creation.box((0.3, 0.3, 0.002)))
    block = vx.Model.from_mesh(trimesh.creation.box((0.2, 0.1, 0.05)))
    rng = np.random.default_rng(11)
    for _ in range(100):
        start = moved(random_rotation_matrix(rng.random(3)), rng.uniform(-0.25, 0.25, 3))
        end = moved(random_rotation_matrix(rng.random(3)), rng.uniform(-0.25, 0.25, 3))
        found = vx.sweep(block, plate, start, a_end=end, shell="fewest")
        before = found.fraction * (1.0 - 10.0 ** rng.uniform(-5.0, 0.0, 100))
        poses = vx.interpolate_pose(start, end, before)
        touches = vx.collide_batch(block, plate, poses, shell="fewest")
        assert found.fraction == 0.0 or not touches.any()


@pytest.mark.parametrize("radius", [1e-5, 4e-4, 0.01])
def test_shapes_may_be_thin_and_are_made_ready_once(box, radius):
    for make in (vx.Cylinder, vx.Cone, vx.Capsule):
        down = vx.sweep(
            make(radius, 0.02),
            box,
            translation_matrix((0, 0, 0.1)),
            a_end=translation_matrix((0, 0, 0)),
        )
        reach = 0.01 + (radius if make is vx.Capsule else 0.0)
        assert down.a_pose[2, 3] == pytest.approx(0.01 + reach, abs=2e-4)
    assert shape_shells.find_shell(vx.Cone(radius, 0.02)) is shape_shells.find_shell(
        vx.Cone(radius, 0.02)
    )


def test_plates_come_to_lie_on_each_other():
    """Flush: all along their edges at the same time."""
    plate = vx.Model.from_mesh(trimesh.creation.box((0.3, 0.3, 0.001)))
    found = vx.sweep(
        plate,
        plate,
        translation_matrix((0.01, 0.02, 0.1)),
        a_end=translation_matrix((0.01, 0.02, 0)),
    )
    assert found.a_pose[2, 3] == pytest.approx(0.001, abs=5e-4)


def test_what_overlaps_at_the_start_touches_at_once(torus, box):
    inside = vx.sweep(
        box, torus, translation_matrix((0.08, 0, 0)), a_end=translation_matrix((1, 0, 0))
    )
    assert (inside.touches, inside.fraction) == (True, 0.0)
    assert inside.distance < -0.009
    # One that lies wholly inside the other, where no surfaces meet.
    ball = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.2))
    for shell in ("auto", "fewest", "both"):
        swallowed = vx.sweep(box, ball, a_end=translation_matrix((1, 0, 0)), shell=shell)
        assert (swallowed.touches, swallowed.fraction) == (True, 0.0), shell
    still = vx.sweep(box, torus, translation_matrix((0, 0, 0.5)))
    assert (still.touches, still.fraction) == (False, 1.0)


@pytest.mark.parametrize("shell", ["auto", "fewest", "a", "b", "both"])
def test_a_batch_is_its_motions_one_by_one(torus, box, motions, shell):
    starts, ends = motions
    batches = [
        vx.sweep_batch(box, torus, starts, a_ends=ends, shell=shell, threads=threads)
        for threads in (1, 3)
    ]
    scratch = vx.QueryScratch()
    singles = [
        vx.sweep(box, torus, start, a_end=end, shell=shell, scratch=scratch)
        for start, end in zip(starts, ends, strict=True)
    ]
    for batch in batches:
        assert len(batch) == COUNT
        assert batch.touches.any()
        for name, one in (
            ("fractions", "fraction"),
            ("touches", "touches"),
            ("distances", "distance"),
            ("points_a", "point_a"),
            ("points_b", "point_b"),
            ("normals", "normal"),
            ("a_poses", "a_pose"),
            ("b_poses", "b_pose"),
        ):
            expected = np.array([getattr(single, one) for single in singles])
            np.testing.assert_array_equal(getattr(batch, name), expected)
        assert batch.shells.tolist() == [single.shell or "" for single in singles]


def test_a_batch_takes_single_poses_and_none(torus, box, motions):
    starts, ends = motions
    fan = vx.sweep_batch(box, torus, starts[0], a_ends=ends)
    assert len(fan) == COUNT
    assert fan.fractions[5] == vx.sweep(box, torus, starts[0], a_end=ends[5]).fraction
    assert len(vx.sweep_batch(box, torus, starts, b_poses=translation_matrix((9, 0, 0)))) == COUNT
    assert len(vx.sweep_batch(box, torus, np.empty((0, 4, 4)))) == 0
    assert vx.sweep_batch(box, torus).fractions.tolist() == [0.0]
    seen = []
    vx.sweep_batch(box, torus, starts, a_ends=ends, progress=lambda *args: seen.append(args))
    assert seen
    assert {stage for stage, _ in seen} == {"sweeps"}


def test_poses_between_turn_steadily():
    rng = np.random.default_rng(9)
    for _ in range(50):
        start = moved(random_rotation_matrix(rng.random(3)), rng.normal(size=3))
        end = moved(random_rotation_matrix(rng.random(3)), rng.normal(size=3))
        fractions = rng.random(7)
        poses = vx.interpolate_pose(start, end, fractions)
        assert poses.shape == (7, 4, 4)
        for pose, fraction in zip(poses, fractions, strict=True):
            quaternion = quaternion_slerp(
                quaternion_from_matrix(start), quaternion_from_matrix(end), fraction
            )
            expected = moved(
                quaternion_matrix(quaternion),
                (1 - fraction) * start[:3, 3] + fraction * end[:3, 3],
            )
            np.testing.assert_allclose(pose, expected, atol=1e-9)
    np.testing.assert_allclose(vx.interpolate_pose(None, end, 1), end, atol=1e-14)
    # Of half a turn, the direction about the axis whose first component is positive.
    quarter = vx.interpolate_pose(None, np.diag([-1.0, -1.0, 1.0, 1.0]), 0.5)
    np.testing.assert_allclose(quarter, rotation_matrix(math.pi / 2, (0, 0, 1)), atol=1e-12)


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"tolerance": 0.0}, vx.SettingsError, "tolerance must be above 0"),
        ({"tolerance": math.nan}, vx.SettingsError, "tolerance must be finite"),
        ({"margin": math.inf}, vx.SettingsError, "margin must be finite"),
        ({"a_end": np.ones((4, 4))}, vx.PoseError, "a_end"),
        ({"b_end": np.eye(3)}, vx.PoseError, "b_end must be"),
        ({"shell": "c"}, vx.SettingsError, "shell must be"),
        ({"scratch": 3}, vx.InputTypeError, "scratch must be"),
    ],
)
def test_wrong_arguments_are_named(box, options, error, message):
    with pytest.raises(error, match=message):
        vx.sweep(box, vx.Plane(), **options)


def test_wrong_batches_are_named(box, motions):
    starts, ends = motions
    with pytest.raises(
        vx.SettingsError,
        match=r"^a_poses and a_ends must have the same number.*they have 60 and 59$",
    ):
        vx.sweep_batch(box, vx.Plane(), starts, a_ends=ends[1:])
    bad = ends.copy()
    bad[7, 3, 0] = 1.0
    with pytest.raises(vx.PoseError, match=r"a_ends\[7\]"):
        vx.sweep_batch(box, vx.Plane(), starts, a_ends=bad)
    with pytest.raises(vx.SettingsError, match="model"):
        vx.sweep(vx.Plane(), vx.Sphere(radius=1.0))
    for fractions in (math.nan, 1e5, ["a"], [[1, 2], [3]], [[0.5]]):
        with pytest.raises(vx.SettingsError, match="fractions must be"):
            vx.interpolate_pose(None, None, fractions)


def test_what_reports_progress_must_be_callable():
    ball = vx.Sphere(0.1)
    with pytest.raises(vx.InputTypeError, match="progress must be callable, not float"):
        vx.sweep_batch(ball, ball, progress=1.0)
