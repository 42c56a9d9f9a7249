"""Conversion of shapes to Bullet's geometries, to triangles and to mass properties."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np

from voxshell import _bullet
from voxshell.base.arguments import as_floats, as_positive, as_vector
from voxshell.errors import InputTypeError, SettingsError
from voxshell.model.mass_properties import MassProperties
from voxshell.model.meshes import MODEL_SUFFIX, Mesh
from voxshell.model.model import Model
from voxshell.model.shapes import Box, Capsule, Cone, Cylinder, Plane, Sphere
from voxshell.simulation.comparison_shapes import ConvexDecomposition, GImpact
from voxshell.simulation.compound import Compound

if TYPE_CHECKING:
    from collections.abc import Callable

    import trimesh
    from numpy.typing import NDArray

    from voxshell.model.meshes import MeshLike

Shape: TypeAlias = (
    Model
    | Plane
    | Box
    | Sphere
    | Capsule
    | Cylinder
    | Cone
    | GImpact
    | ConvexDecomposition
    | Compound
)
"""The shapes that a body can have."""

Inertia: TypeAlias = Literal["solid", "surface"] | MassProperties
"""The distribution of a body's mass: uniform solid, thin skin on the surface, or as given."""

PartGeometry: TypeAlias = (
    _bullet.ModelGeometry
    | _bullet.PlaneGeometry
    | _bullet.BoxGeometry
    | _bullet.SphereGeometry
    | _bullet.CapsuleGeometry
    | _bullet.CylinderGeometry
    | _bullet.ConeGeometry
    | _bullet.GImpactGeometry
    | _bullet.HullsGeometry
)
"""The geometries of the bindings, except compounds."""

PLANE_EXTENT = 2.0
"""Edge length of the square that represents a plane in pictures, meters."""

_PLANE_THICKNESS = 0.01
_ROUNDING = 1e-6
"""Relative error of a user's tensor that counts as rounding."""
_ROUND_SECTIONS = 96
_THIN = 1e-4
"""Size below which vertices of a round body may be within trimesh's distance of merging, meters."""


def as_shape(shape: Shape | MeshLike) -> Shape:
    """Return a shape as it is; build a model with default settings for a mesh or a path.

    Raises:
        MissingFileError: A file does not exist.
        MeshError: A mesh cannot be read, or no model can be built from it.
        ModelFileError: A model file is damaged or of another version.
        FileAccessError: A model file cannot be read.
    """
    given: Any = shape
    if isinstance(given, (str, os.PathLike)):
        is_model = os.fsdecode(given).lower().endswith(MODEL_SUFFIX)
        return Model.load(given) if is_model else Model.from_mesh(given)
    # Compare names: importing trimesh takes longer than importing voxshell.
    if any(kind.__name__ == "Trimesh" for kind in type(given).__mro__):
        return Model.from_mesh(given)
    return given


def make_geometry(shape: Shape) -> PartGeometry | _bullet.CompoundGeometry:
    """Return a shape as the bindings take it.

    Raises:
        InputTypeError: Shapes of this type cannot be simulated.
    """
    if isinstance(shape, Compound):
        return _bullet.CompoundGeometry([(_make_part(part), pose) for part, pose in shape.parts])
    return _make_part(shape)


def _make_part(shape: Shape) -> PartGeometry:
    match shape:
        case Model():
            return _bullet.ModelGeometry(shape._core)
        case Plane():
            return _bullet.PlaneGeometry(shape.normal.tolist(), shape.offset)
        case Box():
            return _bullet.BoxGeometry(shape.half_extents.tolist())
        case Sphere():
            return _bullet.SphereGeometry(shape.radius)
        case Capsule():
            return _bullet.CapsuleGeometry(shape.radius, shape.length)
        case Cylinder():
            return _bullet.CylinderGeometry(shape.radius, shape.length)
        case Cone():
            return _bullet.ConeGeometry(shape.radius, shape.height)
        case GImpact():
            return _bullet.GImpactGeometry(*shape.mesh, shape.margin)
        case ConvexDecomposition():
            return _bullet.HullsGeometry(shape.hulls, shape.margin)
    raise InputTypeError(
        "a body is made of a Model, Plane, Box, Sphere, Capsule, Cylinder, Cone, Compound, GImpact, "
        f"ConvexHull or ConvexDecomposition, not {type(shape).__name__}"
    )


def mesh_of(shape: Shape) -> Mesh:
    """Return the surface of a shape in its body frame; a plane becomes a square plate below it."""
    from trimesh import creation
    from trimesh.geometry import align_vectors

    match shape:
        case Box():
            mesh = creation.box(extents=2.0 * shape.half_extents)
        case Sphere():
            mesh = creation.icosphere(subdivisions=4, radius=shape.radius)
        case Capsule():
            sections = (_ROUND_SECTIONS, _ROUND_SECTIONS)
            # Build at radius 1 first: trimesh merges vertices that are close together.
            mesh = creation.capsule(height=shape.length / shape.radius, radius=1.0, count=sections)
            mesh.apply_translation(-mesh.bounds.mean(axis=0))
            mesh.apply_scale(shape.radius)
        case Cylinder():
            return _stretch(creation.cylinder, shape.radius, shape.length)
        case Cone():
            vertices, faces = _stretch(creation.cone, shape.radius, shape.height)
            return Mesh(vertices - (0.0, 0.0, shape.height / 2.0), faces)
        case Compound():
            return _join([(mesh_of(part), pose) for part, pose in shape.parts])
        case Plane():
            mesh = creation.box(extents=(PLANE_EXTENT, PLANE_EXTENT, _PLANE_THICKNESS))
            mesh.apply_translation((0.0, 0.0, shape.offset - _PLANE_THICKNESS / 2.0))
            mesh.apply_transform(align_vectors((0.0, 0.0, 1.0), shape.normal))
        case _:
            return shape.mesh
    return Mesh(np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.uint32))


def _stretch(create: Callable[..., trimesh.Trimesh], radius: float, height: float) -> Mesh:
    """Return a round body about z; trimesh would merge vertices of one that is thin."""
    thin = min(radius, height) < _THIN
    sizes = (1.0, 1.0) if thin else (radius, height)
    mesh = create(radius=sizes[0], height=sizes[1], sections=_ROUND_SECTIONS)
    vertices = np.asarray(mesh.vertices, np.float64)
    if thin:
        vertices = vertices * (radius, radius, height)
    return Mesh(vertices, np.asarray(mesh.faces, np.uint32))


def compute_mass_properties(shape: Shape, mass: float, inertia: Inertia) -> MassProperties:
    """Return the mass properties of a body; all are zero if its mass, in kilograms, is 0 (static).

    Raises:
        InputTypeError: ``inertia`` has an unsupported type.
        SettingsError: ``inertia`` is an unknown word, or physically impossible.
    """
    if isinstance(inertia, MassProperties):
        return _nothing() if mass == 0.0 else _scale(inertia, mass)
    if not isinstance(inertia, str):
        raise InputTypeError(
            "inertia must be 'solid', 'surface' or a MassProperties, which holds mass, center of mass "
            f"and tensor, not {type(inertia).__name__}"
        )
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
        case Compound():
            return _combine(shape, mass, inertia)
        case _:
            center, tensor = _bullet.mesh_mass_properties(*mesh_of(shape), inertia)
            return MassProperties(mass, np.array(center), mass * np.array(tensor))


def _scale(matter: MassProperties, mass: float) -> MassProperties:
    """Return a user's mass properties with another mass, in kilograms.

    Raises:
        SettingsError: No body has them.
    """
    ratio = mass / as_positive(matter.mass, "inertia.mass")
    center = np.array(as_vector(matter.center_of_mass, "inertia.center_of_mass", " in meters"))
    tensor = as_floats(matter.inertia, "inertia.inertia", (3, 3))
    with np.errstate(all="ignore"):
        skew = np.abs(tensor - tensor.T).max() / np.abs(tensor).max()
    # The comparison is false for numbers that are not finite, too.
    if not (skew <= _ROUNDING and np.linalg.eigvalsh(tensor)[0] > 0.0):
        raise SettingsError("inertia.inertia must be finite, symmetric and positive definite")
    low, middle, high = np.linalg.eigvalsh(tensor).tolist()
    if high > (1.0 + _ROUNDING) * (low + middle):
        raise SettingsError(
            f"inertia.inertia violates the triangle inequality: its largest principal moment, {high:g} kg m2, "
            f"exceeds the sum of the other two, {low + middle:g} kg m2; check its numbers and the signs of its "
            "products of inertia"
        )
    return MassProperties(mass, center, tensor * ratio)


def _combine(shape: Compound, mass: float, kind: Literal["solid", "surface"]) -> MassProperties:
    """Return the properties of parts that share one density, or one mass per area of skin."""
    from trimesh import Trimesh

    sizes = []
    for part, _ in shape.parts:
        mesh = mesh_of(part)
        body = Trimesh(mesh.vertices, mesh.faces, process=False)
        sizes.append(abs(float(body.volume if kind == "solid" else body.area)))
    fractions = np.array(sizes) / sum(sizes)
    matters = [compute_mass_properties(part, 1.0, kind) for part, _ in shape.parts]
    centers = np.array(
        [
            pose[:3, :3] @ matter.center_of_mass + pose[:3, 3]
            for matter, (_, pose) in zip(matters, shape.parts, strict=True)
        ]
    )
    center = fractions @ centers
    tensor = np.zeros((3, 3))
    for fraction, matter, place, (_, pose) in zip(
        fractions, matters, centers - center, shape.parts, strict=True
    ):
        turned = pose[:3, :3] @ matter.inertia @ pose[:3, :3].T
        tensor += fraction * (turned + place @ place * np.eye(3) - np.outer(place, place))
    return MassProperties(mass, center, mass * tensor)


def _join(placed: list[tuple[Mesh, NDArray[np.float64]]]) -> Mesh:
    vertices = [mesh.vertices @ pose[:3, :3].T + pose[:3, 3] for mesh, pose in placed]
    starts = np.cumsum([0, *(len(part) for part in vertices[:-1])])
    faces = [mesh.faces + np.uint32(start) for (mesh, _), start in zip(placed, starts, strict=True)]
    return Mesh(np.concatenate(vertices), np.concatenate(faces).astype(np.uint32))


def _nothing() -> MassProperties:
    return MassProperties(0.0, np.zeros(3), np.zeros((3, 3)))
