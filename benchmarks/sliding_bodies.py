"""Bodies of visible facets or of a scan, and a slab that they slide on."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import trimesh
import voxshell as vx
from trimesh.creation import box, cylinder, icosphere, torus
from trimesh.transformations import rotation_matrix

BUNNY = Path("/usr/share/glmark2/models/bunny.obj")


def _cube() -> trimesh.Trimesh:
    return box((0.1, 0.1, 0.1))


def _mug() -> trimesh.Trimesh:
    outside = cylinder(0.04, 0.09, sections=64).apply_translation((0, 0, 0.045))
    inside = cylinder(0.034, 0.09, sections=64).apply_translation((0, 0, 0.051))
    handle = torus(0.025, 0.005).apply_transform(rotation_matrix(np.pi / 2, (0, 1, 0)))
    handle.apply_translation((0, 0.045, 0.045))
    return trimesh.boolean.difference([trimesh.boolean.union([outside, handle]), inside])


def _can() -> trimesh.Trimesh:
    return cylinder(0.033, 0.1, sections=48)


def _bunny() -> trimesh.Trimesh:
    mesh = trimesh.load_mesh(BUNNY, process=False)
    mesh.apply_scale(0.2 / mesh.extents.max())
    return mesh.apply_transform(rotation_matrix(np.pi / 2, (1, 0, 0)))


def _dented_box() -> trimesh.Trimesh:
    dents = [
        icosphere(subdivisions=3, radius=0.04).apply_translation(place)
        for place in ((0.01, 0.0, -0.065), (0.06, 0.02, -0.01))
    ]
    return trimesh.boolean.difference([box((0.12, 0.1, 0.08)), *dents])


MESHES = {"cube": _cube, "mug": _mug, "can": _can, "bunny": _bunny, "dented box": _dented_box}


@cache
def build(name: str) -> vx.Model:
    """A body's model at default settings."""
    return vx.Model.from_mesh(MESHES[name]())


@cache
def build_slab() -> vx.Model:
    """1.6 x 1.6 x 0.06 m; its top is at z = 0."""
    return vx.Model.from_mesh(box((1.6, 1.6, 0.06)).apply_translation((0, 0, -0.03)))
