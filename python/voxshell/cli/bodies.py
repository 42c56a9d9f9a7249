"""Bodies in arguments: model files, meshes, and shapes in words."""

from __future__ import annotations

import re
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from voxshell.base.input_files import check_exists
from voxshell.cli.model_facts import list_accuracy
from voxshell.errors import FileAccessError, MeshError, ModelFileError, SettingsError
from voxshell.model.meshes import MODEL_SUFFIX
from voxshell.model.model import Model
from voxshell.model.shapes import Box, Capsule, Cone, Cylinder, Plane, Sphere

if TYPE_CHECKING:
    from collections.abc import Callable

    from voxshell.query.pairs import Collidable

_SHAPES: dict[str, tuple[tuple[str, ...], Callable[..., Collidable]]] = {
    "plane": (("nx", "ny", "nz", "offset"), lambda x, y, z, offset: Plane((x, y, z), offset)),
    "box": (("hx", "hy", "hz"), lambda x, y, z: Box((x, y, z))),
    "sphere": (("radius",), Sphere),
    "capsule": (("radius", "length"), Capsule),
    "cylinder": (("radius", "length"), Cylinder),
    "cone": (("radius", "height"), Cone),
}


@Parameter(name="*")
@dataclass(frozen=True)
class ModelOptions:
    """How to build models from meshes.

    Attributes:
        tolerance: Largest error of the model in meters. The next four options make a uniform model instead.
        voxel_size: Edge of the distance field's cells in meters, after --scale.
        resolution: Number of cells along the mesh's longest side, instead of --voxel-size.
        point_spacing: Edge of the voxels that get one point each, in meters; the voxel size by
            default.
        target_points: Number of points, reached within 1 %, instead of --point-spacing.
        scale: Factor that converts the mesh to meters: 0.001 for millimeters. By default, 3MF and
            COLLADA files are read in the unit that they state, and others in meters.
        padding: How far the grid extends beyond the mesh's bounds, in meters; 16 voxels by default.
        sign: How to find the inside: by the closed surface, by winding numbers, or automatically.
        open: Whether an open mesh becomes a closed solid or a sheet; auto decides by its openings.
        sheet_thickness: Thickness of that sheet in meters. The default is a 200th of the longest
            side, and at least two voxels for uniform models.
        threads: Number of threads for the build; one per core by default.
        cache: Load a model from the cache on the disk if it was built before; else add it there.
    """

    tolerance: float | None = None
    voxel_size: float | None = None
    resolution: int | None = None
    point_spacing: float | None = None
    target_points: int | None = None
    scale: float | None = None
    padding: float | None = None
    sign: Literal["auto", "closed", "winding"] = "auto"
    open: Literal["auto", "solid", "sheet"] = "auto"
    sheet_thickness: float | None = None
    threads: int | None = None
    cache: Annotated[bool, Parameter(negative="--no-cache")] = True

    def build(self, path: Path, progress: Callable[[str, float], object] | None = None) -> Model:
        """Return the model of a mesh file."""
        return Model.from_mesh(path, progress=progress, **vars(self))


DEFAULTS = ModelOptions()


def is_model_file(path: Path) -> bool:
    """Return whether a file name is that of a model."""
    return path.suffix.lower() == MODEL_SUFFIX


def require_file(path: Path) -> None:
    """Refuse a path without a file, before any work.

    Raises:
        MissingFileError: It does not exist.
        MeshError: It is a folder.
    """
    check_exists(path)
    if path.is_dir():
        raise MeshError(f"cannot read {path}: it is a folder")


def load_model(path: Path) -> Model:
    """Load a model from its file.

    Raises:
        MissingFileError: It does not exist.
        ModelFileError: It cannot be read, or is not a model.
    """
    require_file(path)
    try:
        return Model.load(path)
    except FileAccessError as error:
        raise ModelFileError(str(error)) from error


def refuse_unused(options: ModelOptions, *texts: str) -> None:
    """Refuse options for meshes if no argument is a mesh, before any work.

    Raises:
        SettingsError: There are such options; the message names them.
    """
    if not all(is_model_file(Path(text)) or text.split(":")[0] in _SHAPES for text in texts):
        return
    unused = [
        f"--{field.name.replace('_', '-')}"
        for field in fields(options)
        if getattr(options, field.name) != field.default
    ]
    if unused:
        raise SettingsError(
            f"{', '.join(unused)}: options for meshes have no effect, because {' and '.join(texts)} "
            f"{'is not a mesh' if len(texts) == 1 else 'are not meshes'}; leave them out, or pass a mesh"
        )


def read_body(
    text: str,
    options: ModelOptions,
    progress: Callable[[str, float], object] | None = None,
) -> Collidable:
    """Return the body that an argument names.

    Args:
        text: A model file (``.vxs``), a mesh file, or a shape such as "plane", "sphere:0.1" or
            "box:0.1,0.1,0.05". An existing file takes precedence.
        options: Options to build a model from a mesh.
        progress: As for :meth:`voxshell.Model.from_mesh`.

    Raises:
        MissingFileError: A file does not exist.
        MeshError: A mesh cannot be read or built.
        ModelFileError: A model file cannot be read.
        SettingsError: A shape's numbers are invalid, or there is no such shape.
    """
    path = Path(text)
    if not path.exists() and (match := re.fullmatch(r"([a-z]+)(?::(.*))?", text)):
        return _make_shape(match[1], match[2])
    if is_model_file(path):
        return load_model(path)
    require_file(path)
    return options.build(path, progress)


def describe_model(model: Model) -> dict[str, Any]:
    """Return the properties of a model for JSON; meters and bytes."""
    vertices, faces = model.mesh
    return {
        "vertices": len(vertices),
        "triangles": len(faces),
        "bounds": model.bounds.tolist(),
        "sign_method": model.field.sign_method,
        "sign_confidence": model.field.sign_confidence,
        "tolerance": model.tolerance,
        "voxel_size": model.field.voxel_size,
        "shape": list(model.field.shape),
        "field_bytes": model.field.nbytes,
        "points": len(model.shell),
        "point_spacing": model.shell.spacing,
        "levels": model.shell.tree.levels,
        "accuracy": list_accuracy(model),
    }


def _make_shape(name: str, numbers: str | None) -> Collidable:
    if name not in _SHAPES:
        raise SettingsError(
            f"{name!r} is neither a file nor a shape; shapes are {', '.join(_SHAPES)}, as in sphere:0.1"
        )
    names, make = _SHAPES[name]
    if name == "plane" and numbers is None:
        return Plane()
    usage = f"{name}:{','.join(map(str.upper, names))}"
    try:
        values = [float(number) for number in (numbers or "").split(",")]
    except ValueError:
        given = name if numbers is None else f"{name}:{numbers}"
        raise SettingsError(f"write {usage}, with numbers in meters, not {given!r}") from None
    if len(values) != len(names):
        raise SettingsError(
            f"write {usage}, in meters: {len(names)} number{'s'[: len(names) > 1]}, not {len(values)}"
        )
    return make(*values)
