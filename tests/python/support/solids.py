"""Closed bodies with known shapes, made with manifold3d. Millimeters are written as 1e-3."""

from __future__ import annotations

from pathlib import Path

import manifold3d as m3
import numpy as np
import trimesh


def as_arrays(solid: m3.Manifold) -> tuple[np.ndarray, np.ndarray]:
    """Vertices, (n, 3) float64, and triangles, (m, 3), for voxshell and coal."""
    mesh = solid.to_mesh64()
    return np.array(mesh.vert_properties[:, :3]), np.array(mesh.tri_verts, dtype=np.uint32)


def simplified_bunny(path: Path, length: float, tolerance: float) -> m3.Manifold:
    """The Stanford bunny, `length` along its longest side, about the center of its bounds."""
    mesh = trimesh.load_mesh(path, process=False)
    mesh.merge_vertices()
    mesh.apply_translation(-mesh.bounds.mean(axis=0))
    mesh.apply_scale(length / mesh.extents.max())
    solid = m3.Manifold(
        m3.Mesh64(
            np.asarray(mesh.vertices, dtype=np.float64), np.asarray(mesh.faces, dtype=np.uint64)
        )
    )
    assert solid.status() == m3.Error.NoError
    return solid.simplify(tolerance)


def box(extents: tuple[float, float, float]) -> m3.Manifold:
    return m3.Manifold.cube(extents, center=True)


def ball(radius: float, segments: int = 48) -> m3.Manifold:
    return m3.Manifold.sphere(radius, segments)
