from __future__ import annotations

import threading
import warnings

import numpy as np
import pytest
import trimesh
import voxshell as vx
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from poses import moved, turned


def wrench(a, b, a_pose=None, b_pose=None, **options) -> vx.Wrench:
    return vx.wrench(a, b, a_pose, b_pose, 1.0, **options)


def deepest_per_segment(a, b, a_pose=None, b_pose=None, **options) -> vx.Contacts:
    return vx.deepest_per_segment(a, b, a_pose, b_pose, level=3, **options)


SEARCHES = (vx.contacts, vx.testing.contacts_flat)
FEW = (vx.manifold, deepest_per_segment)
WITH_MARGIN = (*SEARCHES, *FEW, vx.collide, vx.contacts_batch, vx.collide_batch)
ONE_SHELL = (*FEW, wrench)
QUERIES = (*SEARCHES, *FEW, vx.collide, vx.distance, wrench)
BATCHES = (vx.contacts_batch, vx.collide_batch)


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


def test_fewest_takes_the_shell_with_fewer_points(ball: vx.Model, cube: vx.Model):
    assert len(ball.shell) != len(cube.shell)
    smaller = "a" if len(ball.shell) < len(cube.shell) else "b"
    larger = "b" if smaller == "a" else "a"
    for height in (0.55, 2.0):
        assert vx.contacts(ball, cube, moved(z=height), shell="fewest").shell == smaller
        assert vx.contacts(cube, ball, None, moved(z=height), shell="fewest").shell == larger
    assert vx.contacts(ball, ball, shell="fewest").shell == "a"


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


# ---- one body inside the other -------------------------------------------------------------------


@pytest.fixture(scope="module")
def box() -> vx.Model:
    """Of 1 m, with far fewer points than the ball."""
    return vx.Model.from_mesh(trimesh.creation.box(), voxel_size=0.05, target_points=1_500)


def test_fewest_finds_a_body_inside_one_with_fewer_points(ball: vx.Model, box: vx.Model):
    poses = np.stack(
        [moved(x, 0.1, -0.2) @ turned((1, 2, 3), x) for x in np.linspace(-0.3, 0.3, 9)]
    )
    world = moved(1.0, 2.0, 3.0) @ turned((0, 1, 1), 0.5)
    for pose in poses:
        for ball_is, box_is, arguments in (
            ("a", "b", (ball, box, world @ pose, world)),
            ("b", "a", (box, ball, world, world @ pose)),
        ):

            def query(function, *, arguments=arguments, shell="fewest", **options):
                return function(*arguments, shell=shell, **options)

            assert not query(vx.collide, shell=box_is)
            assert query(vx.collide)
            assert query(vx.collide, shell="both")
            contacts = query(vx.contacts)
            assert contacts.shell == ball_is
            assert len(contacts) == len(ball.shell)
            expected = query(vx.contacts, shell=ball_is)
            np.testing.assert_array_equal(contacts.points_a, expected.points_a)
            flat = query(vx.testing.contacts_flat)
            np.testing.assert_array_equal(contacts.points_a, flat.points_a)
            nearest = query(vx.distance)
            assert nearest.shell == ball_is
            assert -nearest.distance == contacts.depths.max()
            assert query(vx.distance, max_distance=0.0).distance == nearest.distance
            one, other = query(wrench), query(wrench, shell=ball_is)
            np.testing.assert_array_equal(one.force, other.force)
            np.testing.assert_array_equal(one.torque, other.torque)
            assert np.linalg.norm(one.force) > 0.0
            assert len(query(vx.contacts, budget=1_000)) > 0
            assert len(query(vx.contacts, max_points=3)) == 3
    np.testing.assert_array_equal(vx.collide_batch(ball, box, poses, shell="fewest"), True)
    batch = vx.contacts_batch(box, ball, np.eye(4), poses, shell="fewest")
    assert [contacts.shell for contacts in batch] == ["b"] * 9
    np.testing.assert_array_equal(np.diff(batch.offsets), len(ball.shell))


def test_fewest_is_the_body_that_fits_between_the_points_of_the_other(ball: vx.Model):
    sparse = vx.Model.from_mesh(trimesh.creation.box(), voxel_size=0.05, target_points=100)
    assert len(sparse.shell) < len(ball.shell)
    # Through a face, between its points.
    assert vx.contacts(sparse, ball, None, moved(0.05, 0.05, 0.55), shell="fewest").shell == "b"
    assert vx.contacts(ball, sparse, moved(0.05, 0.05, 0.55), shell="fewest").shell == "a"


def test_a_batch_of_fewest_changes_roles_pose_by_pose(ball: vx.Model, box: vx.Model):
    # From outside through a face into the middle: none, the box's points, then the ball's.
    poses = np.stack([moved(0.0, 0.0, z) for z in np.linspace(0.7, 0.0, 200)])
    batch = vx.contacts_batch(box, ball, None, poses, shell="fewest")
    shells = [contacts.shell for contacts in batch]
    assert {"a", "b"} == set(shells)
    for contacts, pose in zip(batch, poses, strict=True):
        alone = vx.contacts(box, ball, None, pose, shell="fewest")
        assert contacts.shell == alone.shell
        np.testing.assert_array_equal(contacts.points_a, alone.points_a)
        np.testing.assert_array_equal(contacts.shells, np.full(len(contacts), contacts.shell))


def test_no_budget_hides_what_is_deeper_than_its_bound(ball: vx.Model, box: vx.Model):
    for x in np.linspace(0.0, 0.7, 30):
        pose = moved(x, 0.03, 0.01)
        for shell in ("fewest", "auto"):
            everything = vx.contacts(ball, box, pose, shell=shell)
            for budget in (1, 2, 5, 20, 100):
                found = vx.contacts(ball, box, pose, shell=shell, budget=budget)
                missed = everything.depths
                if found.shell == everything.shell:
                    keys = everything.ids * 2 + (everything.shells == "b")
                    of_found = found.ids * 2 + (found.shells == "b")
                    missed = missed[np.isin(keys, of_found, invert=True)]
                assert missed.max(initial=-np.inf) <= found.depth_bound


# ---- roles by accuracy ---------------------------------------------------------------------------


@pytest.fixture(scope="module")
def needle() -> vx.Model:
    """Thinner than the cube's points are apart: what is sharp is missed by one shell alone."""
    return vx.Model.from_mesh(trimesh.creation.cone(radius=0.01, height=0.2), voxel_size=0.004)


def random_poses(count: int, reach: float) -> np.ndarray:
    rng = np.random.default_rng(18)
    poses = np.stack(
        [trimesh.transformations.random_rotation_matrix(rng.random(3)) for _ in range(count)]
    )
    poses[:, :3, 3] = rng.uniform(-reach, reach, (count, 3))
    return poses


def swapped(shell: str) -> str:
    return {"a": "b", "b": "a", "both": "both"}[shell]


def test_the_automatic_role_is_a_constant_of_the_pair(ball, cube, box, needle):
    for one, other in ((ball, cube), (ball, box), (needle, cube), (cube, vx.Sphere(0.1))):
        role = vx.contact_bounds(one, other).shell
        assert vx.contact_bounds(other, one).shell == swapped(role)
        poses = random_poses(60, 0.7)
        batch = vx.contacts_batch(one, other, poses)
        touching = np.diff(batch.offsets) > 0
        assert 5 < touching.sum() < 55
        for contacts, pose in zip(batch, poses, strict=True):
            assert contacts.shell == role
            for search in SEARCHES:
                for budget in (None, 1):
                    assert search(one, other, pose, budget=budget).shell == role
                    assert search(other, one, None, pose, budget=budget).shell == swapped(role)
        np.testing.assert_array_equal(touching, vx.collide_batch(one, other, poses))


@pytest.mark.parametrize("shell", ["auto", "both"])
def test_contacts_of_b_and_a_are_those_of_a_and_b_turned_round(ball, cube, needle, shell):
    hits = 0
    for one, other in ((ball, cube), (needle, cube), (cube, needle)):
        for pose in random_poses(40, 0.6):
            world = moved(0.1, 0.2, 0.3)
            there = vx.contacts(one, other, world @ pose, world, shell=shell, level=3)
            back = vx.contacts(other, one, world, world @ pose, shell=shell, level=3)
            hits += len(there) > 0
            assert back.shell == swapped(there.shell)
            for side in ("a", "b"):
                mine, yours = there.shells == side, back.shells == swapped(side)
                np.testing.assert_array_equal(there.ids[mine], back.ids[yours])
                np.testing.assert_array_equal(there.depths[mine], back.depths[yours])
                np.testing.assert_array_equal(there.segments[mine], back.segments[yours])
                np.testing.assert_array_equal(there.points_a[mine], back.points_b[yours])
                np.testing.assert_array_equal(there.points_b[mine], back.points_a[yours])
                np.testing.assert_array_equal(there.normals[mine], -back.normals[yours])
            assert vx.collide(one, other, world @ pose, world, shell=shell) == (len(there) > 0)
    assert hits > 20


@pytest.mark.parametrize("shell", ["auto", "fewest", "both", "a"])
def test_every_query_of_a_pair_asks_the_same_shells(ball, needle, shell):
    scratch = vx.QueryScratch()
    hits = 0
    for pose in random_poses(60, 0.12):
        found = vx.contacts(ball, needle, pose, shell=shell, level=4)
        flat = vx.testing.contacts_flat(ball, needle, pose, shell=shell, level=4)
        hits += len(found) > 0
        assert found.shell == flat.shell
        for name in ("ids", "shells", "depths", "points_a", "points_b", "normals", "segments"):
            np.testing.assert_array_equal(getattr(found, name), getattr(flat, name))
        few = vx.manifold(ball, needle, pose, shell=shell, scratch=scratch)
        expected = found.manifold()
        segmented = vx.deepest_per_segment(
            ball, needle, pose, level=4, shell=shell, scratch=scratch
        )
        for got, want in ((few, expected), (segmented, found.deepest_per_segment())):
            assert got.shell == found.shell
            np.testing.assert_array_equal(got.ids, want.ids)
            np.testing.assert_array_equal(got.shells, want.shells)
            np.testing.assert_array_equal(got.points_b, want.points_b)
        nearest = vx.distance(ball, needle, pose, shell=shell, scratch=scratch)
        if len(found) > 0:
            assert -nearest.distance == found.depths.max()
        else:
            assert nearest.distance >= 0.0
    assert hits > 20


def test_the_wrench_of_both_shells_counts_area_once(ball: vx.Model, cube: vx.Model):
    for pose in random_poses(20, 0.5):
        a, b, both = (wrench(ball, cube, pose, shell=shell) for shell in ("a", "b", "both"))
        np.testing.assert_allclose(both.force, 0.5 * (a.force + b.force), rtol=1e-12, atol=1e-9)
        np.testing.assert_allclose(both.torque, 0.5 * (a.torque + b.torque), rtol=1e-12, atol=1e-9)


def test_the_wrench_of_both_shells_has_no_jumps(ball: vx.Model, cube: vx.Model):
    # Into the cube through its face until the ball is wholly inside.
    forces = np.array(
        [
            wrench(ball, cube, moved(0.01, 0.02, z), shell="both").force
            for z in np.linspace(0.65, 0.3, 2000)
        ]
    )
    steps = np.linalg.norm(np.diff(forces, axis=0), axis=1)
    assert np.linalg.norm(forces, axis=1).max() > 0.0
    assert steps.max() < 0.01 * np.linalg.norm(forces, axis=1).max()


def test_an_automatic_pair_that_may_miss_much_warns_once(cube: vx.Model):
    sparse = vx.Model.from_mesh(trimesh.creation.box(), voxel_size=0.05, target_points=100)
    with pytest.warns(vx.AccuracyWarning, match="may miss .* mm in depth") as caught:  # noqa: PT031
        vx.contacts(sparse, cube)
        vx.collide(sparse, cube, moved(x=3.0))
        vx.distance(sparse, cube)
        vx.contacts_batch(sparse, cube)
    assert len(caught) == 1
    assert caught[0].filename == __file__
    assert "to a tolerance, without voxel_size= and resolution= (" in str(caught[0].message)
    assert "load robots with a smaller voxel_size=" in str(caught[0].message)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for shell in ("fewest", "a", "b", "both"):
            vx.contacts(cube, sparse, shell=shell)
        vx.contacts(cube, sparse)  # the same pair


def test_a_large_thin_plate_counts_by_its_wall():
    """Two per cent of the ball, which is smaller, are more than the plate is thick."""
    plate = vx.Model.from_mesh(trimesh.creation.box((0.3, 0.3, 0.0005)))
    ball = vx.Model.from_mesh(trimesh.creation.icosphere(4, radius=0.05), tolerance=2e-4)
    with pytest.warns(
        vx.AccuracyWarning, match="of the thinner wall of 0.5 mm; .* smaller tolerance="
    ):
        vx.contacts(ball, plate)


def test_pairs_of_walls_at_default_settings_do_not_warn():
    tube = vx.Model.from_mesh(trimesh.creation.annulus(0.03, 0.032, 0.1))
    bowl = vx.Model.from_mesh(trimesh.creation.annulus(0.05, 0.0515, 0.06))
    box = vx.Model.from_mesh(trimesh.creation.box((0.1, 0.08, 0.06)))
    slab = vx.Model.from_mesh(trimesh.creation.box((1.0, 1.0, 0.05)))
    models = (tube, bowl, box, slab)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for i, a in enumerate(models):
            for b in (*models[i:], vx.Plane(), vx.Box((0.1, 0.1, 0.1)), vx.Sphere(0.05)):
                vx.collide(a, b)


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


def test_bounds_are_those_of_the_meshes():
    """Closed forms: how far balls are from touching."""
    ball = vx.Model.from_mesh(trimesh.creation.icosphere(4, radius=0.02))
    slab = vx.Model.from_mesh(trimesh.creation.box((1.0, 1.0, 0.1)))
    bounds = vx.contact_bounds(ball, slab)
    turned = vx.contact_bounds(slab, ball)
    assert (bounds.overlap, bounds.clearance) == (turned.overlap, turned.clearance)
    # The icosphere's own vertices are on the ball, one of them below its centre.
    low = 0.05 - ball.mesh.vertices[:, 2].min()
    assert 0.0 < bounds.clearance <= bounds.overlap < 2e-4
    assert vx.collide(ball, slab, moved(0.1, 0.2, low - bounds.overlap))
    assert not vx.collide(ball, slab, moved(0.1, 0.2, low + bounds.clearance))
    uniform = vx.Model.from_mesh(trimesh.creation.icosphere(4, radius=0.02), voxel_size=0.001)
    error = uniform.field.interpolation_error
    assert vx.contact_bounds(uniform, uniform, shell="both").overlap == pytest.approx(
        np.sqrt(3.0) * uniform.shell.spacing + error
    )


# ---- no surface in contact -----------------------------------------------------------------------


@pytest.mark.parametrize("shell", ["auto", "both"])
def test_bodies_in_the_very_same_place_are_in_contact(shell: str):
    meshes = (
        trimesh.creation.box((0.1, 0.2, 0.3)),
        trimesh.creation.icosphere(2, radius=0.1),
        trimesh.creation.annulus(0.08, 0.081, 0.2),
    )
    for mesh in meshes:
        model = vx.Model.from_mesh(mesh, resolution=60)
        twin = vx.Model.from_mesh(mesh, resolution=50)
        for other in (model, twin):
            for pose in random_poses(10, 2.0):
                found = vx.contacts(model, other, pose, pose, shell=shell)
                assert len(found) > 0
                assert vx.collide(model, other, pose, pose, shell=shell)
                assert vx.distance(model, other, pose, pose, shell=shell).distance < 0.0
                assert len(vx.manifold(model, other, pose, pose, shell=shell)) > 0
                assert vx.collide_batch(model, other, pose, pose, shell=shell).all()
                batch = vx.contacts_batch(model, other, pose, pose, shell=shell)
                flat = vx.testing.contacts_flat(model, other, pose, pose, shell=shell)
                for same in (batch[0], flat):
                    np.testing.assert_array_equal(same.ids, found.ids)
                    np.testing.assert_array_equal(same.ambiguous, found.ambiguous)


def test_ambiguous_contacts_are_of_a_place_inside(cube: vx.Model):
    found = vx.contacts(cube, cube, shell="both", level=3)
    assert found.ambiguous.all()
    assert found.shells.tolist() == ["a", "b"]
    np.testing.assert_array_equal(found.ids, [len(cube.shell)] * 2)
    np.testing.assert_array_equal(found.segments, [0, 0])
    np.testing.assert_allclose(found.depths, 0.5, atol=0.15)
    np.testing.assert_allclose(
        found.points_b - found.points_a, found.depths[:, None] * found.normals, atol=1e-6
    )
    assert len(found.deepest_per_segment()) == 2
    nearest = vx.distance(cube, cube, shell="both")
    assert nearest.distance == -found.depths.max()
    assert len(vx.contacts(cube, cube, shell="both", max_points=1)) == 1
    apart = vx.contacts(cube, cube, moved(0.9), shell="both")
    assert len(apart) > 0
    # Only places that are as near to two faces of the other cube may be ambiguous.
    assert apart.ambiguous.sum() <= 2
    of_a = (apart.shells == "a")[:, None]
    places = np.where(of_a, apart.points_a, apart.points_b - [0.9, 0.0, 0.0])[apart.ambiguous]
    to_faces = np.sort(0.5 - np.abs(places), axis=1)
    np.testing.assert_allclose(to_faces[:, 1], to_faces[:, 0], atol=1e-6)
    on_b = np.abs(apart.points_b[~apart.ambiguous & (apart.shells == "a")])
    np.testing.assert_allclose(on_b.max(axis=1), 0.5, atol=0.05)
    for shell in ("fewest", "a", "b"):
        assert len(vx.contacts(cube, cube, shell=shell)) == 0


def sweep_depths(model: vx.Model, thickness: float, *, at: tuple[float, float] = (0.0, 0.0)):
    """Contacts of a cube that is sunk into a wall, to fractions of half of its thickness."""
    cube = vx.Model.from_mesh(trimesh.creation.box((0.02, 0.02, 0.02)))
    for fraction in (0.02, 0.3, 0.6, 0.85, 0.97, 1.0):
        pose = moved(*at, 0.01 + 0.5 * thickness * (1.0 - fraction))
        found = vx.contacts(cube, model, pose, shell="a")
        depths = 2.0 * found.depths / thickness
        below = (found.points_a[:, 2] < pose[2, 3] - 0.0099) & (depths > 0.9 * fraction)
        assert below.sum() > 4
        yield fraction, found.ambiguous[below]


@pytest.mark.parametrize("thickness", [0.001, 0.006])
def test_contacts_in_the_middle_of_a_wall_are_ambiguous(thickness: float):
    plate = vx.Model.from_mesh(trimesh.creation.box((0.2, 0.2, thickness)))
    for fraction, ambiguous in sweep_depths(plate, thickness):
        assert (ambiguous == (fraction > 0.9)).all(), fraction


def test_contacts_in_the_middle_of_a_brackets_wall_are_ambiguous():
    foot = trimesh.creation.box((0.1, 0.06, 0.006))
    wall = trimesh.creation.box((0.006, 0.06, 0.06))
    wall.apply_translation((-0.047, 0.0, 0.027))
    bracket = vx.Model.from_mesh(trimesh.boolean.union([foot, wall], engine="manifold"))
    for fraction, ambiguous in sweep_depths(bracket, 0.006):
        assert (ambiguous == (fraction > 0.9)).all(), fraction


def test_contacts_of_a_cube_that_stands_on_another_are_not_ambiguous(cube: vx.Model):
    exact = vx.Model.from_mesh(trimesh.creation.box())
    for model in (cube, exact):
        for depth in (1e-7, 1e-4, 0.01):
            found = vx.contacts(model, model, moved(z=1.0 - depth), shell="both", margin=0.001)
            assert len(found) > 4
            assert not found.ambiguous.any()


def test_ambiguous_contacts_stay_in_manifolds():
    plate = vx.Model.from_mesh(trimesh.creation.box((0.2, 0.2, 0.001)))
    cube = vx.Model.from_mesh(trimesh.creation.box((0.02, 0.02, 0.02)))
    found = vx.contacts(cube, plate, moved(z=0.01))
    assert found.manifold().ambiguous.any()
    assert not found.ambiguous.flags.writeable


# ---- both shells, few points, budgets, scratches ------------------------------------------------


def test_both_shells_are_a_then_b(ball: vx.Model, cube: vx.Model):
    pose, other = moved(0.05, 0.02, 0.58) @ turned((1, 2, 3), 0.7), turned((3, 1, 2), 0.1)
    both = vx.contacts(ball, cube, pose, other, shell="both", level=3, margin=0.001)
    assert both.shell == "both"
    assert both.exact
    assert both.depth_bound == -np.inf
    start = 0
    for shell in ("a", "b"):
        one = vx.contacts(ball, cube, pose, other, shell=shell, level=3, margin=0.001)
        assert len(one) > 3
        rows = slice(start, start + len(one))
        np.testing.assert_array_equal(both.shells[rows], np.full(len(one), shell))
        np.testing.assert_array_equal(one.shells, both.shells[rows])
        for name in ("points_a", "points_b", "normals", "depths", "ids", "segments"):
            np.testing.assert_array_equal(getattr(both, name)[rows], getattr(one, name))
        start += len(one)
    assert len(both) == start
    flat = vx.testing.contacts_flat(ball, cube, pose, other, shell="both", level=3, margin=0.001)
    np.testing.assert_array_equal(flat.points_b, both.points_b)
    np.testing.assert_array_equal(flat.shells, both.shells)


def test_a_manifold_of_both_shells_spans_the_area(cube: vx.Model):
    # What faces the upper cube is another side of the lower one, in its own frame.
    pose = moved(3.0, -2.0, 0.999) @ turned((0, 0, 1), 0.5)
    other = moved(3.0, -2.0, 0.0) @ turned((0, 0, 1), 0.5) @ turned((1, 0, 0), np.pi / 2)
    both = vx.contacts(cube, cube, pose, other, shell="both", level=3)
    manifold = both.manifold()
    assert manifold.shell == "both"
    assert len(manifold) == 4
    assert manifold.depths[0] == both.depths.max()
    corners = ((manifold.points_a - pose[:3, 3]) @ pose[:3, :3])[:, :2]
    # Of the square of 1 m2; the four triangles of four points cover their hull twice.
    a, b, c, d = corners
    doubled = [
        np.linalg.det([q - p, r - p]) for p, q, r in ((a, b, c), (a, b, d), (a, c, d), (b, c, d))
    ]
    assert np.abs(doubled).sum() / 4.0 > 0.75
    deepest = both.deepest_per_segment()
    assert set(deepest.shells) == {"a", "b"}
    keys = list(zip(deepest.shells, deepest.segments, strict=True))
    assert keys == sorted(set(zip(both.shells, both.segments, strict=True)))
    for shell, segment, depth in zip(deepest.shells, deepest.segments, deepest.depths, strict=True):
        members = (both.shells == shell) & (both.segments == segment)
        assert depth == both.depths[members].max()


def test_both_shells_find_a_spike_between_the_points_of_the_other():
    spike = trimesh.creation.cone(radius=0.002, height=0.1)
    needle = vx.Model.from_mesh(spike, resolution=100, point_spacing=0.01)
    slab = vx.Model.from_mesh(trimesh.creation.box((0.2, 0.2, 0.02)), voxel_size=0.01)
    pose = moved(0.0051, 0.0049, -0.02) @ turned((1, 0, 0), 0.0)
    found = {shell: vx.collide(slab, needle, None, pose, shell=shell) for shell in ("a", "b")}
    assert found == {"a": False, "b": True}
    assert vx.collide(slab, needle, None, pose, shell="both")
    assert set(vx.contacts(slab, needle, None, pose, shell="both").shells) == {"b"}


@pytest.mark.parametrize("shell", ["a", "b", "both"])
@pytest.mark.parametrize("max_points", [0, 1, 7, 10_000])
def test_few_points_are_the_deepest(ball: vx.Model, cube: vx.Model, shell: str, max_points: int):
    pose = moved(0.05, 0.02, 0.5)
    everything = vx.contacts(ball, cube, pose, shell=shell)
    assert 7 < len(everything) < 10_000
    few = vx.contacts(ball, cube, pose, shell=shell, max_points=max_points)
    oracle = np.sort(np.argsort(-everything.depths, kind="stable")[:max_points])
    assert few.exact
    for name in ("points_a", "normals", "depths", "ids", "shells"):
        np.testing.assert_array_equal(getattr(few, name), getattr(everything, name)[oracle])
    flat = vx.testing.contacts_flat(ball, cube, pose, shell=shell, max_points=max_points)
    np.testing.assert_array_equal(flat.points_a, few.points_a)


@pytest.mark.parametrize("shell", ["a", "b", "both"])
def test_a_budget_says_what_it_may_have_missed(ball: vx.Model, cube: vx.Model, shell: str):
    inexact = 0
    for height in (0.45, 0.55, 0.599, 0.7):
        pose = moved(0.05, 0.02, height)
        everything = vx.contacts(ball, cube, pose, shell=shell)
        keys = list(zip(everything.shells.tolist(), everything.ids.tolist(), strict=True))
        rows_of = {key: row for row, key in enumerate(keys)}
        for budget in (1, 3, 10, 30, 100, 1_000, 2**62):
            found = vx.contacts(ball, cube, pose, shell=shell, budget=budget)
            seen = zip(found.shells.tolist(), found.ids.tolist(), strict=True)
            rows = [rows_of[key] for key in seen]
            missed = np.setdiff1d(np.arange(len(everything)), rows)
            np.testing.assert_array_equal(found.depths, everything.depths[rows])
            assert everything.depths[missed].max(initial=-np.inf) <= found.depth_bound
            if found.exact:
                assert len(missed) == 0
                assert found.depth_bound == -np.inf
            else:
                inexact += 1
                assert "perhaps not all" in repr(found)
        assert found.exact
    assert inexact >= 8


def count_nodes(a: vx.Model, b: vx.Model, pose: np.ndarray) -> int:
    """The least budget with which contacts are complete."""
    too_few, enough = 0, 2**20
    while enough - too_few > 1:
        middle = (too_few + enough) // 2
        if vx.contacts(a, b, pose, shell="a", budget=middle).exact:
            enough = middle
        else:
            too_few = middle
    return enough


def test_work_grows_less_than_the_points(cube: vx.Model):
    """A flat loop looks at all points: the exponent of its work is 1."""
    mesh = trimesh.creation.icosphere(4, radius=0.1)
    pose = moved(0.05, 0.02, 0.5982)
    points, nodes = [], []
    for target_points in (1_000, 4_000, 16_000, 64_000):
        model = vx.Model.from_mesh(mesh, voxel_size=0.005, target_points=target_points)
        assert len(vx.contacts(model, cube, pose, shell="a")) > 0
        points.append(len(model.shell))
        nodes.append(count_nodes(model, cube, pose))
    assert nodes[-1] < points[-1] / 8 / 20, "a node is eight points"
    assert np.polyfit(np.log(points), np.log(nodes), 1)[0] < 0.7


def test_a_scratch_changes_no_answer(ball: vx.Model, cube: vx.Model):
    scratch = vx.QueryScratch()
    contacts = 0
    for i in range(60):
        pose = moved(0.05, 0.02, 0.62 - 0.001 * i) @ turned((1, 2, 3), 0.01 * i)
        for shell in ("auto", "fewest", "a", "b", "both"):
            new = vx.contacts(ball, cube, pose, shell=shell)
            old = vx.contacts(ball, cube, pose, shell=shell, scratch=scratch)
            np.testing.assert_array_equal(new.points_b, old.points_b)
            contacts += len(new)
        few = vx.contacts(ball, cube, pose, budget=20, scratch=scratch)
        np.testing.assert_array_equal(vx.contacts(ball, cube, pose, budget=20).ids, few.ids)
        assert (
            vx.distance(ball, cube, pose, scratch=scratch).distance
            == vx.distance(ball, cube, pose).distance
        )
        np.testing.assert_array_equal(
            wrench(ball, cube, pose, scratch=scratch).force, wrench(ball, cube, pose).force
        )
    assert contacts > 1_000


def test_threads_that_share_a_scratch_get_their_own_answers(ball: vx.Model, cube: vx.Model):
    scratch = vx.QueryScratch()
    poses = [moved(0.01 * i, 0.0, 0.58) for i in range(20)]
    expected = [vx.contacts(ball, cube, pose).depths.tobytes() for pose in poses]
    failures = []

    def work(step: int) -> None:
        for k in range(200):
            i = (k * step) % len(poses)
            contacts = vx.contacts(ball, cube, poses[i], scratch=scratch)
            if contacts.depths.tobytes() != expected[i]:
                failures.append(i)

    threads = [threading.Thread(target=work, args=(step,)) for step in (1, 3, 7, 9, 11, 13)]
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
        (np.eye(3), r"\(4, 4\) matrix, .*not \(3, 3\) float64; for a rotation"),
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
    if array.shape == (4, 4):
        np.testing.assert_allclose(array[:3, :3] @ array[:3, :3].T, np.eye(3), atol=2e-3)
    else:
        assert array.shape == (3,)


@pytest.mark.parametrize("query", [*QUERIES, *BATCHES])
def test_a_wrong_body_is_refused_by_name(ball: vx.Model, query):
    with pytest.raises(
        vx.InputTypeError, match=r"a must be a Model, .*Plane, .* Cone or ConvexPolyhedron, not int"
    ):
        query(1, ball)
    with pytest.raises(vx.InputTypeError, match=r"b must be a Model.* not Trimesh"):
        query(ball, trimesh.creation.box())
    with pytest.raises(TypeError):
        query(ball, None)
    with pytest.raises(TypeError):
        query(ball)


@pytest.mark.parametrize("query", [*QUERIES, *BATCHES])
def test_a_pair_without_the_shell_asked_for_is_refused(ball: vx.Model, query):
    with pytest.raises(vx.SettingsError, match="neither body has a point shell"):
        query(vx.Plane(), vx.Sphere(1.0))
    with pytest.raises(vx.SettingsError, match="body b has no point shell"):
        query(ball, vx.Plane(), shell="b")
    with pytest.raises(vx.SettingsError, match="body a has no point shell"):
        query(vx.Plane(), ball, shell="a")
    if query not in ONE_SHELL:
        with pytest.raises(vx.SettingsError, match="body b has no point shell"):
            query(ball, vx.Plane(), shell="both")


@pytest.mark.parametrize("query", [*QUERIES, *BATCHES])
@pytest.mark.parametrize("shell", ["c", "", None, 0, ["a"], "A", ("a", "b")])
def test_a_wrong_shell_is_refused(ball: vx.Model, query, shell):
    choices = "'auto', 'fewest', 'a', 'b' or 'both'"
    with pytest.raises(vx.SettingsError, match=choices):
        query(ball, ball, shell=shell)


@pytest.mark.parametrize("query", WITH_MARGIN)
@pytest.mark.parametrize("margin", [np.nan, np.inf, -np.inf, 1e300, "1", None, [0.1, 0.2], 1j])
def test_a_wrong_margin_is_refused(ball: vx.Model, query, margin):
    with pytest.raises(vx.SettingsError, match="margin"):
        query(ball, vx.Plane(), margin=margin)


@pytest.mark.parametrize("query", [*SEARCHES, vx.deepest_per_segment, vx.contacts_batch])
@pytest.mark.parametrize("level", [0, -1, 13, 2**70, 1.0, "1"])
def test_a_wrong_level_is_refused(ball: vx.Model, query, level):
    with pytest.raises(vx.SettingsError, match="level"):
        query(ball, vx.Plane(), level=level)


@pytest.mark.parametrize("query", [*SEARCHES, vx.contacts_batch])
@pytest.mark.parametrize("max_points", [-1, 2**70, 1.0, "1", [1]])
def test_a_wrong_number_of_points_is_refused(ball: vx.Model, query, max_points):
    with pytest.raises(vx.SettingsError, match="max_points"):
        query(ball, vx.Plane(), max_points=max_points)


@pytest.mark.parametrize("max_points", [0, 5, 2**70, 1.0, "1", None])
def test_a_wrong_size_of_a_manifold_is_refused(ball: vx.Model, max_points):
    with pytest.raises(vx.SettingsError, match="max_points"):
        vx.manifold(ball, vx.Plane(), max_points=max_points)


@pytest.mark.parametrize("query", SEARCHES)
@pytest.mark.parametrize("budget", [0, -1, 2**70, 1.0, "1"])
def test_a_wrong_budget_is_refused(ball: vx.Model, query, budget):
    with pytest.raises(vx.SettingsError, match="budget"):
        query(ball, vx.Plane(), budget=budget)


@pytest.mark.parametrize("query", [*SEARCHES, *FEW, vx.distance, wrench])
def test_a_wrong_scratch_is_refused(ball: vx.Model, query):
    for scratch in (1, "scratch", [], vx.QueryScratch):
        with pytest.raises(vx.InputTypeError, match="scratch must be a QueryScratch"):
            query(ball, vx.Plane(), scratch=scratch)
