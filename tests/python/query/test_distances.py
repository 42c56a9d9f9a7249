from __future__ import annotations

import threading
from functools import cache

import numpy as np
import pytest
import trimesh
import voxshell as vx
from poses import at, turned


@pytest.mark.parametrize("height", [0.5, 0.2, 0.1001, 0.1, 0.05, -0.3])
def test_a_ball_and_the_ground(ball: vx.Model, height: float):
    nearest = vx.distance(ball, vx.Plane(), at(3.0, 4.0, height))
    # The ball has facets, whose lowest corner is at its pole.
    np.testing.assert_allclose(nearest.distance, height - 0.1, atol=1e-6)
    np.testing.assert_allclose(nearest.point_a, [3.0, 4.0, height - 0.1], atol=5e-3)
    np.testing.assert_allclose(nearest.point_b[2], 0.0, atol=1e-8)
    np.testing.assert_array_equal(nearest.normal, [0.0, 0.0, 1.0])
    assert nearest.shell == "a"


@pytest.mark.parametrize("gap", [0.3, 0.001, -0.01, -0.05])
@pytest.mark.parametrize("shell", ["auto", "fewest", "a", "b", "both"])
def test_two_balls(ball: vx.Model, gap: float, shell: str):
    direction = np.array([2.0, -1.0, 2.0]) / 3.0
    nearest = vx.distance(ball, ball, at(*((0.2 + gap) * direction)), shell=shell)
    assert gap - 2e-3 <= nearest.distance <= gap + np.sqrt(3.0) * ball.shell.spacing + 1e-3
    assert nearest.normal @ direction > 0.95
    if shell in ("a", "b"):
        assert nearest.shell == shell


def test_the_parts_fit_together(ball: vx.Model, cube: vx.Model):
    rng = np.random.default_rng(1)
    overlapping = 0
    for _ in range(200):
        axis = tuple(rng.normal(size=3))
        pose = at(*rng.uniform(-0.8, 0.8, 3)) @ turned(axis, rng.uniform(0, 3))
        other = at(*rng.uniform(-0.1, 0.1, 3)) @ turned(axis, 1.0)
        for shell in ("auto", "a", "b", "both"):
            nearest = vx.distance(ball, cube, pose, other, shell=shell)
            np.testing.assert_allclose(np.linalg.norm(nearest.normal), 1.0, atol=1e-6)
            np.testing.assert_allclose(
                nearest.point_a - nearest.point_b, nearest.distance * nearest.normal, atol=1e-14
            )
            assert (nearest.distance < 0.0) == vx.collide(ball, cube, pose, other, shell=shell)
            if nearest.distance < 0.0:
                overlapping += 1
                contacts = vx.contacts(ball, cube, pose, other, shell=shell)
                deepest = contacts.depths.argmax()
                assert -nearest.distance == contacts.depths[deepest]
                assert nearest.shell == contacts.shells[deepest]
                np.testing.assert_array_equal(nearest.point_a, contacts.points_a[deepest])
                np.testing.assert_array_equal(nearest.normal, contacts.normals[deepest])
    assert overlapping > 200


def test_swapped_bodies_mirror_the_answer(ball: vx.Model, cube: vx.Model):
    pose, other = at(0.05, 0.02, 0.8) @ turned((1, 2, 3), 0.7), turned((3, 1, 2), 0.1)
    forth = vx.distance(ball, cube, pose, other)
    back = vx.distance(cube, ball, other, pose)
    assert forth.distance == back.distance > 0.1
    np.testing.assert_array_equal(forth.point_a, back.point_b)
    np.testing.assert_array_equal(forth.normal, -back.normal)
    assert {forth.shell, back.shell} == {"a", "b"}


def test_of_both_shells_the_nearer_counts(ball: vx.Model, cube: vx.Model):
    pose = at(0.05, 0.02, 0.8)
    one, other = (vx.distance(ball, cube, pose, shell=shell) for shell in ("a", "b"))
    both = vx.distance(ball, cube, pose, shell="both")
    assert both.distance == min(one.distance, other.distance) != max(one.distance, other.distance)


def test_nothing_nearer_than_asked_for_is_infinitely_far(ball: vx.Model):
    pose = at(z=0.2)
    exactly = vx.distance(ball, vx.Plane(), pose).distance
    for max_distance in (0.05, -1.0, 0.0, exactly):
        nearest = vx.distance(ball, vx.Plane(), pose, max_distance=max_distance)
        assert nearest.distance == np.inf
        assert nearest.shell is None
        for array in (nearest.point_a, nearest.point_b, nearest.normal):
            assert array.shape == (3,)
            assert np.isnan(array).all()
    beyond = float(np.nextafter(np.float32(exactly), np.float32(1)))
    assert vx.distance(ball, vx.Plane(), pose, max_distance=beyond).distance == exactly


def test_far_apart_it_is_the_distance_of_the_origins(ball: vx.Model, cube: vx.Model):
    for far in (1e3, 1e6, 1e12, 1e15):
        for other in (cube, vx.Box((1, 1, 1)), vx.Sphere(1.0), vx.Plane()):
            nearest = vx.distance(ball, other, at(z=far))
            np.testing.assert_allclose(nearest.distance, far, rtol=0.01)


@pytest.mark.parametrize("shell", ["auto", "a", "b", "both"])
@pytest.mark.parametrize("threads", [None, 1, 3])
def test_a_batch_of_distances_is_its_poses_one_by_one(
    ball: vx.Model, cube: vx.Model, shell: str, threads: int | None
):
    rng = np.random.default_rng(5)
    poses = np.array([
        at(*rng.uniform(-0.9, 0.9, 3)) @ turned(tuple(rng.normal(size=3)), rng.uniform(0, 3))
        for _ in range(150)
    ])  # fmt: skip
    other = at(0.02, 0.01, 0.0)
    for options in ({}, {"max_distance": 0.1}):
        found = vx.distance_batch(ball, cube, poses, other, shell=shell, threads=threads, **options)
        alone = [
            vx.distance(ball, cube, pose, other, shell=shell, **options).distance for pose in poses
        ]
        assert found.dtype == np.float64
        np.testing.assert_array_equal(found, alone)
    assert 20 < np.isinf(found).sum() < 130
    assert 10 < (found < 0.0).sum() < 100


def test_a_batch_of_distances_of_one_pose_or_none(ball: vx.Model):
    assert vx.distance_batch(ball, vx.Plane(), np.empty((0, 4, 4))).shape == (0,)
    pose = at(z=0.3)
    alone = vx.distance(ball, vx.Plane(), pose).distance
    for one in (pose, (0, 0, 0.3), pose[None]):
        np.testing.assert_array_equal(vx.distance_batch(ball, vx.Plane(), one), [alone])
    three = vx.distance_batch(ball, vx.Plane(), pose, np.tile(np.eye(4), (3, 1, 1)))
    np.testing.assert_array_equal(three, [alone] * 3)
    nearly = pose.copy()
    nearly[0, 0] = 1.0 + 4e-4  # is corrected, as everywhere
    mended = vx.distance_batch(ball, vx.Plane(), [nearly])
    assert mended[0] == vx.distance(ball, vx.Plane(), nearly).distance


def test_a_stopped_batch_of_distances_leaves_no_thread_at_work(ball: vx.Model, cube: vx.Model):
    poses = np.tile(at(z=0.65), (200_000, 1, 1))
    before = threading.active_count()
    said: list[float] = []

    def stop(stage: str, fraction: float) -> None:
        assert stage == "distances"
        said.append(fraction)
        if len(said) == 3:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        vx.distance_batch(ball, cube, poses, shell="both", progress=stop)
    assert 0.0 <= said[0] < said[-1] < 1.0
    assert threading.active_count() == before


@pytest.mark.parametrize("wrong", [np.nan, -np.inf, 1e300, "1", None, [0.1], 1j])
def test_a_wrong_largest_distance_is_refused(ball: vx.Model, wrong):
    with pytest.raises(vx.SettingsError, match="max_distance"):
        vx.distance(ball, vx.Plane(), max_distance=wrong)


def test_infinity_of_any_type_is_taken(ball: vx.Model):
    for infinity in (np.inf, np.float64(np.inf), np.float32(np.inf)):
        assert vx.distance(ball, vx.Plane(), max_distance=infinity).distance < 0.0


def distance_to(half: tuple[float, float, float] | None, points: np.ndarray) -> np.ndarray:
    """Distances of (k, 3) points from a box of half extents, or from a sphere of 0.1 m, both at the origin."""
    if half is None:
        return np.linalg.norm(points, axis=1) - 0.1
    beyond = np.abs(points) - half
    return np.linalg.norm(np.maximum(beyond, 0.0), axis=1) + np.minimum(beyond.max(axis=1), 0.0)


def largest_gap(
    model: vx.Model, half: tuple[float, float, float] | None, points: np.ndarray
) -> float:
    """The bound at the worst of (k, 3) points, body frame: r + D less the root of their squares, and the error of D."""
    field = model.field
    high = field.origin + (np.array(field.shape) - 1) * field.voxel_size
    nearest = np.clip(points, field.origin, high)
    r, d = np.linalg.norm(points - nearest, axis=1), distance_to(half, nearest)
    gaps = np.where(r > 0.0, r + d - np.hypot(r, d), 0.0)
    assert (gaps <= np.minimum(r, np.abs(d)) + 1e-12).all()
    return float((gaps + np.abs(field.sample(nearest) - d)).max())


@cache
def box_or_ball(half: tuple[float, float, float] | None, voxel_size: float | None) -> vx.Model:
    """A box with these half edges, or a sphere of radius 0.1 m but for its facets."""
    sphere = trimesh.creation.icosphere(4, 0.1)
    mesh = sphere if half is None else trimesh.creation.box(2.0 * np.array(half))
    return vx.Model.from_mesh(mesh, voxel_size=voxel_size)


@pytest.mark.parametrize("half", [(0.1, 0.1, 0.1), (0.1, 0.03, 0.01), None])
@pytest.mark.parametrize("voxel_size", [0.005, None])
@pytest.mark.parametrize("times", [1, 3, 10, 30, 100])
def test_far_apart_distances_keep_to_the_stated_bound(half, voxel_size, times: int):
    body, ball = box_or_ball(half, voxel_size), box_or_ball(None, voxel_size)
    facets = 2e-4  # how far the middles of facets are within the sphere
    centers = trimesh.creation.icosphere(4, 0.1).triangles_center
    assert np.linalg.norm(centers, axis=1).min() > 0.1 - facets
    random = np.random.default_rng(times)
    off = 0.0
    for _ in range(20):
        direction = random.normal(size=3)
        center = direction / np.linalg.norm(direction) * (0.2 * times + 0.2)
        pose = at(*center) @ turned(tuple(random.normal(size=3)), random.uniform(0.0, 3.0))
        true = distance_to(half, center[None])[0] - 0.1
        of_ball = ball.shell.points @ pose[:3, :3].T + pose[:3, 3]
        of_body = (body.shell.points - pose[:3, 3]) @ pose[:3, :3]
        for shell, model, shape, points in (
            ("a", ball, None, of_body),
            ("b", body, half, of_ball),
        ):
            found = vx.distance(body, ball, None, pose, shell=shell).distance
            bound = largest_gap(model, shape, points)
            rounding = 2.0 * facets + 2e-6 * true
            of_points = distance_to(shape, points).min()
            assert true - bound - rounding <= found <= of_points + bound + rounding
            off = max(off, found - of_points, of_points - found)
            assert bound < 0.3  # as far as the corners of the grids are from the surface
    assert off < 0.05


@pytest.mark.parametrize("extents", [(0.2, 0.1, 0.3), (1.0, 0.02, 0.02), None])
@pytest.mark.parametrize("settings", [{"voxel_size": 0.005}, {}])
def test_beyond_the_grid_distances_keep_to_the_stated_bound(extents, settings):
    """They were said to be as exact as in the grid, and were off by 12 and 45 mm."""
    mesh = trimesh.creation.box(extents) if extents else trimesh.creation.icosphere(4, 0.1)
    field = vx.Model.from_mesh(mesh, **settings).field
    low = field.origin
    high = low + (np.array(field.shape) - 1) * field.voxel_size
    random = np.random.default_rng(3)
    directions = random.normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    points = directions * 10.0 ** random.uniform(-1.0, 2.0, (500, 1))
    nearest = np.clip(points, low, high)
    beyond = (points != nearest).any(axis=1)
    points, nearest = points[beyond], nearest[beyond]
    assert len(points) > 300
    true, of_nearest = (
        -trimesh.proximity.signed_distance(mesh, each) for each in (points, nearest)
    )
    # What the cells of eight voxels at the rim of the grid are off by, and float32.
    of_field = 8.0 * field.interpolation_error + 1e-6 * np.abs(true)
    errors = np.abs(field.sample(points) - true)
    assert (errors <= of_nearest + of_field).all()
    assert errors.max() > 0.001  # why more is not promised
