"""Which body gives the points: `shell="fewest"`, the automatic role, and both shells."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx
from poses import at, random_poses, turned
from queries import SEARCHES, wrench

# ---- fewest --------------------------------------------------------------------------------------


def test_fewest_takes_the_shell_with_fewer_points(ball: vx.Model, cube: vx.Model):
    assert len(ball.shell) != len(cube.shell)
    smaller = "a" if len(ball.shell) < len(cube.shell) else "b"
    larger = "b" if smaller == "a" else "a"
    for height in (0.55, 2.0):
        assert vx.contacts(ball, cube, at(z=height), shell="fewest").shell == smaller
        assert vx.contacts(cube, ball, None, at(z=height), shell="fewest").shell == larger
    assert vx.contacts(ball, ball, shell="fewest").shell == "a"


def test_fewest_finds_a_body_inside_one_with_fewer_points(ball: vx.Model, box: vx.Model):
    poses = np.stack([at(x, 0.1, -0.2) @ turned((1, 2, 3), x) for x in np.linspace(-0.3, 0.3, 9)])
    world = at(1.0, 2.0, 3.0) @ turned((0, 1, 1), 0.5)
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
    assert vx.contacts(sparse, ball, None, at(0.05, 0.05, 0.55), shell="fewest").shell == "b"
    assert vx.contacts(ball, sparse, at(0.05, 0.05, 0.55), shell="fewest").shell == "a"


def test_a_batch_of_fewest_changes_roles_pose_by_pose(ball: vx.Model, box: vx.Model):
    # From outside through a face into the middle: none, the box's points, then the ball's.
    poses = np.stack([at(0.0, 0.0, z) for z in np.linspace(0.7, 0.0, 200)])
    batch = vx.contacts_batch(box, ball, None, poses, shell="fewest")
    shells = [contacts.shell for contacts in batch]
    assert {"a", "b"} == set(shells)
    for contacts, pose in zip(batch, poses, strict=True):
        alone = vx.contacts(box, ball, None, pose, shell="fewest")
        assert contacts.shell == alone.shell
        np.testing.assert_array_equal(contacts.points_a, alone.points_a)
        np.testing.assert_array_equal(contacts.shells, np.full(len(contacts), contacts.shell))


# ---- roles by accuracy ---------------------------------------------------------------------------


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
            world = at(0.1, 0.2, 0.3)
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


# ---- both shells ---------------------------------------------------------------------------------


def test_both_shells_are_a_then_b(ball: vx.Model, cube: vx.Model):
    pose, other = at(0.05, 0.02, 0.58) @ turned((1, 2, 3), 0.7), turned((3, 1, 2), 0.1)
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
    pose = at(3.0, -2.0, 0.999) @ turned((0, 0, 1), 0.5)
    other = at(3.0, -2.0, 0.0) @ turned((0, 0, 1), 0.5) @ turned((1, 0, 0), np.pi / 2)
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
    pose = at(0.0051, 0.0049, -0.02) @ turned((1, 0, 0), 0.0)
    found = {shell: vx.collide(slab, needle, None, pose, shell=shell) for shell in ("a", "b")}
    assert found == {"a": False, "b": True}
    assert vx.collide(slab, needle, None, pose, shell="both")
    assert set(vx.contacts(slab, needle, None, pose, shell="both").shells) == {"b"}
