"""Thin convex bodies of ten corners, 2 cm long."""

from __future__ import annotations

import numpy as np
import trimesh


def make_splinter(seed: int) -> trimesh.Trimesh:
    """A closed one."""
    corners = np.random.default_rng(100 + seed).normal(size=(10, 3))
    corners /= np.linalg.norm(corners, axis=1)[:, None]
    return trimesh.convex.convex_hull(corners * (0.01, 0.0015, 0.0013))


def make_open_splinter(seed: int) -> trimesh.Trimesh:
    """One without its highest face."""
    mesh = make_splinter(seed)
    mesh.update_faces(np.arange(len(mesh.faces)) != np.argmax(mesh.triangles_center[:, 2]))
    return mesh
