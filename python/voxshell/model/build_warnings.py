"""What a new model's builder found: faults of its mesh and a missed tolerance."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from voxshell.base.user_warnings import warn_user
from voxshell.model.accuracy import AccuracyWarning, read_accuracy
from voxshell.model.meshes import MeshWarning

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from voxshell._core import Model as CoreModel

_LARGE_FIELD = 64.0  # megabytes; models by tolerance warn above this
_COARSE = 5.0  # tolerances in the shortest side below which a tolerance is probably in millimeters
_FAR_OFF = 4.0  # accepted error of the worst place, in tolerances; 1.4 is proven for closed meshes
# Factor on a tolerance that would just do, because errors jump with the size of voxels.
_SPARE = 2.0


class Finding(NamedTuple):
    """What is wrong with a model, in parts from which messages are made.

    Attributes:
        category: Of the warning.
        text: The warning about one model that :meth:`Model.from_mesh` builds, with its remedies.
        defect: What is wrong, for a list of several models: "3 open edges".
        handling: What was done about it, if anything: "voxshell turned it".
    """

    category: type[Warning]
    text: str
    defect: str
    handling: str


def warn_of(findings: Iterable[Finding]) -> None:
    """Warn about each finding."""
    for finding in findings:
        warn_user(finding.text, finding.category)


def find_flaws(
    core: CoreModel, widest_rim: float, *, sign: str = "auto", open_as: str = "auto"
) -> list[Finding]:
    """Return the faults of a new model's mesh, and how it misses its tolerance.

    Args:
        core: The model.
        widest_rim: Largest distance between two points of one rim of the mesh, meters.
        sign: How its inside was found; a caller who chose that knows of the faults.
        open_as: The caller's choice for open meshes.
    """
    found = _find_faults(core, widest_rim, open_as) if sign == "auto" else []
    if core.tolerance > 0.0:
        found += _find_inaccuracy(core)
    return found


def _find_faults(core: CoreModel, widest_rim: float, open_as: str) -> list[Finding]:
    """Return the faults of a mesh, and how they were handled.

    Args:
        core: The model.
        widest_rim: Largest distance between two points of one rim of the mesh, meters.
        open_as: The caller's choice for open meshes.
    """
    grid = core.grid
    found = []
    if grid.was_turned:
        defect, handling = "inside out as a whole", "voxshell turned it"
        found.append(_fault(f"mesh is {defect}; {handling}", defect, handling))
    opening = _describe_openings(core, widest_rim, open_as)
    open_edges, non_manifold, flipped, overlaps, hidden = grid.faults
    place = ", ".join(f"{coordinate:.4g}" for coordinate in grid.first_fault)
    faults = [
        _count(number, what)
        for number, what in (
            (open_edges, "open edge"),
            (non_manifold, "non-manifold edge"),
            (flipped, "wrongly oriented edge"),
        )
        if number
    ]
    if grid.sign_method == "closed":
        if opening:
            found.append(opening._replace(text=f"mesh is open: {opening.text}"))
        elif flipped or non_manifold:
            defect = ", ".join(faults)
            handling = "voxshell turned its triangles to face outward, and dropped repeated ones"
            found.append(
                _fault(
                    f"mesh has {defect}, the first near [{place}] meters; {handling}; the model's mesh is closed",
                    defect,
                    handling,
                )
            )
        return found
    if not (open_edges or non_manifold or flipped or overlaps or opening):
        return found  # closed parts that touch are not a fault
    union = ""
    if overlaps or hidden:
        inside = f" ({_count(hidden, 'triangle')} wholly or partly inside others)" if hidden else ""
        faults.append(f"overlapping parts{inside}")
        union = "the model is the union of its parts"
    defect, handling = ", ".join(faults), "winding numbers decide what is inside"
    more = ("", "", "")
    if opening:
        more = f"; {opening.text}", f", {opening.defect}", f", and {opening.handling}"
    found.append(
        _fault(
            f"mesh is not one closed surface: {defect}, the first near [{place}] meters; {handling}, "
            f"with a confidence of {grid.sign_confidence:.3f}{union and '; '}{union}{more[0]}; "
            "repair the mesh, or pass sign='winding' to silence this warning",
            f"{defect}{more[1]}",
            f"{handling}{union and ', and '}{union}{more[2]}",
        )
    )
    return found


def _count(number: int, what: str) -> str:
    """Return a number of things: "1 open edge", "2 open edges"."""
    return f"{number} {what}{'' if number == 1 else 's'}"


def warn_of_coarse_tolerance(tolerance: float, extents: NDArray[np.float64]) -> None:
    """Warn of a tolerance that is coarse for the mesh, as one in millimeters is.

    Args:
        tolerance: As given to the build, meters.
        extents: Of the mesh, (3,), meters. A flat sheet has a shortest side of 0, which says nothing.
    """
    shortest = float(extents.min())
    if 0.0 < shortest < _COARSE * tolerance:
        warn_user(
            f"a tolerance of {tolerance:g} m is {tolerance / shortest:.2g} times the mesh's shortest side of "
            f"{shortest:.3g} m, so the model is coarse: check its unit; 0.1 mm is tolerance=0.0001",
            AccuracyWarning,
        )


def _find_inaccuracy(core: CoreModel) -> list[Finding]:
    """Return how a model that was built to a tolerance misses it, and whether it is large."""
    found = []
    tolerance, accuracy = core.tolerance, read_accuracy(core)
    megabytes = core.grid.nbytes / 1e6
    if megabytes > _LARGE_FIELD:
        found.append(
            Finding(
                AccuracyWarning,
                f"the model's field takes {megabytes:.0f} MB, because much of the mesh is rough at its tolerance "
                f"of {tolerance * 1e3:.3g} mm; pass a larger tolerance to reduce it",
                f"a field of {megabytes:.0f} MB, because much of it is rough at the tolerance of "
                f"{tolerance * 1e3:.3g} mm",
                "",
            )
        )
    reached = max(accuracy.distance.p99, accuracy.coverage.p99)
    worst = max(accuracy.distance.max, accuracy.coverage.max)
    if reached <= tolerance and worst <= _FAR_OFF * tolerance:
        return found
    missed = []
    if reached > tolerance:
        missed.append(
            f"on 99 % of its surface the field's error is at most {accuracy.distance.p99 * 1e3:.3g} mm and the "
            f"shell's {accuracy.coverage.p99 * 1e3:.3g} mm"
        )
    if worst > _FAR_OFF * tolerance:
        missed.append(
            f"the largest error is {worst * 1e3:.3g} mm, and at most {_FAR_OFF:g} tolerances are accepted anywhere"
        )
    open_edges, non_manifold, flipped, _, _ = core.grid.faults
    why = ""
    if open_edges or non_manifold or flipped:
        why = "; exact cells need a closed mesh, so repair it if you can"
    elif core.grid.sign_method != "closed":
        why = "; cells may not be exact where parts of the mesh touch, so unite these if you can"
    larger = _choose_larger(tolerance, reached, worst)
    coarse = _COARSE * larger > np.ptp(core.vertices, axis=0).min()
    advice = "" if coarse else f"a larger tolerance, such as tolerance={larger:.2g}, or "
    found.append(
        Finding(
            AccuracyWarning,
            f"the model misses its tolerance of {tolerance * 1e3:.3g} mm: {'; '.join(missed)}{why}; pass {advice}"
            f"voxel_size={core.grid.voxel_size:.2g} for a uniform model",
            f"misses the tolerance of {tolerance * 1e3:.3g} mm by up to {worst * 1e3:.3g} mm",
            "",
        )
    )
    return found


def _choose_larger(tolerance: float, reached: float, worst: float) -> float:
    """Return a tolerance that a mesh will probably meet, in two digits, meters.

    Voxels grow with the tolerance, and where cells are not exact, the error grows about with its square root.

    Args:
        tolerance: That it misses.
        reached: Its error on 99 % of the surface.
        worst: Its largest error.
    """
    needed = max(reached, worst / _FAR_OFF)
    larger = _SPARE * needed * max(1.0, needed / tolerance)
    digit = 10.0 ** (math.floor(math.log10(larger)) - 1)
    return math.ceil(larger / digit) * digit


def _fault(text: str, defect: str, handling: str) -> Finding:
    return Finding(MeshWarning, text, defect, handling)


def _describe_openings(core: CoreModel, widest_rim: float, open_as: str) -> Finding | None:
    """Return the openings and how they were handled; None if there are none or the caller chose that."""
    loops, fraction, mouths, diameter, first, thickness = core.openings
    if loops == 0 or open_as != "auto":
        return None
    place = ", ".join(f"{coordinate:.4g}" for coordinate in first)
    count = "1 opening" if loops == 1 else f"{loops} openings"
    defect = f"{count}, the largest {widest_rim or diameter:.3g} m across"
    where = (
        f"{defect}, the first near [{place}] meters; caps over them would have {100.0 * fraction:.3g} % of "
        "the surface's area"
    )
    if thickness > 0.0:
        tube = f", and {mouths} of them are ends of a tube" if mouths > 1 else ""
        handling = f"voxshell kept it as a sheet {thickness:.3g} m thick"
        return _fault(
            f"{where}{tube}, so {handling}; pass open='sheet' and sheet_thickness for another thickness, "
            "or open='solid' to close it",
            defect,
            handling,
        )
    handling = "voxshell closed it to a solid"
    return _fault(
        f"{where}, so {handling}; pass open='sheet' to keep it as a sheet", defect, handling
    )
