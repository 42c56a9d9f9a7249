"""What bodies are made of: each shape as Bullet takes it, as triangles, and as matter."""

from __future__ import annotations

from typing import Literal, TypeAlias

import numpy as np

from voxshell import _bullet
from voxshell._arguments import as_floats, as_positive
from voxshell.comparison_shapes import ConvexDecomposition, GImpact
from voxshell.errors import InputTypeError, SettingsError
from voxshell.mass_properties import MassProperties
from voxshell.meshes import Mesh
from voxshell.model import Model
from voxshell.shapes import Box, Plane, Sphere

Shape: TypeAlias = Model | Plane | Box | Sphere | GImpact | ConvexDecomposition
"""What a body can be made of."""

Inertia: TypeAlias = Literal["solid", "surface"] | MassProperties
"""How a body's matter is spread: the uniform solid, a thin skin on the surface, or as given."""

Geometry: TypeAlias = (
    _bullet.ModelGeometry
    | _bullet.PlaneGeometry
    | _bullet.BoxGeometry
    | _bullet.SphereGeometry
    | _bullet.GImpactGeometry
    | _bullet.HullsGeometry
)
"""The same for the bindings."""

PLANE_EXTENT = 2.0
"""Edge of the square that stands for a plane in pictures, metres."""

_PLANE_THICKNESS = 0.01


def make_geometry(shape: Shape) -> Geometry:
    """The shape as the bindings take it.

    Raises:
        InputTypeError: It is none of the kinds that can be simulated.
    """
    match shape:
        case Model():
            return _bullet.ModelGeometry(shape._core)
        case Plane():
            return _bullet.PlaneGeometry(shape.normal.tolist(), shape.offset)
        case Box():
            return _bullet.BoxGeometry(shape.half_extents.tolist())
        case Sphere():
            return _bullet.SphereGeometry(shape.radius)
        case GImpact():
            return _bullet.GImpactGeometry(*shape.mesh, shape.margin)
        case ConvexDecomposition():
            return _bullet.HullsGeometry(shape.hulls, shape.margin)
    raise InputTypeError(
        "a body is made of a Model, Plane, Box, Sphere, GImpact, ConvexHull or "
        f"ConvexDecomposition, not {type(shape).__name__}"
    )


def mesh_of(shape: Shape) -> Mesh:
    """The surface of a shape in its body frame. A plane becomes a square plate below its surface."""
    from trimesh import creation
    from trimesh.geometry import align_vectors

    match shape:
        case Box():
            mesh = creation.box(extents=2.0 * shape.half_extents)
        case Sphere():
            mesh = creation.icosphere(subdivisions=4, radius=shape.radius)
        case Plane():
            mesh = creation.box(extents=(PLANE_EXTENT, PLANE_EXTENT, _PLANE_THICKNESS))
            mesh.apply_translation((0.0, 0.0, shape.offset - _PLANE_THICKNESS / 2.0))
            mesh.apply_transform(align_vectors((0.0, 0.0, 1.0), shape.normal))
        case _:
            return shape.mesh
    return Mesh(np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.uint32))


def compute_mass_properties(shape: Shape, mass: float, inertia: Inertia) -> MassProperties:
    """Of a body of the given mass, kilograms; of a static one (mass 0) they are all zero.

    Raises:
        SettingsError: ``inertia`` is none of its kinds, or is not physical.
    """
    if isinstance(inertia, MassProperties):
        if mass == 0.0:
            return _nothing()
        ratio = mass / as_positive(inertia.mass, "inertia.mass")
        tensor = as_floats(inertia.inertia, "inertia.inertia", (3, 3))
        center = as_floats(inertia.center_of_mass, "inertia.center_of_mass", (3,))
        if not (np.isfinite(tensor).all() and np.linalg.eigvalsh(tensor).min() > 0.0):
            raise SettingsError("inertia.inertia must be finite, symmetric and positive definite")
        return MassProperties(mass, center, tensor * ratio)
    if inertia not in ("solid", "surface"):
        raise SettingsError(
            f"inertia must be 'solid', 'surface' or a MassProperties, not {inertia!r}"
        )
    if mass == 0.0:
        return _nothing()
    match shape:
        case Model():
            return shape.mass_properties(mass, inertia)
        case Sphere():
            factor = 2.0 / 5.0 if inertia == "solid" else 2.0 / 3.0
            return MassProperties(mass, np.zeros(3), np.eye(3) * factor * mass * shape.radius**2)
        case _:
            center, tensor = _bullet.mesh_mass_properties(*mesh_of(shape), inertia)
            return MassProperties(mass, np.array(center), mass * np.array(tensor))


def _nothing() -> MassProperties:
    return MassProperties(0.0, np.zeros(3), np.zeros((3, 3)))
