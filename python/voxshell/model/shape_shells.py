"""Point shells of analytic shapes, for queries against models by tolerance."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
import trimesh

from voxshell import _core
from voxshell.errors import MemoryLimitError
from voxshell.model.shapes import Box, Capsule, Cone, ConvexPolyhedron, Cylinder, Sphere

if TYPE_CHECKING:
    from voxshell.model.field import Field

_AROUND = 64  # faces around a round shape, so that its mesh is off by a thousandth of the radius
_SUBDIVISIONS = 4  # of an icosahedron, for the same accuracy


def find_shell(shape: Field) -> _core.Model | None:
    """Return a model whose shell covers a shape's surface, or None if the shape is unbounded.

    A shell by tolerance has few points where its mesh is flat, so a shape may lie between them. The
    shape's own shell finds such contacts in the model's field. It is built once from an inscribed
    mesh, and equal shapes share it.

    Raises:
        MemoryLimitError: The shape is too long for its thickness.
    """
    try:
        return _find_shell(shape)
    except MemoryLimitError as error:
        raise MemoryLimitError(
            f"the points of {shape!r} take too much memory, because it is long for its thickness "
            f"({error}); use the points of the model alone: pass shell='a' or shell='b', whichever "
            "is the model, though thin shapes may pass between them"
        ) from error


def _find_shell(shape: Field) -> _core.Model | None:
    if shape._shell_model is None:
        if isinstance(shape, ConvexPolyhedron):
            shape._shell_model = _build(*shape.mesh)
        elif (sizes := _sizes_of(shape)) is not None:
            shape._shell_model = _build_of_sizes(type(shape), *sizes)
    return shape._shell_model


def _sizes_of(shape: Field) -> tuple[float, ...] | None:
    match shape:
        case Box():
            return tuple(float(extent) for extent in shape.half_extents)
        case Sphere():
            return (shape.radius,)
        case Capsule() | Cylinder():
            return (shape.radius, shape.length)
        case Cone():
            return (shape.radius, shape.height)
        case _:
            return None


@lru_cache(maxsize=64)
def _build_of_sizes(kind: type[Field], *sizes: float) -> _core.Model:
    if kind is Box:
        mesh = trimesh.creation.box(2.0 * np.asarray(sizes))
        return _build(mesh.vertices, mesh.faces)
    # Build at radius 1 first: trimesh merges vertices that are close together.
    radius = sizes[0]
    length = sizes[-1] / radius
    if kind is Sphere:
        mesh = trimesh.creation.icosphere(subdivisions=_SUBDIVISIONS)
    elif kind is Capsule:
        mesh = trimesh.creation.capsule(height=length, radius=1.0, count=[_AROUND, _AROUND])
        mesh.apply_translation((0.0, 0.0, -mesh.bounds.mean(axis=0)[2]))
    elif kind is Cylinder:
        mesh = trimesh.creation.cylinder(1.0, length, sections=_AROUND)
    else:
        mesh = trimesh.creation.cone(1.0, length, sections=_AROUND)
        mesh.apply_translation((0.0, 0.0, -0.5 * length))
    return _build(radius * mesh.vertices, mesh.faces)


def _build(vertices: np.ndarray, faces: np.ndarray) -> _core.Model:
    return _core.Model.build(
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
