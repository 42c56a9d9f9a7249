"""Warnings about a new model: faults of its mesh and a missed tolerance."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from voxshell.base.user_warnings import warn_user
from voxshell.model.accuracy import AccuracyWarning
from voxshell.model.meshes import MeshWarning

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell._core import Model as CoreModel
    from voxshell.model.accuracy import Accuracy
    from voxshell.model.field import DistanceField

_LARGE_FIELD = 64.0  # megabytes; models by tolerance warn above this
_COARSE = 5.0  # tolerances in the shortest side below which a tolerance is probably in millimeters
_FAR_OFF = 4.0  # accepted error of the worst place, in tolerances; 1.4 is proven for closed meshes


def warn_of_faults(core: CoreModel, open_as: str) -> None:
    """Warn about the faults of a mesh, and say how they were handled.

    Args:
        core: The model.
        open_as: The caller's choice for open meshes.
    """
    grid = core.grid
    if grid.was_turned:
        warn_user("mesh is inside out as a whole; it was turned", MeshWarning)
    openings = _describe_openings(core, open_as)
    open_edges, non_manifold, flipped, overlaps, hidden = grid.faults
    place = ", ".join(f"{coordinate:.4g}" for coordinate in grid.first_fault)
    if grid.sign_method == "closed":
        if openings:
            warn_user(f"mesh is open: {openings}", MeshWarning)
        elif flipped or non_manifold:
            warn_user(
                f"mesh has {open_edges} open, {non_manifold} non-manifold and {flipped} wrongly oriented "
                f"edges (first near [{place}] meters); its triangles were turned to face outward, and "
                "repeated ones left out; the model's mesh is closed",
                MeshWarning,
            )
        return
    if not (open_edges or non_manifold or flipped or overlaps or openings):
        return  # closed parts that touch are not a fault
    faults = ", ".join(
        f"{count} {what}"
        for count, what in (
            (open_edges, "open edges"),
            (non_manifold, "non-manifold edges"),
            (flipped, "wrongly oriented edges"),
            (overlaps, "grid nodes enclosed more than once"),
            (hidden, "triangles wholly or partly inside others"),
        )
        if count
    )
    warn_user(
        f"mesh is not one closed surface: {faults} (first near [{place}] meters); winding numbers "
        f"decide what is inside, with a confidence of {grid.sign_confidence:.3f}; repair it, or pass "
        f"sign='winding' to accept it{openings and '; '}{openings}",
        MeshWarning,
    )


def warn_of_coarse_tolerance(tolerance: float, vertices: NDArray[np.float64]) -> None:
    """Warn of a tolerance that is coarse for the mesh, as one in millimeters is.

    Args:
        tolerance: As given to the build, meters.
        vertices: (n, 3), meters. A flat sheet has a shortest side of 0, which says nothing.
    """
    shortest = float(np.ptp(vertices, axis=0).min())
    if 0.0 < shortest < _COARSE * tolerance:
        warn_user(
            f"a tolerance of {tolerance:g} m is {tolerance / shortest:.2g} times the mesh's shortest side of "
            f"{shortest:.3g} m, so the model is coarse: check its unit; 0.1 mm is tolerance=0.0001",
            AccuracyWarning,
        )


def warn_of_accuracy(tolerance: float, field: DistanceField, accuracy: Accuracy) -> None:
    """Warn if a model that was built to a tolerance misses it."""
    megabytes = field.nbytes / 1e6
    if megabytes > _LARGE_FIELD:
        warn_user(
            f"the model's field takes {megabytes:.0f} MB, because much of the mesh is rough at its tolerance "
            f"of {tolerance * 1e3:.3g} mm; pass a larger tolerance to reduce it",
            AccuracyWarning,
        )
    reached = max(accuracy.distance.p99, accuracy.coverage.p99)
    worst = max(accuracy.distance.max, accuracy.coverage.max)
    if reached <= tolerance and worst <= _FAR_OFF * tolerance:
        return
    distance, coverage = accuracy.distance.p99 * 1e3, accuracy.coverage.p99 * 1e3
    closed = field.sign_method == "closed"
    why = "" if closed else "; exact cells need a closed mesh, so repair it if you can"
    warn_user(
        f"the model misses its tolerance of {tolerance * 1e3:.3g} mm: on 99 % of its surface the field's error "
        f"is at most {distance:.3g} mm and the shell's {coverage:.3g} mm; the largest error is {worst * 1e3:.3g} mm"
        f"{why}; pass a tolerance of {reached:.3g} m to accept this, or a voxel_size for a uniform model",
        AccuracyWarning,
    )


def _describe_openings(core: CoreModel, open_as: str) -> str:
    """Return how openings were handled; empty if there are none or the caller chose that."""
    loops, fraction, mouths, diameter, first, thickness = core.openings
    if loops == 0 or open_as != "auto":
        return ""
    place = ", ".join(f"{coordinate:.4g}" for coordinate in first)
    count = "1 opening" if loops == 1 else f"{loops} openings"
    where = (
        f"{count}, the largest {diameter:.3g} m across, the first near [{place}] meters; caps would "
        f"have {100.0 * fraction:.3g} % of the surface's area"
    )
    if thickness > 0.0:
        tube = f", and {mouths} of them are ends of a tube" if mouths > 1 else ""
        return (
            f"{where}{tube}, so it was kept as a sheet {thickness:.3g} m thick; pass open='sheet' "
            "and sheet_thickness for another thickness, or open='solid' to close it"
        )
    return f"{where}, so it was closed to a solid; pass open='sheet' to keep it as a sheet"
