from __future__ import annotations

import numpy as np
import pytest
import trimesh
from voxshell.model.meshes import read_mesh
from voxshell.robots.mjcf.mesh_matter import weigh_mesh


@pytest.mark.parametrize("kind", ["legacy", "exact", "convex"])
def test_a_convex_body_has_its_matter(kind):
    box = trimesh.creation.box((0.2, 0.4, 0.6))
    box.apply_translation((1, 2, 3))
    matter = weigh_mesh(read_mesh(box), kind)
    assert matter.mass == pytest.approx(0.048)
    np.testing.assert_allclose(matter.center_of_mass, (1, 2, 3))
    expected = 0.048 / 12 * np.array([0.52, 0.4, 0.2])
    np.testing.assert_allclose(matter.inertia, np.diag(expected), atol=1e-12)


def test_a_shell_weighs_its_area():
    ball = trimesh.creation.icosphere(4, radius=0.5)
    matter = weigh_mesh(read_mesh(ball), "shell")
    assert matter.mass == pytest.approx(ball.area)
    np.testing.assert_allclose(matter.inertia, np.eye(3) * ball.area / 6, rtol=5e-3, atol=1e-9)


def test_legacy_counts_what_is_turned_over():
    """The sum of all pyramids without their sign, as MuJoCo's default has it."""
    box = trimesh.creation.box()
    faces = box.faces.copy()
    faces[0] = faces[0, ::-1]
    turned = read_mesh((box.vertices, faces))
    assert weigh_mesh(turned, "legacy").mass == pytest.approx(1.0)
    assert weigh_mesh(turned, "exact").mass < 0.9


def test_a_flat_or_empty_mesh_has_no_matter():
    flat = read_mesh(([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]))
    point = read_mesh(([(0, 0, 0)] * 3, [(0, 1, 2)]))
    for mesh in (flat, point):
        assert weigh_mesh(mesh, "legacy").mass == 0.0
