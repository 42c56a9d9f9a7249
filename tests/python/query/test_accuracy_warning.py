from __future__ import annotations

import re
import warnings

import pytest
import trimesh
import voxshell as vx
from poses import at
from voxshell.query.accuracy_warning import Missing


def test_an_automatic_pair_that_may_miss_much_warns_once(cube: vx.Model):
    sparse = vx.Model.from_mesh(trimesh.creation.box(), voxel_size=0.05, target_points=100)
    with pytest.warns(vx.AccuracyWarning, match="may be missed up to .* mm deep") as caught:  # noqa: PT031
        vx.contacts(sparse, cube)
        vx.collide(sparse, cube, at(x=3.0))
        vx.distance(sparse, cube)
        vx.contacts_batch(sparse, cube)
    assert len(caught) == 1
    assert caught[0].filename == __file__
    text = str(caught[0].message)
    assert text.startswith("contacts between a (12 triangles) and b (12 triangles) may be missed")
    assert "; build a and b to a tolerance, without voxel_size= and resolution= (" in text
    assert "robots" not in text
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
        vx.AccuracyWarning,
        match="of the thinner wall of 0.5 mm; build a to a tolerance below 0.0002 m",
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
    assert str(Missing(0.0005, 0.002, "the thinner wall")) == (
        "may be missed up to 0.5 mm deep, 25 % of the thinner wall of 2 mm"
    )
    assert str(Missing(0.005, 1e-7, "the thinner wall")) == (
        "may be missed up to 5 mm deep, more than the thinner wall of 0.0001 mm"
    )


def test_a_warning_of_a_world_names_bodies_and_the_model_to_refine():
    coarse = vx.Model.from_mesh(trimesh.creation.box(), voxel_size=0.05, target_points=100)
    fine = vx.Model.from_mesh(trimesh.creation.box())
    world = vx.World()
    world.add(fine, mass=0, name="slab")
    world.add(coarse, pose=(0, 0, 2), name="crate")
    with pytest.warns(vx.AccuracyWarning) as caught:
        world.step()
    text = str(caught[0].message)
    assert re.match("contacts between '(crate|slab)' and '(crate|slab)' may be missed up to", text)
    assert "; build the model of 'crate' to a tolerance, without voxel_size= and" in text
    world.add(coarse, pose=(0, 0, 4), name="other")
    for side in (0.9, 0.8):
        mesh = trimesh.creation.box((side, side, side))
        world.add(
            vx.Model.from_mesh(mesh, voxel_size=0.05, target_points=100), pose=(9 * side, 9, 9)
        )
    with pytest.warns(vx.AccuracyWarning, match=r"\(the worst of \d+ pairs of models\); build the"):
        world.step()
