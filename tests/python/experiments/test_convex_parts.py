from __future__ import annotations

import numpy as np
import pytest
import trimesh
from voxshell.comparison_shapes import ConvexDecomposition
from voxshell.errors import MissingExtraError
from voxshell.experiments import convex_parts
from voxshell.experiments.convex_parts import RECIPES, split
from voxshell.meshes import read_mesh


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
    monkeypatch.setattr(convex_parts, "_run_vhacd", lambda *_: pytest.fail("split again"))
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
