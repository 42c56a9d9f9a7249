"""The list of scenes keeps what it promises: enough of them, closed bodies, poses that are apart."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from voxshell.errors import SettingsError
from voxshell_studies.geometry.first_touch import find_first_touch
from voxshell_studies.scenes.geometry import BUILT, COINCIDENT, PAIRS, SCENES, random_rotation
from voxshell_studies.scenes.geometry_bodies import BODIES, make_body, retriangulate, turn_mesh


def test_a_third_of_the_scenes_is_held_out():
    held_out = [scene for scene in SCENES.values() if scene.held_out]
    assert len(SCENES) >= 40
    assert len(held_out) >= len(SCENES) / 3
    assert len(PAIRS) == 12
    assert len(BUILT) >= 30


def test_every_body_is_used_and_known():
    used = {body for scene in SCENES.values() for body in (scene.a, scene.b)}
    assert set(BODIES) == used | {*BUILT} | {*COINCIDENT} | {
        body for pair in PAIRS for body in pair
    }
    with pytest.raises(SettingsError, match="unknown body 'teapot'; valid bodies: ball 30 mm"):
        make_body("teapot")


@pytest.mark.parametrize("body", BODIES)
def test_bodies_are_closed_and_the_same_with_other_triangles(body):
    mesh = make_body(body)
    solid = trimesh.Trimesh(*mesh, process=False)
    assert solid.is_watertight
    assert solid.is_winding_consistent
    assert solid.body_count == 1
    other = trimesh.Trimesh(*retriangulate(mesh), process=False)
    assert len(other.faces) >= len(solid.faces)
    assert other.is_watertight
    assert other.volume == pytest.approx(solid.volume, rel=1e-9)


@pytest.mark.parametrize("name", SCENES)
def test_every_pose_leads_to_a_touch(name):
    scene = SCENES[name]
    for index in range(3):
        pose = scene.place(index)
        assert np.allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-12)
        assert np.array_equal(pose, scene.place(index))
        touch = find_first_touch(
            make_body(scene.a),
            make_body(scene.b),
            pose,
            scene.direction,
            from_here=scene.start == "here",
        )
        assert np.isfinite(touch)
        if scene.start == "here":
            assert touch > 1e-5
    assert all(0.0 < depth < 0.2 for depth in scene.looked_at)


def test_rotations_are_rotations():
    rng = np.random.default_rng(3)
    rotations = np.array([random_rotation(rng) for _ in range(500)])
    assert np.allclose(rotations @ rotations.transpose(0, 2, 1), np.eye(3), atol=1e-12)
    assert np.allclose(np.linalg.det(rotations), 1.0)
    # Uniform ones have no preferred direction.
    assert np.abs(rotations.mean(axis=0)).max() < 0.1
    mesh = make_body("cube 50 mm")
    turned = turn_mesh(mesh, rotations[0])
    assert np.allclose(turned.vertices[3], rotations[0] @ mesh.vertices[3])
