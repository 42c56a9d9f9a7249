"""Distances of fields against the exact distance to the mesh."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import parts
import trimesh
import voxshell as vx
from voxshell_studies.peers.protocol import load_library

from soak.task import CORE, Check, Outcome, Task, Totals, UnavailableError

POINTS = 20_000  # a case: half of them within two voxels of the surface, the others anywhere
ROUNDING = 1e-6  # of the body's longest side: single precision

Distance = Callable[[np.ndarray], np.ndarray]


def turned_box() -> tuple[trimesh.Trimesh, Distance]:
    """Closed form, turned against the grid."""
    pose = np.eye(4)
    pose[:3, :3] = parts.random_rotation(np.random.default_rng(3))
    half = np.array([0.1, 0.06, 0.02])
    mesh = trimesh.creation.box(2 * half, pose)

    def distance(points: np.ndarray) -> np.ndarray:
        beyond = np.abs(points @ pose[:3, :3]) - half
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
        return outside + np.minimum(beyond.max(axis=1), 0.0)

    return mesh, distance


def by_libigl(mesh: trimesh.Trimesh) -> tuple[trimesh.Trimesh, Distance]:
    """Unsigned distance, negative where the winding number rounds to 1."""
    igl = load_library("igl", "libigl")
    vertices = np.ascontiguousarray(mesh.vertices, dtype=np.float64)
    faces = np.ascontiguousarray(mesh.faces, dtype=np.int64)

    def distance(points: np.ndarray) -> np.ndarray:
        unsigned = np.sqrt(igl.point_mesh_squared_distance(points, vertices, faces)[0])
        winding = np.asarray(igl.winding_number(vertices, faces, points))
        return np.where(np.abs(winding) < 0.5, unsigned, -unsigned)

    return mesh, distance


def as_mesh(part: parts.Part) -> trimesh.Trimesh:
    return trimesh.Trimesh(*parts.solids.as_arrays(part.solid))


BODIES = {
    "box": turned_box,
    "ring": lambda: by_libigl(trimesh.creation.torus(0.1, 0.03, 32, 16)),
    "bolt": lambda: by_libigl(as_mesh(parts.bolt())),
    "pinion": lambda: by_libigl(as_mesh(parts.pinion())),
}
SETTINGS: tuple[dict[str, Any], ...] = (
    {"resolution": 30},
    {"resolution": 100},
    {"tolerance": None},
)


@cache
def body(name: str) -> tuple[trimesh.Trimesh, Distance]:
    return BODIES[name]()


@cache
def model(name: str, setting: int) -> vx.Model:
    return vx.Model.from_mesh(body(name)[0], **SETTINGS[setting])


def prepare() -> Check:
    try:
        load_library("igl", "libigl")
    except vx.MissingExtraError:
        raise UnavailableError(
            "libigl is missing; run ./dev soak, which installs tools/requirements-soak.txt"
        ) from None

    def check(case: int) -> Outcome:
        setting, number = case % len(SETTINGS), case // len(SETTINGS) % len(BODIES)
        name = list(BODIES)[number]
        mesh, distance = body(name)
        field = model(name, setting).field
        rng = np.random.default_rng([case, 3])
        points = place(mesh, field.voxel_size, rng)
        exact, found = distance(points), field.sample(points)
        error = np.abs(found - exact)
        slack = ROUNDING * float(mesh.extents.max())
        near = np.abs(exact) <= 2.0 * field.voxel_size
        worst = float(error[near].max() / field.interpolation_error)
        assert worst <= 1.0 + slack / field.interpolation_error, (
            f"{name}, {SETTINGS[setting]}: off by {error[near].max():g} m near the surface, and the "
            f"bound is {field.interpolation_error:g} m"
        )
        clear = np.abs(exact) > field.voxel_size
        wrong = clear & (np.sign(found) != np.sign(exact))
        assert not wrong.any(), (
            f"{name}, {SETTINGS[setting]}: wrong sign at {points[wrong][0].tolist()}, where the "
            f"distance is {exact[wrong][0]:g} m and not {found[wrong][0]:g}"
        )
        return Outcome(
            POINTS,
            {"near": float(near.sum()), "inside": float((exact < 0).sum())},
            {"worst": worst},
        )

    return check


def place(mesh: trimesh.Trimesh, voxel: float, rng: np.random.Generator) -> np.ndarray:
    corners = mesh.triangles[
        rng.choice(len(mesh.faces), POINTS // 2, p=mesh.area_faces / mesh.area)
    ]
    weights = rng.dirichlet((1.0, 1.0, 1.0), POINTS // 2)
    on_surface = np.einsum("ij,ijk->ik", weights, corners)
    near = on_surface + rng.uniform(-1.15, 1.15, on_surface.shape) * voxel
    low, high = mesh.bounds
    anywhere = rng.uniform(low - 8 * voxel, high + 8 * voxel, (POINTS // 2, 3))
    return np.concatenate([near, anywhere])


def describe(totals: Totals) -> str:
    near, inside = (totals.tallies[name] / totals.count for name in ("near", "inside"))
    return (
        f"{near:.0%} within two voxels, {inside:.0%} inside; worst error "
        f"{totals.peaks['worst']:.0%} of the bound"
    )


TASK = Task(
    promise="Field values are within the stated bound, and their sign is right beyond one voxel",
    oracle="a closed form, and libigl's distance and winding number",
    unit="points",
    target=10_000_000,
    prepare=prepare,
    sources=(*CORE, "tests/python/support/parts.py"),
    describe=describe,
)
