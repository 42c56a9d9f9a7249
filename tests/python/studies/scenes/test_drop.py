from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell_studies.scenes import bunny
from voxshell_studies.scenes.drop import (
    METHODS,
    DropSettings,
    build_shapes,
    build_world,
    compute_start_pose,
)

SETTINGS = DropSettings(
    size=0.2, up="z", fine_points=2000, coarse_points=300, voxel_size=0.01, height=0.1
)


@pytest.mark.parametrize("up", ["x", "y", "z"])
def test_start_pose_is_upright_over_the_ground(up):
    mesh = trimesh.creation.cone(radius=0.05, height=0.2)  # tip along +z
    mesh.apply_translation((0.3, 0.4, 0.5))
    axes = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}
    mesh.apply_transform(trimesh.geometry.align_vectors((0, 0, 1), axes[up]))
    settings = DropSettings(up=up, height=0.25)
    pose = compute_start_pose(vx.Mesh(mesh.vertices, mesh.faces), settings)
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1.0)
    upright = trimesh.transform_points(mesh.vertices, pose)
    assert upright[:, 2].min() == pytest.approx(0.25)
    assert upright[:, 2].max() == pytest.approx(0.45)
    tip = upright[upright[:, 2].argmax()]
    np.testing.assert_allclose(tip[:2], 0.0, atol=1e-9)


@pytest.fixture(scope="module")
def shapes():
    """Those of a torus, which take seconds to decompose."""
    return build_shapes(trimesh.creation.torus(major_radius=3, minor_radius=1), SETTINGS)


def test_every_method_starts_at_the_same_pose(shapes):
    assert set(shapes.bodies) == {method.key for method in METHODS}
    starts = [build_world(shapes, method, SETTINGS)[1].pose for method in METHODS]
    for start in starts[1:]:
        np.testing.assert_allclose(start, starts[0], atol=1e-12)


def test_only_what_is_wanted_is_built():
    wanted = tuple(method for method in METHODS if method.key == "hull")
    shapes = build_shapes(trimesh.creation.box(), SETTINGS, wanted)
    assert "decomposition" not in shapes.bodies
    assert "voxels" not in shapes.grounds


def test_decomposition_has_eight_hulls_of_at_most_100_vertices(shapes):
    hulls = shapes.bodies["decomposition"].hulls
    assert 2 <= len(hulls) <= 8
    assert max(len(hull) for hull in hulls) <= 100


def test_wrong_settings_are_refused():
    for wrong in ({"size": 0.0}, {"rate": -1.0}, {"height": float("nan")}, {"fine_points": 0}):
        with pytest.raises(vx.SettingsError, match=next(iter(wrong))):
            DropSettings(**wrong)
    box = trimesh.creation.box()
    with pytest.raises(vx.MeshError, match="finite"):
        build_shapes((box.vertices * float("nan"), box.faces), SETTINGS)


def test_missing_bunny_says_how_to_get_it(monkeypatch, tmp_path):
    monkeypatch.setattr(bunny, "_DEBIAN_PATH", tmp_path / "bunny.obj")
    with pytest.raises(vx.MeshError, match="apt install glmark2-data"):
        bunny.find_bunny()
