"""The body as convex parts, by CoACD: what people use today. It takes minutes, so parts are kept."""

from __future__ import annotations

import hashlib
import os
import time
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING
from zipfile import BadZipFile

import numpy as np

from voxshell.cache import find_folder, read_capacity
from voxshell.experiments.files import replacing
from voxshell.experiments.peers.apart import Ending, run_apart
from voxshell.experiments.peers.protocol import load_library

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from voxshell.meshes import Mesh

THRESHOLD = 0.05
"""CoACD's own default of the concavity that it leaves."""

SEED = 0


@dataclass(frozen=True, eq=False)
class Parts:
    """A convex decomposition.

    Attributes:
        hulls: (n, 3) points of each part, metres, body frame.
        seconds: That CoACD took.
        version: Of CoACD.
    """

    hulls: tuple[NDArray[np.float64], ...]
    seconds: float
    version: str


def fetch_parts(
    mesh: Mesh, *, limit: float, log: Path, only_kept: bool
) -> tuple[Parts | None, Ending]:
    """The parts of a mesh, kept beside the models in the cache.

    Args:
        mesh: Closed.
        limit: Seconds that CoACD may take.
        log: Takes what CoACD prints.
        only_kept: Do not run CoACD.

    Returns:
        The parts or None, and how it ended; "missing" where ``only_kept`` and there are none.
    """
    path = _place(mesh)
    if path is not None and (kept := _load(path)) is not None:
        return kept, Ending("done")
    if only_kept:
        return None, Ending("missing", "no parts are kept from an earlier run")
    made: list[Parts] = []
    ending = run_apart(decompose, {"mesh": mesh}, made.append, limit=limit, log=log)
    if made and path is not None:
        _store(path, made[0])
    return (made[0] if made else None), ending


def decompose(mesh: Mesh) -> Iterator[Parts]:
    """Runs CoACD, on all cores.

    Raises:
        MissingExtraError: It is not installed.
    """
    coacd = load_library("coacd", "coacd")
    start = time.perf_counter()
    parts = coacd.run_coacd(coacd.Mesh(mesh.vertices, mesh.faces), threshold=THRESHOLD, seed=SEED)
    hulls = tuple(np.asarray(vertices, np.float64) for vertices, _ in parts)
    yield Parts(hulls, time.perf_counter() - start, metadata.version("coacd"))


def _place(mesh: Mesh) -> Path | None:
    """By content; None where nothing is to be kept."""
    models = find_folder(os.environ)
    if models is None or read_capacity(os.environ) <= 0:
        return None
    try:
        version = metadata.version("coacd")
    except metadata.PackageNotFoundError:
        return None
    digest = hashlib.sha256(f"coacd {version} {THRESHOLD} {SEED};".encode())
    for array in mesh:
        digest.update(f"{array.dtype.str}{array.shape};".encode())
        digest.update(np.ascontiguousarray(array).data)
    return models.parent / "parts" / f"{digest.hexdigest()}.npz"


def _load(path: Path) -> Parts | None:
    """None where there are none, or none that can be read."""
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
            hulls = tuple(np.split(arrays["points"], arrays["ends"][:-1]))
            return Parts(hulls, float(arrays["seconds"]), str(arrays["version"]))
    except (OSError, ValueError, KeyError, EOFError, BadZipFile):
        return None


def _store(path: Path, parts: Parts) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as temporary:
        np.savez_compressed(
            temporary,
            points=np.concatenate(parts.hulls),
            ends=np.cumsum([len(hull) for hull in parts.hulls]),
            seconds=parts.seconds,
            version=parts.version,
        )
