from __future__ import annotations

import gc
import pickle

import numpy as np
import pytest
import trimesh
import voxshell as vx

ARRAYS = {
    "points_a": (3,),
    "points_b": (3,),
    "normals": (3,),
    "depths": (),
    "ids": (),
    "segments": (),
}


@pytest.fixture
def contacts(cube: vx.Model) -> vx.Contacts:
    """Of a tilted cube in the ground: every depth is another."""
    pose = trimesh.transformations.rotation_matrix(0.02, (1.0, 0.3, 0.0), (0.5, 0.5, -0.5))
    return vx.contacts(cube, vx.Plane(offset=-0.48), a_pose=pose, level=4)


def test_arrays_are_parallel_and_read_only(contacts: vx.Contacts):
    assert len(contacts) > 100
    for name, row in ARRAYS.items():
        array = getattr(contacts, name)
        assert array.shape == (len(contacts), *row)
        assert array.dtype == (np.int64 if name in ("ids", "segments") else np.float64)
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0


def test_arrays_outlive_their_contacts_and_the_model():
    model = vx.Model.from_mesh(trimesh.creation.box(), resolution=20)
    contacts = vx.contacts(model, vx.Plane(offset=-0.48), level=2)
    arrays = {name: getattr(contacts, name) for name in ARRAYS}
    copies = {name: array.copy() for name, array in arrays.items()}
    again = contacts.manifold()
    del contacts, model
    gc.collect()
    filler = [np.full(100_000, 7.0) for _ in range(20)]  # would land on freed memory
    for name, array in arrays.items():
        np.testing.assert_array_equal(array, copies[name])
    assert len(again.deepest_per_segment()) > 0
    del filler


def test_no_contacts_are_empty_arrays(ball: vx.Model):
    contacts = vx.contacts(ball, vx.Plane(offset=-1.0), level=3)
    for subset in (contacts, contacts.manifold(), contacts.deepest_per_segment()):
        assert len(subset) == 0
        for name, row in ARRAYS.items():
            assert getattr(subset, name).shape == (0, *row)
    assert repr(contacts) == "Contacts(0 of a's points)"


def test_contacts_are_a_sequence_of_single_ones(contacts: vx.Contacts):
    listed = list(contacts)
    assert len(listed) == len(contacts) > 100
    for index in (0, 7, np.int64(3), -1, -len(contacts)):
        for contact in (contacts[index], listed[index]):
            for one, name in (
                ("point_a", "points_a"),
                ("point_b", "points_b"),
                ("normal", "normals"),
            ):
                np.testing.assert_array_equal(getattr(contact, one), getattr(contacts, name)[index])
            assert contact.depth == contacts.depths[index]
            assert contact.id == contacts.ids[index]
            assert contact.segment == contacts.segments[index]
            assert contact.shell == contacts.shells[index] == "a"
            assert [type(it) for it in (contact.depth, contact.id, contact.shell)] == [
                float,
                int,
                str,
            ]
    assert max(contacts, key=lambda contact: contact.depth).depth == contacts.depths.max()


def test_wrong_indices_of_contacts_are_refused(contacts: vx.Contacts, ball: vx.Model):
    for index in (len(contacts), -len(contacts) - 1):
        with pytest.raises(IndexError, match=f"contact {index} of {len(contacts)}"):
            contacts[index]
    for wrong in (slice(2), contacts.depths > 0, "depths", 1.0):
        with pytest.raises(vx.InputTypeError, match=r"take slices and masks of the arrays"):
            contacts[wrong]  # pyright: ignore[reportArgumentType]
    assert list(vx.contacts(ball, vx.Plane(offset=-9.0))) == []


def test_it_says_what_it_holds(contacts: vx.Contacts):
    assert repr(contacts).startswith(f"Contacts({len(contacts)} of a's points, deepest 0.0")


def test_segments_are_the_clusters_of_the_level(cube: vx.Model, contacts: vx.Contacts):
    expected = cube.shell.tree.segments(4)[contacts.ids]
    np.testing.assert_array_equal(contacts.segments, expected)
    assert len(set(contacts.segments.tolist())) > 4


@pytest.mark.parametrize("level", [None, 1])
def test_without_a_level_there_is_one_segment(cube: vx.Model, level: int | None):
    contacts = vx.contacts(cube, vx.Plane(offset=-0.49), level=level)
    np.testing.assert_array_equal(contacts.segments, np.zeros(len(contacts)))
    assert len(contacts.deepest_per_segment()) == 1


def test_the_deepest_of_each_segment(contacts: vx.Contacts):
    deepest = contacts.deepest_per_segment()
    segments = sorted(set(contacts.segments.tolist()))
    expected = []
    for segment in segments:
        members = np.flatnonzero(contacts.segments == segment)
        expected.append(members[contacts.depths[members].argmax()])
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(deepest, name), getattr(contacts, name)[expected])
    assert deepest.shell == contacts.shell


def test_a_manifold_is_the_deepest_first_and_spans_the_area(contacts: vx.Contacts):
    manifold = contacts.manifold(4)
    assert len(manifold) == 4
    assert manifold.depths[0] == contacts.depths.max()
    where = [contacts.ids.tolist().index(i) for i in manifold.ids]
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(manifold, name), getattr(contacts, name)[where])
    corners = manifold.points_a[:, :2]
    assert np.ptp(corners, axis=0).min() > 0.8  # the cube is 1 m wide


@pytest.mark.parametrize("max_points", [1, 2, 3, 4])
def test_smaller_manifolds_are_the_first_of_larger_ones(contacts: vx.Contacts, max_points: int):
    np.testing.assert_array_equal(
        contacts.manifold(max_points).ids, contacts.manifold().ids[:max_points]
    )


def test_the_segments_of_a_manifold(contacts: vx.Contacts):
    # Its ids do not ascend, which the core's choice per segment relies on.
    manifold = contacts.manifold()
    assert np.any(np.diff(manifold.ids) < 0)
    deepest = manifold.deepest_per_segment()
    assert sorted(deepest.segments.tolist()) == sorted(set(manifold.segments.tolist()))
    assert np.all(np.diff(deepest.ids) > 0)


@pytest.mark.parametrize("max_points", [0, 5, -1, 2**70, 1.5, "4", None])
def test_a_wrong_size_of_a_manifold_is_refused(contacts: vx.Contacts, max_points):
    with pytest.raises(vx.SettingsError, match="max_points"):
        contacts.manifold(max_points)


def test_contacts_say_that_their_arrays_are_pickled_instead():
    ball = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.1), resolution=20)
    plane = vx.Plane(offset=-0.09)
    for found in (vx.contacts(ball, plane), vx.contacts_batch(ball, plane, [(0, 0, 0)])):
        with pytest.raises(vx.InputTypeError, match=r"pass the arrays.*contacts\.depths"):
            pickle.dumps(found)
