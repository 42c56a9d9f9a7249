"""Building what a model consists of from a mesh, or loading it from the cache."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from voxshell._core import Model as CoreModel
from voxshell.errors import MemoryLimitError, MeshError
from voxshell.model.cache import compute_key, open_cache
from voxshell.model.meshes import doubt_unit, name_of, naming_file, read_mesh
from voxshell.model.rims import measure_widest_rim

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from voxshell.model.meshes import MeshLike


_FINEST = 16_777
"""Largest resolution: single precision places a point of a centered mesh within a 1,000th of a voxel up to here."""


class BuiltCore(NamedTuple):
    """A model's core and its mesh.

    Attributes:
        core: The core.
        doubt: Why the mesh is probably not in meters, or "".
        extents: Of the mesh, (3,) float64, meters.
        widest_rim: Largest distance between two points of one rim of the mesh, meters; 0 if it is closed.
    """

    core: CoreModel
    doubt: str
    extents: NDArray[np.float64]
    widest_rim: float


def build_core(
    mesh: MeshLike,
    settings: dict[str, Any],
    *,
    scale: float | None = None,
    threads: int = 0,
    is_cached: bool = True,
    progress: Callable[[str, float], object] | None = None,
) -> BuiltCore:
    """Return the core of a model, and what is known of its mesh; nothing is warned of.

    Args:
        mesh: As for :meth:`Model.from_mesh`.
        settings: Of :func:`as_settings`.
        scale: As for :meth:`Model.from_mesh`.
        threads: Their number; 0 for one per CPU core.
        is_cached: ``cache`` of :meth:`Model.from_mesh`.
        progress: As for :meth:`Model.from_mesh`.

    Raises:
        VoxshellError: As for :meth:`Model.from_mesh`.
    """
    with naming_file(mesh):
        arrays = read_mesh(mesh, scale)
    doubt = doubt_unit(mesh, arrays.vertices) if scale is None else ""
    if settings["resolution"] > _FINEST:
        raise MeshError(
            f"a resolution of {settings['resolution']} is too fine for single precision, wherever the mesh's origin "
            f"is; pass at most {_FINEST}"
        )

    def build() -> CoreModel:
        return CoreModel.build(*arrays, **settings, threads=threads, progress=progress)

    def waiting() -> None:
        if progress is not None:
            progress("waiting for another process", 0.0)

    try:
        with naming_file(mesh):
            if is_cached:
                key = compute_key(arrays, settings)
                core = open_cache().fetch(key, build, waiting, name_of(mesh))
            else:
                core = build()
    except (MeshError, MemoryLimitError) as error:
        if not doubt:
            raise
        raise type(error)(f"{error}; {doubt}") from None
    is_open = core.openings[0] > 0
    rim = measure_widest_rim(arrays.vertices, arrays.faces) if is_open else 0.0
    return BuiltCore(core, doubt, np.ptp(arrays.vertices, axis=0), rim)
