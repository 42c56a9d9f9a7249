"""Conversion of meshes to arrays: from files, trimesh objects and arrays."""

from __future__ import annotations

import io
import logging
import os
import re
import signal
import threading
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from voxshell.base.arguments import (
    as_floats,
    as_path,
    as_positive,
    as_unicode,
    show_array,
    show_value,
)
from voxshell.base.calls import explain_calls
from voxshell.base.extras import explain_import
from voxshell.base.input_files import check_exists
from voxshell.base.outputs import check_suffix, explain_missing_folder
from voxshell.base.user_warnings import shorten_path
from voxshell.errors import InputTypeError, MemoryLimitError, MeshError, MissingFileError
from voxshell.model.mesh_files.reading import KINDS, UNITLESS, open_mesh_file

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import FrameType

    import trimesh
    from numpy.typing import ArrayLike, NDArray

    MeshLike: TypeAlias = (
        "trimesh.Trimesh | tuple[ArrayLike, ArrayLike] | str | os.PathLike[str] | Mesh"
    )
    """Everything that :meth:`voxshell.Model.from_mesh` accepts as a mesh."""


MODEL_SUFFIX = ".vxs"
"""Suffix of model files, which are not meshes."""


class MeshWarning(UserWarning):
    """A mesh has faults that were handled. The message says how many and where."""


@explain_calls
class Mesh(NamedTuple):
    """A triangle mesh as arrays: ``vertices, faces = model.mesh``.

    Attributes:
        vertices: (n, 3) float64, meters.
        faces: (m, 3) uint32, indices of ``vertices``, counterclockwise when seen from outside.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.uint32]

    def __repr__(self) -> str:
        return f"Mesh({len(self.vertices)} vertices, {len(self.faces)} faces)"


_LONG = 10.0
"""A mesh longer than this, in meters, is probably in millimeters."""

_REMEDY_FOR_UNITS = (
    "pass Model.from_mesh(..., scale=0.001), write scale = 0.001 in a scene file, or pass --scale 0.001 to "
    "a command; if it is in meters, scale=1 silences this warning"
)


def name_of(mesh: MeshLike) -> str:
    """Return the name of the file that a mesh is, or that trimesh states; empty if it is not known.

    Question marks replace what is not Unicode.
    """
    if isinstance(mesh, (str, os.PathLike)):
        return as_unicode(Path(os.fsdecode(mesh)).name)
    metadata = getattr(mesh, "metadata", None)
    stated = metadata if isinstance(metadata, dict) else {}
    # Which key it is depends on trimesh's version.
    known = stated.get("file_name") or stated.get("name")
    return Path(known).name if isinstance(known, str) else ""


def read_mesh(mesh: MeshLike, scale: float | None = None) -> Mesh:
    """Return the arrays of a mesh after checking types, shapes, finite numbers and indices.

    Args:
        mesh: The mesh.
        scale: Factor on all vertices, to convert them to meters. By default it is the unit that a
            3MF or COLLADA file or a ``trimesh.Trimesh`` states, and 1 for all else.

    Raises:
        MissingFileError: A file does not exist.
        MeshError: A file cannot be read or holds no triangles; or arrays have a wrong shape or
            type, numbers that are not finite, or indices out of range. The message names the file.
        MemoryLimitError: The system has not enough memory for a file.
        InputTypeError: ``mesh`` has an unsupported type.
        SettingsError: ``scale`` is not positive.
    """
    factor = None if scale is None else as_positive(scale, "scale")
    if isinstance(mesh, (str, os.PathLike)):
        try:
            path = os.fsdecode(mesh)
        except TypeError as error:
            raise InputTypeError(f"mesh must be a path, but {error}") from None
        with naming_file(mesh):
            loaded, unit = _load(path)
            return read_mesh(loaded, unit if factor is None else factor)
    if isinstance(mesh, (tuple, list)) and len(mesh) == 2:
        vertices, faces = mesh
    elif hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        factor = _read_unit(mesh) if factor is None else factor
        vertices, faces = mesh.vertices, mesh.faces  # pyright: ignore[reportAttributeAccessIssue]
    else:
        hint = "; pass scene.to_mesh()" if hasattr(mesh, "to_mesh") else ""
        raise InputTypeError(
            "mesh must be a trimesh.Trimesh, (vertices, faces) or a path, "
            f"not {type(mesh).__name__}{hint}"
        )
    vertices = as_floats(vertices, "vertices", (None, 3), MeshError)
    wrong = np.flatnonzero(~np.isfinite(vertices).all(axis=1))
    if len(wrong):
        raise MeshError(
            f"{len(wrong)} of {len(vertices)} vertices of the mesh are not finite (first: vertex "
            f"{wrong[0]}); remove them, or export the mesh again"
        )
    if factor is not None and factor != 1.0:
        vertices = vertices * factor
    return Mesh(vertices, _as_faces(faces, len(vertices)))


def _read_unit(mesh: Any) -> float:
    """Return the unit of a ``trimesh.Trimesh``, meters; 1 if it states none."""
    stated = getattr(mesh, "units", None)
    if not isinstance(stated, str):
        return 1.0
    from trimesh.units import unit_conversion

    try:
        unit = float(unit_conversion(stated, "meters"))
    except (KeyError, ValueError) as error:
        raise MeshError(
            f"mesh.units is {stated!r}, which is not a unit of length; pass scale="
        ) from error
    if not (np.isfinite(unit) and unit > 0.0):
        raise MeshError(f"mesh.units is {stated!r}, which is not a unit of length; pass scale=")
    return float(f"{unit:.12g}")  # trimesh converts by way of inches


def doubt_unit(
    mesh: MeshLike, vertices: NDArray[np.float64], remedy: str = _REMEDY_FOR_UNITS
) -> str:
    """Return why a mesh that was read without a scale is probably not in meters; else "".

    Args:
        mesh: The mesh; only files whose format states no unit are doubted.
        vertices: (n, 3), as read.
        remedy: How to set the scale.
    """
    if not isinstance(mesh, (str, os.PathLike)) or len(vertices) == 0:
        return ""
    kind = os.path.splitext(os.fsdecode(mesh))[1][1:].lower()
    longest = float(np.ptp(vertices, axis=0).max())
    if longest <= _LONG or kind not in UNITLESS:
        return ""
    return (
        f"{shorten_path(mesh)} is {longest:.4g} m long, and {kind.upper()} files state no unit: if it is in "
        f"millimeters, {remedy}"
    )


def advise_on_mesh_file(path: bytes) -> str:
    """Return the end of an error about a file that is no model file: what to do if it is a mesh file.

    The suffix decides whether it is one. For other files, the text is empty.
    """
    name = os.fsdecode(path)
    if os.path.splitext(name)[1][1:].lower() not in KINDS:
        return ""
    return f"; build a model of the mesh: Model.from_mesh({shorten_path(name)!r})"


def as_model_path(path: str | os.PathLike[str]) -> bytes:
    """Return the path of a model file to write, by whose suffix models are recognized."""
    place = as_path(path, "path")
    if not os.path.isdir(place):  # the core's error says that it is one
        file = Path(os.fsdecode(place))
        check_suffix(file, (MODEL_SUFFIX,), "a model file")
        try:
            os.stat(file.parent)
        except (FileNotFoundError, NotADirectoryError):
            raise MissingFileError(explain_missing_folder(file)) from None
        except OSError:
            pass  # the core's error says which
    return place


@contextmanager
def naming_file(mesh: MeshLike) -> Iterator[None]:
    """Prefix errors of a mesh with the path of its file, if it has one."""
    try:
        yield
    except MeshError as error:
        if not isinstance(mesh, (str, os.PathLike)) or os.fsdecode(mesh) in str(error):
            raise
        raise MeshError(f"{os.fsdecode(mesh)}: {error}") from None


def _load(path: str) -> tuple[trimesh.Trimesh, float]:
    """Return the mesh of a file and its unit in meters; the bodies of a scene become one mesh."""
    check_exists(path)
    if path.lower().endswith(MODEL_SUFFIX) and os.path.isfile(path):
        raise MeshError(
            f"{path} is a model already: load it with voxshell.Model.load, or pass the mesh that it "
            "was built from"
        )
    try:
        kind, data, neighbors, unit = open_mesh_file(path)
        with _keeping_interrupts(until_the_end=True):
            import trimesh  # this import takes longer than that of voxshell
        # Materials may refer to any file, and do not affect a mesh.
        options = {"skip_materials": True} if kind in ("glb", "gltf", "obj", "ply") else {}
        with _keeping_interrupts(), _keeping_off_stderr("trimesh"):
            # Without processing, vertices stay as in the file; the core merges equal ones.
            mesh = trimesh.load(
                io.BytesIO(data),
                file_type=kind,
                # trimesh only asks it for bytes by name.
                resolver=neighbors if kind in ("glb", "gltf") else None,  # pyright: ignore[reportArgumentType]
                force="mesh",
                process=False,
                **options,
            )
    except MeshError as error:
        raise MeshError(f"cannot read mesh {path}: {error}") from None
    except MemoryError as error:
        raise MemoryLimitError(
            f"cannot read mesh {path}: out of memory; simplify the mesh"
        ) from error
    except OSError as error:
        raise MeshError(f"cannot read mesh {path}: {error.strerror or error}") from error
    except ImportError as error:
        explained = explain_import(error, f"its reader is not installed: {error}")
        kind = MemoryLimitError if isinstance(explained, MemoryLimitError) else MeshError
        raise kind(f"cannot read mesh {path}: {explained}") from error
    except Exception as error:  # readers raise any type if a file is damaged
        raise MeshError(f"cannot read mesh {path}: {_explain(path, error)}") from error
    if not isinstance(mesh, trimesh.Trimesh) or len(mesh.faces) == 0:
        raise MeshError(
            f"cannot read mesh {path}: it holds no triangles, or is damaged; export it again"
        )
    return mesh, unit


@contextmanager
def _keeping_off_stderr(library: str) -> Iterator[None]:
    """Keep a library's log off stderr, where Python writes it if the program handles no logs."""
    log, nowhere = logging.getLogger(library), logging.NullHandler()
    log.addHandler(nowhere)
    try:
        yield
    finally:
        log.removeHandler(nowhere)


def _explain(path: str, error: Exception) -> str:
    """Return why a file cannot be read, and a remedy."""
    # trimesh's reader of OBJ files does not check indices.
    beyond = re.search(r"index (-?\d+) is out of bounds for axis 0 with size (\d+)", str(error))
    if beyond and path.lower().endswith(".obj"):
        return (
            f"a face refers to vertex {beyond[1]}, counted from 0, but there are {beyond[2]}; the file "
            "is damaged: export it again"
        )
    kind = os.path.splitext(path)[1][1:].upper()
    return f"it is damaged or not in {kind} format ({error}); export it again"


@contextmanager
def _keeping_interrupts(*, until_the_end: bool = False) -> Iterator[None]:
    """Raise interrupts that the block swallows: trimesh mistakes them for faults in a file.

    Args:
        until_the_end: Delay interrupts until the block ends: C++ code that trimesh imports aborts
            on exceptions.
    """
    handler = signal.getsignal(signal.SIGINT)
    in_main_thread = threading.current_thread() is threading.main_thread()
    if not in_main_thread or not callable(handler):
        yield
        return
    interrupted = False

    def interrupt(number: int, frame: FrameType | None) -> None:
        nonlocal interrupted
        interrupted = True
        if not until_the_end:
            handler(number, frame)
            interrupted = False  # the handler did not raise, so there is nothing to raise later

    signal.signal(signal.SIGINT, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)
        if interrupted:
            handler(signal.SIGINT, None)


def _as_faces(value: Any, vertex_count: int) -> NDArray[np.uint32]:
    """Return vertex indices. Negative ones are refused: Python would count them from the end."""
    try:
        faces = np.asarray(value)
    except (TypeError, ValueError) as failure:
        raise MeshError(
            f"faces must be (m, 3) integers, not {show_value(value)} ({failure})"
        ) from None
    if faces.ndim != 2 or faces.shape[1] != 3:
        hint = "; split quadrilaterals into triangles" if faces.shape[1:] == (4,) else ""
        raise MeshError(f"faces must be (m, 3) integers, not {show_array(faces)}{hint}")
    if faces.dtype.kind not in "iuf":
        raise MeshError(f"faces must be (m, 3) integers, not {show_array(faces)}")
    if faces.dtype.kind == "f" and not np.array_equal(faces, np.trunc(faces)):
        raise MeshError("faces must be integers; some are fractions or NaN")
    wrong = (faces < 0) | (faces >= vertex_count)
    if wrong.any():
        row, column = (int(i) for i in np.argwhere(wrong)[0])
        raise MeshError(
            f"{np.count_nonzero(wrong)} of {faces.size} face indices are out of range for "
            f"{vertex_count} vertices (first: {faces[row, column]} in face {row}, both counted from "
            "0); remove those faces, or export the mesh again"
        )
    return np.ascontiguousarray(faces, dtype=np.uint32)
