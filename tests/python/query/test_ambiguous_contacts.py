"""Contacts without a nearest place of the surface: `Contacts.ambiguous`."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx
from poses import at, random_poses


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
    apart = vx.contacts(cube, cube, at(0.9), shell="both")
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


def sweep_depths(model: vx.Model, thickness: float):
    """Contacts of a cube that is sunk into a wall, to fractions of half of its thickness."""
    cube = vx.Model.from_mesh(trimesh.creation.box((0.02, 0.02, 0.02)))
    for fraction in (0.02, 0.3, 0.6, 0.85, 0.97, 1.0):
        pose = at(z=0.01 + 0.5 * thickness * (1.0 - fraction))
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
            found = vx.contacts(model, model, at(z=1.0 - depth), shell="both", margin=0.001)
            assert len(found) > 4
            assert not found.ambiguous.any()


def test_ambiguous_contacts_stay_in_manifolds():
    plate = vx.Model.from_mesh(trimesh.creation.box((0.2, 0.2, 0.001)))
    cube = vx.Model.from_mesh(trimesh.creation.box((0.02, 0.02, 0.02)))
    found = vx.contacts(cube, plate, at(z=0.01))
    assert found.manifold().ambiguous.any()
    assert not found.ambiguous.flags.writeable
