"""Convex parts of the body by CoACD, in a separate process with a time limit."""

from __future__ import annotations

from typing import TYPE_CHECKING

from voxshell_studies.convex_parts import (
    RECIPES,
    Parts,
    find_place,
    keep_parts,
    load_parts,
    make_parts,
)
from voxshell_studies.peers.apart import Ending, run_apart

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from voxshell.model.meshes import Mesh

RECIPE = RECIPES["coacd"]


def fetch_parts(
    mesh: Mesh, *, limit: float, log: Path, only_kept: bool
) -> tuple[Parts | None, Ending]:
    """Return the parts of a mesh, which the cache keeps.

    Args:
        mesh: A closed mesh.
        limit: Time limit of CoACD, seconds.
        log: File for CoACD's output.
        only_kept: Do not run CoACD.

    Returns:
        The parts or None, and how the process ended; "missing" if ``only_kept`` and there are none.
    """
    path = find_place(mesh, RECIPE.identity)
    if path is not None and (kept := load_parts(path)) is not None:
        return kept, Ending("done")
    if only_kept:
        return None, Ending("missing", "no parts are kept from an earlier run")
    made: list[Parts] = []
    ending = run_apart(decompose, {"mesh": mesh}, made.append, limit=limit, log=log)
    if made and path is not None:
        keep_parts(path, made[0])
    return (made[0] if made else None), ending


def decompose(mesh: Mesh) -> Iterator[Parts]:
    """Run CoACD, on all cores.

    Raises:
        MissingExtraError: It is not installed.
    """
    yield make_parts(mesh, RECIPE)
