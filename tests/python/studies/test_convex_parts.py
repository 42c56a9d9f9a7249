from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.errors import MissingExtraError
from voxshell.model.meshes import read_mesh
from voxshell.simulation.comparison_shapes import ConvexDecomposition
from voxshell_studies import convex_parts
from voxshell_studies.convex_parts import RECIPES, split


@pytest.fixture
def kept(tmp_path, monkeypatch):
    monkeypatch.setenv("VOXSHELL_CACHE_DIR", str(tmp_path / "models"))
    monkeypatch.setenv("VOXSHELL_CACHE_SIZE", "1GB")


def test_parts_are_made_once(kept, monkeypatch):
    box = read_mesh(trimesh.creation.box())
    first = split(box, RECIPES["vhacd"])
    assert len(first.hulls) == 1
    corners = ConvexDecomposition(first.hulls).mesh.vertices
    np.testing.assert_allclose(np.ptp(corners, axis=0), 1.0, atol=0.1)
    monkeypatch.setitem(convex_parts._SPLITTERS, "vhacdx", lambda *_: pytest.fail("split again"))
    second = split(box, RECIPES["vhacd"])
    np.testing.assert_array_equal(first.hulls[0], second.hulls[0])
    with pytest.raises(pytest.fail.Exception):
        split(box, RECIPES["vhacd-64"])  # other settings, other parts


def test_missing_library_is_named(kept, monkeypatch):
    def miss(name):
        raise ImportError(name)

    monkeypatch.setattr(convex_parts, "import_module", miss)
    with pytest.raises(MissingExtraError, match="CoACD is not installed: pip install coacd"):
        split(read_mesh(trimesh.creation.box()), RECIPES["coacd"])


def test_hacd_splits_a_concave_body(kept):
    if RECIPES["hacd"].version is None:
        pytest.skip("built without HACD")
    torus = vx.Model.from_mesh(trimesh.creation.torus(1.0, 0.3, 24, 16), resolution=50).mesh
    hulls = split(torus, RECIPES["hacd"]).hulls
    assert len(hulls) >= 8
    assert max(len(hull) for hull in hulls) <= convex_parts.HULL_VERTICES
    # They cover the ring, and leave the hole open.
    np.testing.assert_allclose(np.ptp(np.concatenate(hulls), axis=0), (2.6, 2.6, 0.6), atol=0.05)
    middle = vx.World(gravity=(0, 0, 0))
    ring = middle.add(ConvexDecomposition(hulls, margin=0.0), mass=0.0)
    assert not middle.overlaps(ring, middle.add(vx.Sphere(0.5)))
