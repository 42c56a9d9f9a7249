from __future__ import annotations

import threading

import numpy as np
import pytest
import trimesh
import voxshell as vx
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

QUERIES = (vx.contacts, vx.collide, vx.testing.contacts_flat)


def moved(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = (x, y, z)
    return pose


def turned(axis: tuple[float, float, float], angle: float) -> np.ndarray:
    return trimesh.transformations.rotation_matrix(angle, axis)


def deepest(contacts: vx.Contacts) -> vx.Contacts:
    return contacts.manifold(1)


# ---- closed forms --------------------------------------------------------------------------------


def test_a_ball_in_the_ground_touches_below_itself_and_is_pushed_up(ball: vx.Model):
    contacts = vx.contacts(ball, vx.Plane(), a_pose=moved(3.0, 4.0, 0.09))
    contact = deepest(contacts)
    assert contacts.shell == "a"
    np.testing.assert_array_equal(contacts.normals, np.tile([0.0, 0.0, 1.0], (len(contacts), 1)))
    np.testing.assert_allclose(contact.depths, [0.01], atol=1e-4)
    np.testing.assert_allclose(contact.points_a, [[3.0, 4.0, -0.01]], atol=5e-3)
    np.testing.assert_allclose(contact.points_b[:, 2], 0.0, atol=1e-8)
    np.testing.assert_array_equal(contact.points_a[:, :2], contact.points_b[:, :2])


def test_the_ground_as_body_a_is_pushed_down(ball: vx.Model):
    contacts = vx.contacts(vx.Plane(), ball, b_pose=moved(3.0, 4.0, 0.09))
    assert contacts.shell == "b"
    np.testing.assert_array_equal(contacts.normals, np.tile([0.0, 0.0, -1.0], (len(contacts), 1)))
    np.testing.assert_allclose(deepest(contacts).points_b, [[3.0, 4.0, -0.01]], atol=5e-3)
    np.testing.assert_allclose(contacts.points_a[:, 2], 0.0, atol=1e-8)


def test_a_turned_ground_pushes_along_its_normal(ball: vx.Model):
    world_from_ground = turned((0, 1, 0), np.pi / 2)  # its z axis is the world's x axis
    contacts = vx.contacts(ball, vx.Plane(offset=0.5), moved(x=0.59), world_from_ground)
    np.testing.assert_allclose(
        contacts.normals, np.tile([1.0, 0, 0], (len(contacts), 1)), atol=1e-7
    )
    np.testing.assert_allclose(contacts.depths.max(), 0.01, atol=1e-4)
    np.testing.assert_allclose(contacts.points_b[:, 0], 0.5, atol=1e-7)


def test_a_ball_in_a_sphere_is_pushed_away_from_its_centre(ball: vx.Model):
    direction = np.array([2.0, -1.0, 2.0]) / 3.0
    contacts = vx.contacts(ball, vx.Sphere(0.2), a_pose=moved(*(0.28 * direction)))
    radii = np.linalg.norm(contacts.points_a, axis=1)
    np.testing.assert_allclose(contacts.depths, 0.2 - radii, atol=1e-7)
    np.testing.assert_allclose(contacts.normals, contacts.points_a / radii[:, None], atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(contacts.points_b, axis=1), 0.2, atol=1e-7)
    np.testing.assert_allclose(contacts.depths.max(), 0.02, atol=2e-4)


def test_a_cube_on_a_box_is_pushed_out_of_the_nearest_face(cube: vx.Model):
    contacts = vx.contacts(cube, vx.Box((2.0, 2.0, 0.5)), a_pose=moved(z=0.99))
    below = contacts.normals[:, 2] == 1.0
    assert np.count_nonzero(below) >= 400
    np.testing.assert_allclose(contacts.depths[below].max(), 0.01, atol=1e-6)


@pytest.mark.parametrize("shell", ["a", "b"])
def test_two_balls_push_each_other_apart(ball: vx.Model, shell: str):
    contacts = vx.contacts(ball, ball, moved(x=0.19), shell=shell)
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
    pose, other = moved(0.05, 0.02, 0.58) @ turned((1, 2, 3), 0.7), turned((3, 1, 2), 0.1)
    for body in (cube, vx.Box((0.5, 0.5, 0.5))):
        assert_mirrored(
            vx.contacts(ball, body, pose, other, shell="a"),
            vx.contacts(body, ball, other, pose, shell="b"),
        )


def test_a_common_motion_changes_the_frame_alone(ball: vx.Model, cube: vx.Model):
    # A quarter turn and a translation by whole numbers are exact in floating point.
    motion = moved(8.0, -4.0, 2.0) @ np.round(turned((0, 0, 1), np.pi / 2))
    pose = moved(0.125, 0.25, 0.5625)
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
    pose = moved(0.1, 0.2, height) @ turned((1, 1, 0), angle)
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


def test_auto_takes_the_shell_with_fewer_points(ball: vx.Model, cube: vx.Model):
    assert len(ball.shell) != len(cube.shell)
    smaller = "a" if len(ball.shell) < len(cube.shell) else "b"
    larger = "b" if smaller == "a" else "a"
    assert vx.contacts(ball, cube).shell == smaller
    assert vx.contacts(cube, ball).shell == larger
    assert vx.contacts(ball, ball).shell == "a"


def test_far_apart_there_is_no_contact_however_far(ball: vx.Model, cube: vx.Model):
    for distance in (10.0, 1e6, 1e12, 1e15):
        for other in (cube, vx.Box((1, 1, 1)), vx.Sphere(1.0), vx.Plane()):
            contacts = vx.contacts(ball, other, moved(z=distance))
            assert len(contacts) == 0
            assert not vx.collide(ball, other, moved(z=distance))


def test_a_margin_counts_near_points_with_negative_depths(ball: vx.Model):
    pose = moved(z=0.102)
    assert not vx.collide(ball, vx.Plane(), pose)
    assert vx.collide(ball, vx.Plane(), pose, margin=0.003)
    contacts = vx.contacts(ball, vx.Plane(), pose, margin=0.003)
    assert np.all((contacts.depths < 0) & (contacts.depths > -0.003))
    assert np.all(contacts.points_a[:, 2] > contacts.points_b[:, 2])
    assert len(vx.contacts(ball, vx.Plane(), moved(z=0.09), margin=-0.009)) < len(
        vx.contacts(ball, vx.Plane(), moved(z=0.09))
    )


def test_poses_of_any_layout_and_type_are_taken(ball: vx.Model):
    pose = moved(z=0.09)
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
    poses = [moved(0.01 * i, 0.0, 0.58) for i in range(20)]
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


# ---- wrong input ---------------------------------------------------------------------------------

SCALED = np.diag([2.0, 2.0, 2.0, 1.0])
MIRRORED = np.diag([1.0, 1.0, -1.0, 1.0])
HOLE = moved(z=np.nan)
PROJECTIVE = np.eye(4) + np.eye(4, k=-1) * [[0], [0], [0], [1]]


@pytest.mark.parametrize("query", QUERIES)
@pytest.mark.parametrize("name", ["a_pose", "b_pose"])
@pytest.mark.parametrize(
    ("pose", "message"),
    [
        (np.eye(3), r"\(4, 4\) numbers, not \(3, 3\)"),
        (np.eye(4).ravel(), r"not \(16,\)"),
        (np.eye(4)[None], r"not \(1, 4, 4\)"),
        ("pose", r"not \(\) <U4"),
        ([["1"] * 4] * 4, "not"),
        ([[1, 2], [3]], "inhomogeneous"),
        (np.eye(4, dtype=complex), "complex"),
        (np.eye(4, dtype=bool), "bool"),
        (np.full((4, 4), None), "object"),
        (HOLE, "finite"),
        (moved(x=np.inf), "finite"),
        (moved(x=1e300), r"1e\+300 m from its origin"),
        (SCALED, "orthonormal"),
        (MIRRORED, "mirrors"),
        (PROJECTIVE, "last row"),
        (np.zeros((4, 4)), "last row"),
    ],
)
def test_a_wrong_pose_is_refused_by_name(ball: vx.Model, query, name, pose, message):
    with pytest.raises(vx.PoseError, match=message) as caught:
        query(ball, vx.Plane(), **{name: pose})
    assert name in str(caught.value)
    assert isinstance(caught.value, (vx.VoxshellError, ValueError))


@given(
    hnp.arrays(
        dtype=st.sampled_from(
            [np.float64, np.float32, np.int64, np.uint8, np.complex128, np.bool_]
        ),
        shape=hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=5),
    )
)
@settings(max_examples=1_000, deadline=None)
def test_any_array_as_a_pose_is_an_error_or_a_pose(ball, array):
    try:
        vx.contacts(ball, vx.Plane(), a_pose=array)
    except vx.PoseError:
        return
    np.testing.assert_allclose(array[:3, :3] @ array[:3, :3].T, np.eye(3), atol=1e-5)


@pytest.mark.parametrize("query", QUERIES)
def test_a_wrong_body_is_refused_by_name(ball: vx.Model, query):
    with pytest.raises(vx.InputTypeError, match="a must be a Model, Plane, Box or Sphere, not int"):
        query(1, ball)
    with pytest.raises(vx.InputTypeError, match=r"b must be a Model.* not Trimesh"):
        query(ball, trimesh.creation.box())
    with pytest.raises(TypeError):
        query(ball, None)
    with pytest.raises(TypeError):
        query(ball)


@pytest.mark.parametrize("query", QUERIES)
def test_a_pair_without_the_shell_asked_for_is_refused(ball: vx.Model, query):
    with pytest.raises(vx.SettingsError, match="neither body has a point shell"):
        query(vx.Plane(), vx.Sphere(1.0))
    with pytest.raises(vx.SettingsError, match="body b has no point shell"):
        query(ball, vx.Plane(), shell="b")
    with pytest.raises(vx.SettingsError, match="body a has no point shell"):
        query(vx.Plane(), ball, shell="a")


@pytest.mark.parametrize("query", QUERIES)
@pytest.mark.parametrize("shell", ["c", "", None, 0, ["a"], "A"])
def test_a_wrong_shell_is_refused(ball: vx.Model, query, shell):
    with pytest.raises(vx.SettingsError, match="'auto', 'a' or 'b'"):
        query(ball, ball, shell=shell)


@pytest.mark.parametrize("query", QUERIES)
@pytest.mark.parametrize("margin", [np.nan, np.inf, -np.inf, 1e300, "1", None, [0.1, 0.2], 1j])
def test_a_wrong_margin_is_refused(ball: vx.Model, query, margin):
    with pytest.raises(vx.SettingsError, match="margin"):
        query(ball, vx.Plane(), margin=margin)


@pytest.mark.parametrize("query", [vx.contacts, vx.testing.contacts_flat])
@pytest.mark.parametrize("level", [0, -1, 13, 2**70, 1.0, "1"])
def test_a_wrong_level_is_refused(ball: vx.Model, query, level):
    with pytest.raises(vx.SettingsError, match="level"):
        query(ball, vx.Plane(), level=level)
