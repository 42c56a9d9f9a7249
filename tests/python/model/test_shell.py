from __future__ import annotations

import gc
import pickle
from copy import deepcopy

import numpy as np
import pytest
import trimesh
import voxshell as vx


def test_points_lie_on_the_surface_with_outward_normals(cube: vx.Model):
    shell = cube.shell
    points = shell.points
    assert points.shape == shell.normals.shape == (len(shell), 3)
    assert points.dtype == shell.normals.dtype == shell.areas.dtype == np.float32
    np.testing.assert_allclose(np.abs(points).max(axis=1), 0.5, atol=1e-6)
    faces = np.abs(shell.normals).argmax(axis=1)
    rows = np.arange(len(shell))
    np.testing.assert_allclose(points[rows, faces] * shell.normals[rows, faces], 0.5, atol=1e-6)
    assert shell.areas.shape == (len(shell),)
    assert shell.areas.astype(float).sum() == pytest.approx(6.0, rel=1e-5)
    assert shell.spacing == 0.05
    assert len({tuple(p) for p in points.tolist()}) == len(shell)


def test_arrays_are_read_only_and_outlive_the_model():
    model = vx.Model.from_mesh(trimesh.creation.box(), resolution=20)
    shell, tree = model.shell, model.shell.tree
    arrays = [shell.points, shell.normals, shell.areas, tree.spheres(2)]
    copies = [array.copy() for array in arrays]
    for array in arrays:
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0
    del model, shell, tree
    gc.collect()
    for array, copy in zip(arrays, copies, strict=True):
        np.testing.assert_array_equal(array, copy)


def test_arrays_are_views(cube: vx.Model):
    assert np.shares_memory(cube.shell.normals, cube.shell.normals)
    assert np.shares_memory(cube.shell.tree.spheres(3), cube.shell.tree.spheres(3))


def test_spheres_enclose_the_points_of_their_segments(fine_bunny: vx.Model):
    tree = fine_bunny.shell.tree
    assert tree.branching == 4
    points = fine_bunny.shell.points.astype(float)
    for level in range(1, tree.levels + 1):
        spheres, segments = tree.spheres(level).astype(float), tree.segments(level)
        assert spheres.shape == (4 ** (level - 1), 4)
        assert segments.shape == (len(points),)
        assert np.all(np.diff(segments) >= 0)
        distances = np.linalg.norm(points - spheres[segments, :3], axis=1)
        assert np.all(distances <= spheres[segments, 3])
        counts = np.bincount(segments, minlength=4 ** (level - 1))
        assert counts.min() >= 1
        assert counts.max() - counts.min() < 16  # whole buckets of 8, the last one apart


def test_segments_nest(coarse_bunny: vx.Model):
    tree = coarse_bunny.shell.tree
    for level in range(1, 12):
        np.testing.assert_array_equal(tree.segments(level), tree.segments(level + 1) // 4)


@pytest.mark.parametrize("level", [0, -1, 2**40, 1.0, "1", None])
def test_a_wrong_level_is_refused(cube: vx.Model, level):
    with pytest.raises(vx.SettingsError, match="level"):
        cube.shell.tree.spheres(level)
    with pytest.raises(vx.SettingsError, match="level"):
        cube.shell.tree.segments(level)


def test_levels_without_spheres_have_segments(cube: vx.Model):
    tree = cube.shell.tree
    with pytest.raises(vx.SettingsError, match=f"from 1 to {tree.levels}, not {tree.levels + 1}"):
        tree.spheres(tree.levels + 1)
    assert len(tree.segments(12)) == len(cube.shell)
    with pytest.raises(vx.SettingsError, match="from 1 to 12, not 13"):
        tree.segments(13)


def test_it_says_what_it_holds(cube: vx.Model):
    text = f"PointShell({len(cube.shell)} points, spacing 0.05 m, {cube.shell.tree.levels} levels)"
    assert repr(cube.shell) == text


def test_every_place_of_the_bunny_is_near_a_point_that_does_not_face_away(
    coarse_bunny: vx.Model, bunny_mesh: trimesh.Trimesh
):
    shell = coarse_bunny.shell
    places, faces = trimesh.sample.sample_surface(bunny_mesh, 4_000, seed=1)
    offsets = np.asarray(places)[:, None, :] - shell.points.astype(float)
    facing = bunny_mesh.face_normals[faces] @ shell.normals.astype(float).T > -0.003
    distances = np.where(facing, np.linalg.norm(offsets, axis=2), np.inf)
    assert distances.min(axis=1).max() <= np.sqrt(3) * shell.spacing * (1 + 1e-6)


def test_parts_of_models_say_how_to_pass_them_on():
    model = vx.Model.from_mesh(trimesh.creation.box(), resolution=5)
    for part, advice in (
        (model.field, "a DistanceField cannot be pickled or copied: pass its model"),
        (model.shell, "pass its model, or its arrays"),
        (model.shell.tree, "a PointSphereTree cannot be pickled or copied: pass its model"),
        (vx.QueryScratch(), "make another one"),
    ):
        for refuse in (pickle.dumps, deepcopy):
            with pytest.raises(vx.InputTypeError, match=advice):
                refuse(part)
