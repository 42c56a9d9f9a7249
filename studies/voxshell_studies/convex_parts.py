"""Convex decompositions of meshes by common libraries; the cache keeps slow ones."""

from __future__ import annotations

import hashlib
import os
import time
import warnings
from dataclasses import dataclass
from importlib import import_module, metadata
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal
from zipfile import BadZipFile

import numpy as np
from voxshell.base.outputs import make_folder, write_bytes
from voxshell.errors import MeshError, MissingExtraError
from voxshell.model.cache import CacheWarning
from voxshell.model.cache_place import find_folder, read_capacity
from voxshell.model.meshes import Mesh
from voxshell.simulation.world import BULLET_VERSION

from voxshell_studies.scenes.solids import simplify

if TYPE_CHECKING:
    from numpy.typing import NDArray

CONCAVITY = 0.05
"""CoACD's default concavity, as a fraction of the mesh's size."""

SEED = 0
"""Seed of CoACD's search."""

HULL_VERTICES = 100
"""Largest number of vertices of a hull of HACD and V-HACD, as in the thesis."""

HACD_CONCAVITY = 100.0
"""HACD's concavity for a mesh of size 1000, as in Bullet's own demo."""


@dataclass(frozen=True, eq=False)
class Parts:
    """A convex decomposition.

    Attributes:
        hulls: (n, 3) points of each part, meters, body frame.
        seconds: Time of the decomposition.
        version: Version of the library.
    """

    hulls: tuple[NDArray[np.float64], ...]
    seconds: float
    version: str


@dataclass(frozen=True)
class Recipe:
    """A decomposition method with its settings.

    Attributes:
        label: Label for people, with the settings that matter.
        library: The distribution that contains it.
        hulls: HACD: smallest number; V-HACD: largest number.
        voxels: V-HACD: voxels of its grid.
        concavity: CoACD: accepted concavity, as a fraction of the mesh's size.
        tolerance: HACD: accepted error of its simplified input, as a fraction of the mesh's size.
            HACD takes a minute for ten thousand triangles, and its time grows faster than their
            square.
    """

    label: str
    library: Literal["hacd", "vhacdx", "coacd"]
    hulls: int = 8
    voxels: int = 400_000
    concavity: float = CONCAVITY
    tolerance: float = 0.005

    @property
    def version(self) -> str | None:
        """Version of the library; None if it is not installed."""
        if self.library == "hacd":
            return f"of Bullet {BULLET_VERSION}" if find_spec(_HACD) is not None else None
        try:
            return metadata.version(self.library)
        except metadata.PackageNotFoundError:
            return None

    @property
    def advice(self) -> str:
        """Instructions to install it."""
        if self.library == "hacd":
            return "not built: install libbullet-extras-dev and build voxshell from its sources"
        return f"not installed: pip install {self.library}"

    @property
    def identity(self) -> str:
        """Everything that the parts of a mesh depend on."""
        if self.library == "coacd":
            return f"coacd {self.version} {self.concavity} {SEED}"
        if self.library == "hacd":
            return f"hacd {self.version} {self.hulls} {self.tolerance} {HACD_CONCAVITY} {HULL_VERTICES}"
        return f"vhacdx {self.version} {self.hulls} {self.voxels} {HULL_VERTICES}"


_HACD = "voxshell._hacd"

RECIPES = {
    "hacd": Recipe("HACD, 8 hulls", "hacd"),
    "vhacd": Recipe("V-HACD, 8 hulls", "vhacdx"),
    "vhacd-64": Recipe("V-HACD, 64 hulls", "vhacdx", hulls=64, voxels=2_000_000),
    "coacd": Recipe("CoACD", "coacd"),
    "coacd-fine": Recipe("CoACD, concavity 0.02", "coacd", concavity=0.02),
}


def split(mesh: Mesh, recipe: Recipe) -> Parts:
    """Return the convex parts of a mesh, from the cache if they are there.

    Args:
        mesh: A closed mesh.
        recipe: The method.

    Raises:
        MissingExtraError: The library is not installed.
        MeshError: The library finds no part.
    """
    path = find_place(mesh, recipe.identity)
    if path is not None and (kept := load_parts(path)) is not None:
        return kept
    made = make_parts(mesh, recipe)
    if path is not None:
        keep_parts(path, made)
    return made


def make_parts(mesh: Mesh, recipe: Recipe) -> Parts:
    """Return the convex parts of a mesh without the cache; see :func:`split`."""
    start = time.perf_counter()
    # HACD also returns flat parts, which do not collide.
    found = _SPLITTERS[recipe.library](mesh, recipe)
    hulls = tuple(points for points in found if _encloses_volume(points))
    if not hulls:
        raise MeshError(f"{recipe.label} found no convex part in the mesh")
    return Parts(hulls, time.perf_counter() - start, recipe.version or "")


def _encloses_volume(points: NDArray[np.float64]) -> bool:
    if len(points) < 4:
        return False
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(spread[2] > 1e-6 * spread[0])


def _run_hacd(mesh: Mesh, recipe: Recipe) -> tuple[NDArray[np.float64], ...]:
    hacd = _load(_HACD, recipe)
    simple = simplify(mesh, recipe.tolerance * float(np.ptp(mesh.vertices, axis=0).max()))
    return tuple(
        hacd.decompose(
            simple.vertices,
            simple.faces,
            clusters=recipe.hulls,
            hull_vertices=HULL_VERTICES,
            concavity=HACD_CONCAVITY,
        )
    )


def _run_vhacd(mesh: Mesh, recipe: Recipe) -> tuple[NDArray[np.float64], ...]:
    vhacdx = _load("vhacdx", recipe)
    parts = vhacdx.compute_vhacd(
        mesh.vertices,
        np.column_stack([np.full(len(mesh.faces), 3, np.uint32), mesh.faces]).ravel(),
        maxConvexHulls=recipe.hulls,
        resolution=recipe.voxels,
        maxNumVerticesPerCH=HULL_VERTICES,
    )
    return tuple(np.asarray(points, np.float64) for points, _ in parts)


def _run_coacd(mesh: Mesh, recipe: Recipe) -> tuple[NDArray[np.float64], ...]:
    coacd = _load("coacd", recipe)
    coacd.set_log_level("error")
    parts = coacd.run_coacd(
        coacd.Mesh(mesh.vertices, mesh.faces), threshold=recipe.concavity, seed=SEED
    )
    return tuple(np.asarray(points, np.float64) for points, _ in parts)


_SPLITTERS = {"hacd": _run_hacd, "vhacdx": _run_vhacd, "coacd": _run_coacd}


def _load(module: str, recipe: Recipe) -> Any:
    try:
        return import_module(module)
    except ImportError as error:
        raise MissingExtraError(f"{recipe.label} is {recipe.advice}") from error


def find_place(mesh: Mesh, identity: str) -> Path | None:
    """Return the file for the parts of a mesh, by content; None if the cache is off."""
    models = find_folder(os.environ)
    if models is None or read_capacity(os.environ) == 0:
        return None
    digest = hashlib.sha256(f"{identity};".encode())
    for array in mesh:
        digest.update(f"{array.dtype.str}{array.shape};".encode())
        digest.update(np.ascontiguousarray(array).data)
    return models.parent / "parts" / f"{digest.hexdigest()}.npz"


def load_parts(path: Path) -> Parts | None:
    """Load parts; return None if there are none, or if they are damaged."""
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
            hulls = tuple(np.split(arrays["points"], arrays["ends"][:-1]))
            return Parts(hulls, float(arrays["seconds"]), str(arrays["version"]))
    except (OSError, ValueError, KeyError, EOFError, BadZipFile):
        return None


def keep_parts(path: Path, parts: Parts) -> None:
    """Store parts where :func:`load_parts` finds them; warn if the system refuses."""
    content = BytesIO()
    np.savez_compressed(
        content,
        points=np.concatenate(parts.hulls),
        ends=np.cumsum([len(hull) for hull in parts.hulls]),
        seconds=parts.seconds,
        version=parts.version,
    )
    try:
        make_folder(path.parent)
        write_bytes(path, content.getbuffer())
    except OSError as error:
        warnings.warn(
            f"convex parts are not kept for the next run: {error}", CacheWarning, stacklevel=2
        )
