"""Warns of what a new model falls short of: faults of its mesh, and its tolerance."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

from voxshell.model.accuracy import AccuracyWarning
from voxshell.model.meshes import MeshWarning

if TYPE_CHECKING:
    from voxshell._core import Model as CoreModel
    from voxshell.model.accuracy import Accuracy
    from voxshell.model.field import DistanceField

_LARGE_FIELD = 64.0  # megabytes, from which on models by tolerance warn
_FAR_OFF = 4.0  # tolerances that the worst place may be off: what is proved of closed meshes is 1.4


def warn_of_faults(core: CoreModel, open_as: str) -> None:
    """Warns of what is wrong with a mesh, and says what was made of it.

    Args:
        core: The model.
        open_as: What the caller chose for open meshes.
    """
    grid = core.grid
    if grid.was_turned:
        warnings.warn("mesh is inside out as a whole; it was turned", MeshWarning, stacklevel=3)
    openings = _describe_openings(core, open_as)
    open_edges, non_manifold, flipped, overlaps, hidden = grid.faults
    place = ", ".join(f"{coordinate:.4g}" for coordinate in grid.first_fault)
    if grid.sign_method == "closed":
        if openings:
            warnings.warn(f"mesh is open: {openings}", MeshWarning, stacklevel=3)
        elif flipped or non_manifold:
            warnings.warn(
                f"mesh has {open_edges} open, {non_manifold} non-manifold and {flipped} wrongly oriented "
                f"edges (first near [{place}] metres); its triangles were turned to face outwards, and "
                "repeated ones left out; the model's mesh is closed",
                MeshWarning,
                stacklevel=3,
            )
        return
    if not (open_edges or non_manifold or flipped or overlaps or openings):
        return  # closed parts that touch: nothing is wrong with the mesh
    warnings.warn(
        f"mesh is not one closed surface: {open_edges} open, {non_manifold} non-manifold and "
        f"{flipped} wrongly oriented edges, {overlaps} grid nodes enclosed more than once, "
        f"{hidden} triangles wholly or partly inside others (first near [{place}] metres); winding numbers tell what "
        f"is inside, with a confidence of {grid.sign_confidence:.3f}; repair it, or pass "
        f"sign='winding' to accept it{openings and '; '}{openings}",
        MeshWarning,
        stacklevel=3,
    )


def warn_of_accuracy(tolerance: float, field: DistanceField, accuracy: Accuracy) -> None:
    """Warns where a model built to a tolerance falls short of it."""
    megabytes = field.nbytes / 1e6
    if megabytes > _LARGE_FIELD:
        warnings.warn(
            f"the model's field takes {megabytes:.0f} MB, as much of the mesh is rough at its tolerance "
            f"of {tolerance * 1e3:.3g} mm; pass a larger tolerance for less",
            AccuracyWarning,
            stacklevel=3,
        )
    reached = max(accuracy.distance.p99, accuracy.coverage.p99)
    worst = max(accuracy.distance.max, accuracy.coverage.max)
    if reached <= tolerance and worst <= _FAR_OFF * tolerance:
        return
    distance, coverage = accuracy.distance.p99 * 1e3, accuracy.coverage.p99 * 1e3
    closed = field.sign_method == "closed"
    why = "" if closed else "; exact cells need a closed mesh, so repairing it would help most"
    warnings.warn(
        f"the model is to be exact to {tolerance * 1e3:.3g} mm, but on 99 % of its surface the field "
        f"is exact to {distance:.3g} mm and the shell to {coverage:.3g} mm, and at worst to {worst * 1e3:.3g} mm"
        f"{why}; pass a tolerance of {reached:.3g} m to accept this, or, for a uniform model, a voxel_size",
        AccuracyWarning,
        stacklevel=3,
    )


def _describe_openings(core: CoreModel, open_as: str) -> str:
    """What was made of the openings, unless the caller chose that; nothing where there are none."""
    loops, share, mouths, diameter, first, thickness = core.openings
    if loops == 0 or open_as != "auto":
        return ""
    place = ", ".join(f"{coordinate:.4g}" for coordinate in first)
    count = "1 opening" if loops == 1 else f"{loops} openings"
    where = (
        f"{count}, the largest {diameter:.3g} m across, the first near [{place}] metres; caps would "
        f"have {100.0 * share:.3g} % of the surface's area"
    )
    if thickness > 0.0:
        tube = f", and {mouths} of them are ends of a tube" if mouths > 1 else ""
        return (
            f"{where}{tube}, so it was kept as a sheet {thickness:.3g} m thick; pass open='sheet' "
            "and sheet_thickness for another thickness, or open='solid' to close it"
        )
    return f"{where}, so it was closed to a solid; pass open='sheet' to keep it as a sheet"
