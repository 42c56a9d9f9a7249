from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx
from poses import at


@pytest.fixture(scope="module")
def coarse() -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.icosphere(4, radius=0.1), voxel_size=0.02)


@pytest.fixture(scope="module")
def fine() -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.icosphere(4, radius=0.1), voxel_size=0.005)


def test_bounds_are_symmetric(coarse, fine):
    forth, back = vx.contact_bounds(coarse, fine), vx.contact_bounds(fine, coarse)
    assert forth[:2] == back[:2]
    assert forth.miss == back.miss
    assert {"a": "b", "b": "a", "both": "both"}[forth.shell] == back.shell


def test_finer_models_have_narrower_bounds(coarse, fine):
    plane = vx.Plane()
    assert vx.contact_bounds(fine, plane).overlap < vx.contact_bounds(coarse, plane).overlap
    assert vx.contact_bounds(fine, plane).miss < vx.contact_bounds(coarse, plane).miss


def test_the_shell_that_is_named_is_the_shell(coarse, fine):
    for shell in ("a", "b", "both"):
        assert vx.contact_bounds(coarse, fine, shell=shell).shell == shell


def test_a_contact_is_certain_from_the_overlap_on_and_none_beyond_the_clearance(coarse, fine):
    bounds = vx.contact_bounds(coarse, fine)
    for direction in ((1.0, 0.0, 0.0), (0.0, 0.6, 0.8)):
        # The balls have radius 0.1 but for their facets, which stay within 0.3 mm.
        for gap, touches in ((-bounds.overlap - 3e-4, True), (bounds.clearance + 3e-4, False)):
            place = [(0.2 + gap) * it for it in direction]
            assert vx.collide(coarse, fine, a_pose=place) is touches


def test_two_shapes_without_a_shell_have_no_bounds():
    with pytest.raises(vx.SettingsError):
        vx.contact_bounds(vx.Plane(), vx.Sphere(0.1))


def test_bounds_are_those_of_the_meshes():
    """Closed forms: how far balls are from touching."""
    ball = vx.Model.from_mesh(trimesh.creation.icosphere(4, radius=0.02))
    slab = vx.Model.from_mesh(trimesh.creation.box((1.0, 1.0, 0.1)))
    bounds = vx.contact_bounds(ball, slab)
    turned = vx.contact_bounds(slab, ball)
    assert (bounds.overlap, bounds.clearance) == (turned.overlap, turned.clearance)
    # The icosphere's own vertices are on the ball, one of them below its center.
    low = 0.05 - ball.mesh.vertices[:, 2].min()
    assert 0.0 < bounds.clearance <= bounds.overlap < 2e-4
    assert vx.collide(ball, slab, at(0.1, 0.2, low - bounds.overlap))
    assert not vx.collide(ball, slab, at(0.1, 0.2, low + bounds.clearance))
    uniform = vx.Model.from_mesh(trimesh.creation.icosphere(4, radius=0.02), voxel_size=0.001)
    error = uniform.field.interpolation_error
    assert vx.contact_bounds(uniform, uniform, shell="both").overlap == pytest.approx(
        np.sqrt(3.0) * uniform.shell.spacing + error
    )
