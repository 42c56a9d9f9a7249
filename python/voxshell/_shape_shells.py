"""Point shells of analytic shapes, for queries with models that are sparse where they are flat."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import trimesh

from voxshell import _core
from voxshell.shapes import Box, Capsule, Cone, ConvexPolyhedron, Cylinder, Sphere

if TYPE_CHECKING:
    from voxshell.field import Field

_AROUND = 64  # faces around a round shape: its mesh is off by a thousandth of the radius
_SUBDIVISIONS = 4  # of an icosahedron, for as many


def find_shell(shape: Field) -> _core.Model | None:
    """The model whose shell stands for a shape's surface; None of shapes without an end.

    A shell by tolerance has few points where the mesh is flat, so a shape may lie between them.
    With a shell of its own, the shape is found by its points in the model's field as well. It is
    built once for each shape, from an inscribed mesh.
    """
    if shape._shell_model is None:
        mesh = _make_mesh(shape)
        if mesh is None:
            return None
        vertices, faces = mesh
        shape._shell_model = _core.Model.build(
            np.ascontiguousarray(vertices, np.float64),
            np.ascontiguousarray(faces, np.uint32),
            tolerance=0.0,
            voxel_size=0.0,
            resolution=0,
            point_spacing=0.0,
            target_points=0,
            padding=-1.0,
            sign="closed",
            open="solid",
            sheet_thickness=0.0,
            threads=0,
            progress=None,
        )
    return shape._shell_model


def _make_mesh(shape: Field) -> tuple[np.ndarray, np.ndarray] | None:
    if isinstance(shape, ConvexPolyhedron):
        return shape.mesh
    match shape:
        case Box():
            mesh = trimesh.creation.box(2.0 * np.asarray(shape.half_extents))
        case Sphere():
            mesh = trimesh.creation.icosphere(subdivisions=_SUBDIVISIONS, radius=shape.radius)
        case Capsule():
            # Of radius 1 first: trimesh merges the corners of small ones.
            mesh = trimesh.creation.capsule(
                height=shape.length / shape.radius, radius=1.0, count=[_AROUND, _AROUND]
            )
            mesh.apply_translation((0.0, 0.0, -mesh.bounds.mean(axis=0)[2]))
            mesh.apply_scale(shape.radius)
        case Cylinder():
            mesh = trimesh.creation.cylinder(shape.radius, shape.length, sections=_AROUND)
        case Cone():
            mesh = trimesh.creation.cone(shape.radius, shape.height, sections=_AROUND)
            mesh.apply_translation((0.0, 0.0, -0.5 * shape.height))
        case _:
            return None
    return mesh.vertices, mesh.faces
