"""Real meshes with faults are built with a warning that counts and locates them, or refused so.

Which of the two is stated for each. None hangs, crashes or becomes a field that is inside out.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import dirty_meshes
import numpy as np
import pytest
import trimesh
from build_and_tell import build_and_tell
from mesh_judges import is_farther, make_surface

RESOLUTION = 40
HANGS_AFTER = 120.0  # seconds; takes one or two

REFUSED = None


@dataclass(frozen=True)
class Expected:
    """What is to come of a mesh."""

    what_is_wrong: str
    edges: tuple[int, int, int]  # of one triangle, of more than two, of two that disagree
    confidence: float | None  # that is told of its inside, at any voxel size; or refused


EDGE_FAULTS = {
    "a1/meshes/thigh_mirror.obj": Expected("all three kinds", (171, 21, 1), 1.0),
    "franka_panda/meshes/collision/link6.obj": Expected("open", (586, 0, 0), 0.591),
    "franka_panda/meshes/visual/hand.obj": Expected(
        "open and non-manifold, many bodies", (176, 12, 0), 0.975
    ),
    "gripper/meshes/l_gripper_tip_scaled.stl": Expected("a triangle is missing", (3, 0, 0), 1.0),
    "husky/meshes/user_rail.stl": Expected("non-manifold, closed", (0, 74, 0), 1.0),
    "husky/meshes/wheel.stl": Expected("open", (1234, 0, 0), 1.0),
    "kuka_iiwa/meshes/link_7.stl": Expected(
        "cracks between vertices that nearly agree", (284, 0, 0), 1.0
    ),
    "random_urdfs/121/121.obj": Expected("non-manifold", (0, 7, 0), 1.0),
    "lego/lego_vhacd.obj": Expected("convex parts that share edges", (0, 16, 0), 1.0),
    "mini_cheetah/meshes/mini_upper_link.obj": Expected(
        "non-manifold, and wrongly oriented", (0, 217, 3), 0.999
    ),
    "objects/mug.obj": Expected("an open seam", (24, 0, 0), 0.999),
    "objects/mug_col.obj": Expected("convex parts that share edges", (0, 96, 0), 1.0),
    "quadruped/microtaur/xavier.stl": Expected("non-manifold, many bodies", (0, 15, 0), 1.0),
    "racecar/meshes/hokuyo.obj": Expected("all three kinds", (57, 32, 8), 0.973),
    "terrain.obj": Expected("a sheet: it has no inside", (116, 0, 0), REFUSED),
    "toys/cube.obj": Expected("bodies that share edges", (0, 18, 0), 1.0),
    "xarm/xarm_description/meshes/xarm6/visual/link5.stl": Expected(
        "open, many bodies", (43, 1, 0), 1.0
    ),
}
NOT_FINITE = "random_urdfs/168/168.obj"  # a vertex is not a number
CLOSED = "random_urdfs/000/000.obj"


@pytest.fixture(scope="module")
def folder() -> Path:
    return dirty_meshes.fetch([*EDGE_FAULTS, NOT_FINITE, CLOSED])


def load(path: Path) -> trimesh.Trimesh:
    mesh = trimesh.load(path, force="mesh", process=False)
    assert isinstance(mesh, trimesh.Trimesh)
    return mesh


def build(path: Path, places: np.ndarray, resolution: int = RESOLUTION) -> dict[str, Any]:
    """What build_and_tell says; a crash or a hang fails."""
    return build_and_tell(path, resolution, places, HANGS_AFTER)


def far_places(mesh: trimesh.Trimesh) -> np.ndarray:
    """Around the mesh, on spheres of one and a half and five times its size."""
    rng = np.random.default_rng(8)
    directions = rng.normal(size=(40, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    size = float(np.linalg.norm(mesh.extents))
    return mesh.bounds.mean(axis=0) + size * np.concatenate([1.5 * directions, 5.0 * directions])


def certain_places(mesh: trimesh.Trimesh, voxel_size: float) -> tuple[np.ndarray, np.ndarray]:
    """Places that are certainly inside, and certainly outside: winding number and distance say so."""
    rng = np.random.default_rng(9)
    places = rng.uniform(*mesh.bounds, size=(150, 3))
    triangles = np.asarray(mesh.triangles)
    windings = dirty_meshes.winding_numbers(places, triangles)
    surface = make_surface(mesh.vertices, mesh.faces)
    away = np.array([is_farther(place, surface, 2.0 * voxel_size) for place in places])
    return (
        places[(np.abs(windings - 1.0) < 0.05) & away],
        places[(np.abs(windings) < 0.05) & away],
    )


@pytest.mark.parametrize("name", EDGE_FAULTS)
def test_faulty_edges_are_counted_and_located(name: str, folder: Path):
    mesh = load(folder / name)
    expected = EDGE_FAULTS[name]
    faults = dirty_meshes.find_faults(mesh.vertices, mesh.faces)
    assert expected.edges == (
        faults.open_edges,
        faults.non_manifold_edges,
        faults.flipped_edges,
    )
    far = far_places(mesh)
    inside, outside = certain_places(mesh, mesh.extents.max() / RESOLUTION)
    told = build(folder / name, np.concatenate([far, inside, outside]))

    if expected.confidence is REFUSED:
        assert told.get("error") == "MeshError", "built"
        message = told["refused"]
        assert "the mesh's inside is ambiguous" in message
        assert "repair it" in message
    else:
        assert "warnings" in told, told["refused"]
        (message,) = told["warnings"]
        assert told["confidence"] == pytest.approx(expected.confidence, abs=0.005)
        far_away, within, without = np.split(
            np.array(told["distances"]), [len(far), len(far) + len(inside)]
        )
        assert (far_away > 0.0).all(), "inside out"
        assert (within < 0.0).all()
        assert (without > 0.0).all()
        assert told["shell"] > 0

    counts = [
        re.search(rf"(\d+) {fault}\b", message)
        for fault in ("open", "non-manifold", "wrongly oriented")
    ]
    assert any(counts), message
    assert tuple(int(count[1]) if count else 0 for count in counts) == expected.edges
    place = re.search(r"near \[([^\]]+)\]", message)
    assert place, message
    located = np.array([float(number) for number in place[1].split(",")])
    gaps = np.linalg.norm(faults.places - located, axis=1)
    assert gaps.min() <= 1e-3 * np.abs(mesh.bounds).max(), "no fault is there"


def test_a_vertex_that_is_no_number_is_refused_by_its_name(folder: Path):
    mesh = load(folder / NOT_FINITE)
    wrong = np.flatnonzero(~np.isfinite(mesh.vertices).all(axis=1))
    told = build(folder / NOT_FINITE, np.zeros((1, 3)))
    assert told["error"] == "MeshError"
    named = re.search(r"not finite \(first: vertex (\d+)\)", told["refused"])
    assert named, told["refused"]
    assert int(named[1]) in wrong


def test_an_inverted_mesh_is_turned_with_a_warning(folder: Path, tmp_path: Path):
    mesh = load(folder / CLOSED)
    assert mesh.volume > 0.0
    mesh.invert()
    path = tmp_path / "inverted.obj"
    mesh.export(path)
    told = build(path, far_places(mesh))
    (warning,) = told["warnings"]
    assert "inside out as a whole" in warning
    assert (np.array(told["distances"]) > 0.0).all()


def test_the_mesh_decides_whether_its_inside_is_in_doubt_and_not_the_voxels(folder: Path):
    sheet, part = "terrain.obj", "racecar/meshes/hokuyo.obj"
    for resolution in (10, 160):
        assert (
            "inside is ambiguous" in build(folder / sheet, np.zeros((1, 3)), resolution)["refused"]
        )
        told = build(folder / part, np.zeros((1, 3)), resolution)
        assert told["confidence"] == pytest.approx(EDGE_FAULTS[part].confidence, abs=0.005)


def test_a_clean_mesh_of_the_same_source_is_built_without_a_word(folder: Path):
    mesh = load(folder / CLOSED)
    assert len(dirty_meshes.find_faults(mesh.vertices, mesh.faces).places) == 0
    far = far_places(mesh)
    inside, outside = certain_places(mesh, mesh.extents.max() / RESOLUTION)
    assert len(inside) > 5
    assert len(outside) > 5
    told = build(folder / CLOSED, np.concatenate([far, outside, inside]))
    assert told["warnings"] == []
    assert (np.array(told["distances"])[: -len(inside)] > 0.0).all()
    assert (np.array(told["distances"])[-len(inside) :] < 0.0).all()
