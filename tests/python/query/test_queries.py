from __future__ import annotations

import threading

import numpy as np
import pytest
import trimesh
import voxshell as vx
from hypothesis import given, settings
from hypothesis import strategies as st
from poses import at, turned


def deepest(contacts: vx.Contacts) -> vx.Contacts:
    return contacts.manifold(1)


# ---- closed forms --------------------------------------------------------------------------------


def test_a_ball_in_the_ground_touches_below_itself_and_is_pushed_up(ball: vx.Model):
    contacts = vx.contacts(ball, vx.Plane(), a_pose=at(3.0, 4.0, 0.09))
    contact = deepest(contacts)
    assert contacts.shell == "a"
    np.testing.assert_array_equal(contacts.normals, np.tile([0.0, 0.0, 1.0], (len(contacts), 1)))
    np.testing.assert_allclose(contact.depths, [0.01], atol=1e-4)
    np.testing.assert_allclose(contact.points_a, [[3.0, 4.0, -0.01]], atol=5e-3)
    np.testing.assert_allclose(contact.points_b[:, 2], 0.0, atol=1e-8)
    np.testing.assert_array_equal(contact.points_a[:, :2], contact.points_b[:, :2])


def test_the_ground_as_body_a_is_pushed_down(ball: vx.Model):
    contacts = vx.contacts(vx.Plane(), ball, b_pose=at(3.0, 4.0, 0.09))
    assert contacts.shell == "b"
    np.testing.assert_array_equal(contacts.normals, np.tile([0.0, 0.0, -1.0], (len(contacts), 1)))
    np.testing.assert_allclose(deepest(contacts).points_b, [[3.0, 4.0, -0.01]], atol=5e-3)
    np.testing.assert_allclose(contacts.points_a[:, 2], 0.0, atol=1e-8)


def test_a_turned_ground_pushes_along_its_normal(ball: vx.Model):
    world_from_ground = turned((0, 1, 0), np.pi / 2)  # its z axis is the world's x axis
    contacts = vx.contacts(ball, vx.Plane(offset=0.5), at(x=0.59), world_from_ground)
    np.testing.assert_allclose(
        contacts.normals, np.tile([1.0, 0, 0], (len(contacts), 1)), atol=1e-7
    )
    np.testing.assert_allclose(contacts.depths.max(), 0.01, atol=1e-4)
    np.testing.assert_allclose(contacts.points_b[:, 0], 0.5, atol=1e-7)


def test_a_ball_in_a_sphere_is_pushed_away_from_its_center(ball: vx.Model):
    direction = np.array([2.0, -1.0, 2.0]) / 3.0
    contacts = vx.contacts(ball, vx.Sphere(0.2), a_pose=at(*(0.28 * direction)))
    radii = np.linalg.norm(contacts.points_a, axis=1)
    np.testing.assert_allclose(contacts.depths, 0.2 - radii, atol=1e-7)
    np.testing.assert_allclose(contacts.normals, contacts.points_a / radii[:, None], atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(contacts.points_b, axis=1), 0.2, atol=1e-7)
    np.testing.assert_allclose(contacts.depths.max(), 0.02, atol=2e-4)


def test_a_cube_on_a_box_is_pushed_out_of_the_nearest_face(cube: vx.Model):
    contacts = vx.contacts(cube, vx.Box((2.0, 2.0, 0.5)), a_pose=at(z=0.99))
    below = contacts.normals[:, 2] == 1.0
    assert np.count_nonzero(below) >= 400
    np.testing.assert_allclose(contacts.depths[below].max(), 0.01, atol=1e-6)


@pytest.mark.parametrize("shell", ["a", "b"])
def test_two_balls_push_each_other_apart(ball: vx.Model, shell: str):
    contacts = vx.contacts(ball, ball, at(x=0.19), shell=shell)
    assert contacts.shell == shell
    contact = deepest(contacts)
    np.testing.assert_allclose(contact.depths, [0.01], atol=3e-4)
    np.testing.assert_allclose(contact.normals, [[1.0, 0.0, 0.0]], atol=0.05)
    np.testing.assert_allclose(contact.points_a[0, 0], 0.09, atol=1e-3)
    np.testing.assert_allclose(contact.points_b[0, 0], 0.10, atol=1e-3)


def test_a_body_inside_another_is_a_contact(ball: vx.Model, cube: vx.Model):
    contacts = vx.contacts(ball, cube, shell="a")
    assert len(contacts) == len(ball.shell)
    np.testing.assert_allclose(contacts.depths.min(), 0.4, atol=1e-3)


def test_bars_that_cross_with_flush_faces_are_in_contact():
    """All edges of either lie in the other's surface: only points between them are inside."""
    bar = vx.Model.from_mesh(trimesh.creation.box((1.0, 0.01, 0.01)))
    rng = np.random.default_rng(0)
    for angle in rng.uniform(0.5, np.pi - 0.5, 60):
        pose = trimesh.transformations.rotation_matrix(angle, (0, 0, 1))
        pose[:2, 3] = rng.uniform(-0.1, 0.1, 2)
        assert vx.collide(bar, bar, pose)
        # Of points 5 mm apart one is within 2.5 mm of the middle.
        assert vx.contacts(bar, bar, pose).depths.max() > 0.0025 - 1e-6


# ---- invariants ----------------------------------------------------------------------------------


def assert_mirrored(forth: vx.Contacts, back: vx.Contacts) -> None:
    assert len(forth) > 0
    assert {forth.shell, back.shell} == {"a", "b"}
    np.testing.assert_array_equal(forth.ids, back.ids)
    np.testing.assert_array_equal(forth.depths, back.depths)
    np.testing.assert_array_equal(forth.normals, -back.normals)
    np.testing.assert_array_equal(forth.points_a, back.points_b)
    np.testing.assert_array_equal(forth.points_b, back.points_a)


def test_swapped_arguments_mirror_the_contacts(ball: vx.Model, cube: vx.Model):
    pose, other = at(0.05, 0.02, 0.58) @ turned((1, 2, 3), 0.7), turned((3, 1, 2), 0.1)
    for body in (cube, vx.Box((0.5, 0.5, 0.5))):
        assert_mirrored(
            vx.contacts(ball, body, pose, other, shell="a"),
            vx.contacts(body, ball, other, pose, shell="b"),
        )


def test_a_common_motion_changes_the_frame_alone(ball: vx.Model, cube: vx.Model):
    # A quarter turn and a translation by whole numbers are exact in floating point.
    motion = at(8.0, -4.0, 2.0) @ np.round(turned((0, 0, 1), np.pi / 2))
    pose = at(0.125, 0.25, 0.5625)
    here = vx.contacts(ball, cube, pose)
    there = vx.contacts(ball, cube, motion @ pose, motion)
    assert len(here) > 0
    np.testing.assert_array_equal(here.ids, there.ids)
    np.testing.assert_array_equal(here.depths, there.depths)
    np.testing.assert_array_equal(here.normals @ motion[:3, :3].T, there.normals)
    np.testing.assert_allclose(
        here.points_b @ motion[:3, :3].T + motion[:3, 3], there.points_b, rtol=0, atol=1e-14
    )


@given(angle=st.floats(0.0, 6.3), height=st.floats(0.45, 0.75), margin=st.floats(0.0, 0.05))
@settings(max_examples=50, deadline=None)
def test_points_pair_up_along_the_normals(cube, ball, angle, height, margin):
    pose = at(0.1, 0.2, height) @ turned((1, 1, 0), angle)
    contacts = vx.contacts(ball, cube, pose, shell="a", margin=margin)
    lengths = np.linalg.norm(contacts.normals, axis=1)
    np.testing.assert_allclose(lengths, 1.0, atol=1e-6)
    assert np.all(contacts.depths > -margin)
    assert np.all(np.diff(contacts.ids) > 0)
    np.testing.assert_allclose(
        contacts.points_b - contacts.points_a,
        contacts.depths[:, None] * contacts.normals,
        atol=1e-15,
    )
    body = pose[:3, :3] @ ball.shell.points[contacts.ids].astype(float).T
    np.testing.assert_allclose(contacts.points_a, body.T + pose[:3, 3], atol=1e-15)
    wider = vx.contacts(ball, cube, pose, shell="a", margin=margin + 0.01)
    assert set(contacts.ids.tolist()) <= set(wider.ids.tolist())


def test_no_pose_is_the_identity(ball: vx.Model):
    plane = vx.Plane(offset=-0.09)
    without, with_poses = vx.contacts(ball, plane), vx.contacts(ball, plane, np.eye(4), np.eye(4))
    assert len(without) > 0
    np.testing.assert_array_equal(without.points_a, with_poses.points_a)


def test_far_apart_there_is_no_contact_however_far(ball: vx.Model, cube: vx.Model):
    for distance in (10.0, 1e6, 1e12, 1e15):
        for other in (cube, vx.Box((1, 1, 1)), vx.Sphere(1.0), vx.Plane()):
            contacts = vx.contacts(ball, other, at(z=distance))
            assert len(contacts) == 0
            assert not vx.collide(ball, other, at(z=distance))


def test_a_margin_counts_near_points_with_negative_depths(ball: vx.Model):
    pose = at(z=0.102)
    assert not vx.collide(ball, vx.Plane(), pose)
    assert vx.collide(ball, vx.Plane(), pose, margin=0.003)
    contacts = vx.contacts(ball, vx.Plane(), pose, margin=0.003)
    assert np.all((contacts.depths < 0) & (contacts.depths > -0.003))
    assert np.all(contacts.points_a[:, 2] > contacts.points_b[:, 2])
    assert len(vx.contacts(ball, vx.Plane(), at(z=0.09), margin=-0.009)) < len(
        vx.contacts(ball, vx.Plane(), at(z=0.09))
    )


def test_poses_of_any_layout_and_type_are_taken(ball: vx.Model):
    pose = at(z=0.09)
    expected = vx.contacts(ball, vx.Plane(), pose).depths
    wide = np.zeros((8, 8))
    wide[::2, ::2] = pose
    for same in (
        pose.tolist(),
        np.asfortranarray(pose),
        wide[::2, ::2],
        pose.astype(np.longdouble),
    ):
        np.testing.assert_array_equal(vx.contacts(ball, vx.Plane(), same).depths, expected)
    single = vx.contacts(ball, vx.Plane(), pose.astype(np.float32)).depths
    np.testing.assert_allclose(single, expected, atol=1e-7)


def test_threads_share_a_model(ball: vx.Model, cube: vx.Model):
    poses = [at(0.01 * i, 0.0, 0.58) for i in range(20)]
    expected = [vx.contacts(ball, cube, pose).depths.tobytes() for pose in poses]
    failures = []

    def work() -> None:
        for _ in range(10):
            got = [vx.contacts(ball, cube, pose).depths.tobytes() for pose in poses]
            failures.extend(i for i in range(len(poses)) if got[i] != expected[i])

    threads = [threading.Thread(target=work) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []


@pytest.mark.parametrize("shell", ["a", "b", "both"])
@pytest.mark.parametrize("max_points", [0, 1, 7, 10_000])
def test_few_points_are_the_deepest(ball: vx.Model, cube: vx.Model, shell: str, max_points: int):
    pose = at(0.05, 0.02, 0.5)
    everything = vx.contacts(ball, cube, pose, shell=shell)
    assert 7 < len(everything) < 10_000
    few = vx.contacts(ball, cube, pose, shell=shell, max_points=max_points)
    oracle = np.sort(np.argsort(-everything.depths, kind="stable")[:max_points])
    assert few.exact
    for name in ("points_a", "normals", "depths", "ids", "shells"):
        np.testing.assert_array_equal(getattr(few, name), getattr(everything, name)[oracle])
    flat = vx.testing.contacts_flat(ball, cube, pose, shell=shell, max_points=max_points)
    np.testing.assert_array_equal(flat.points_a, few.points_a)
