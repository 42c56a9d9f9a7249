from __future__ import annotations

import warnings

import pytest
import trimesh
import voxshell as vx
from poses import moved
from voxshell.query.accuracy_warning import Missing


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
    assert "load robots with tolerance=0.0002)" in str(caught[0].message)
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


def test_what_is_more_than_a_wall_is_told_without_a_percentage():
    assert str(Missing(0.0005, 0.002, "the thinner wall", "a")) == (
        "may miss 0.5 mm in depth with a's points, 25 % of the thinner wall of 2 mm"
    )
    assert str(Missing(0.005, 1e-7, "the thinner wall", "both")) == (
        "may miss 5 mm in depth with both bodies' points, more than the thinner wall of 0.0001 mm"
    )
