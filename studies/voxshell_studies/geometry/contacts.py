"""Errors of normals and points of contacts, compared with the nearest faces of the meshes."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from voxshell.base.poses import invert
from voxshell.query.queries import contacts

from voxshell_studies.geometry.models import (
    ORDERS,
    Pair,
    carry,
    find_surface,
    move,
)
from voxshell_studies.geometry.pairs import meet
from voxshell_studies.geometry.surface_truth import measure_angle
from voxshell_studies.part import as_columns
from voxshell_studies.scenes.geometry_bodies import make_body

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from voxshell.query.contact_set import Contacts

    from voxshell_studies.geometry.settings import GeometrySettings
    from voxshell_studies.geometry.surface_truth import Surface
    from voxshell_studies.part import Tables

JUDGED = ("angle", "a_off", "b_off", "voxel", "ambiguous")
"""The measured properties of a judged contact."""

MET = ("cube 50 mm", "ball 30 mm")
"""Bodies that thin ones meet in any pose."""

MET_DEPTH = 1e-3
"""Depth beyond the first touch at which they are queried, meters."""

_SURELY_RIGHT = np.radians(2.0)
"""Distance to the nearest surface below which no other entry surface is considered."""


class _Placed(NamedTuple):
    """A body's faces, its pose in the world, and the inverse."""

    surface: Surface
    pose: NDArray[np.float64]
    local: NDArray[np.float64]


def measure_contacts(settings: GeometrySettings, body: str) -> Tables:
    """Judge contacts of a thin body with those of :data:`MET`, in any pose, at :data:`MET_DEPTH`.

    Returns:
        "contacts", a row for each that is judged: as :func:`judge_contacts` says.
    """
    rng = np.random.default_rng((settings.seed, len(body)))
    rows: list[tuple[float, ...]] = []
    for other in MET:
        pair = Pair(other, body)
        meetings = [
            meet(make_body(other), make_body(body), rng) for _ in range(settings.judged_pairs)
        ]
        for meeting in meetings:
            if meeting is None:
                continue
            pose = move(meeting.pose, meeting.direction, MET_DEPTH)
            for order in ORDERS:
                found = pair.ask(contacts, pose, order)
                rows += judge_contacts(pair, pose, found, order, settings.judged)
    return {"contacts": as_columns(JUDGED, rows)}


def judge_contacts(
    pair: Pair, b_from_a: NDArray[np.float64], found: Contacts, order: int, most: int
) -> list[tuple[float, ...]]:
    """Measure the errors of the deepest contacts with respect to the meshes.

    Args:
        pair: The queried pair.
        b_from_a: Its pose.
        found: The result of ``contacts``.
        order: The order of the bodies in the query.
        most: Largest number of contacts to judge.

    Returns:
        Rows of :data:`JUDGED`: the angle of the normal, radians; the errors of the points on the
        first and second body and the voxel size of the field, meters; and whether the contact
        reports an ambiguous depth.
    """
    if len(found) == 0:
        return []
    chosen = np.unique(np.linspace(0, len(found) - 1, most).astype(int))
    chosen = np.union1d(chosen, [int(np.argmax(found.depths))])
    # The first and the second body of the query, with their poses in the world, which is b's frame.
    bodies = [
        _Placed(find_surface(pair.a), b_from_a, invert(b_from_a)),
        _Placed(find_surface(pair.b), np.eye(4), np.eye(4)),
    ]
    if order == 1:
        bodies.reverse()
    places = found.points_a[chosen], found.points_b[chosen]
    off = [
        body.surface.measure_distances(carry(body.local, some))
        for body, some in zip(bodies, places, strict=True)
    ]
    first_is_shell = found.shells[chosen] == "a"
    angles, voxels = np.empty(len(chosen)), np.empty(len(chosen))
    for side, mine in ((0, first_is_shell), (1, ~first_is_shell)):
        # Out of the body through whose surface the point entered.
        outward = found.normals[chosen[mine]] * (1.0 if side == 0 else -1.0)
        angles[mine] = _find_angles(bodies[side], bodies[1 - side], places[side][mine], outward)
        voxels[mine] = pair.find_voxel_size((side == 0) == (order == 1))
    columns = (angles, *off, voxels, found.ambiguous[chosen].astype(np.float64))
    return list(zip(*(column.tolist() for column in columns), strict=True))


def _find_angles(
    shell: _Placed, field: _Placed, places: NDArray[np.float64], normals: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return angles from normals to those of the nearest or the entered surface, radians."""
    inside = carry(field.local, places)
    outward = normals @ field.local[:3, :3].T
    angles = np.array(
        [
            min(measure_angle(normal, cone) for cone in cones)
            for normal, (_, cones) in zip(outward, field.surface.find_nearest(inside), strict=True)
        ]
    )
    doubtful = np.flatnonzero(angles >= _SURELY_RIGHT)
    own = shell.surface.find_nearest(carry(shell.local, places[doubtful]))
    into_field = field.local[:3, :3] @ shell.pose[:3, :3]
    for index, (_, cones) in zip(doubtful, own, strict=True):
        for own_normal in np.unique(np.concatenate(cones).round(6), axis=0):
            backward = -(into_field @ own_normal)
            entry = field.surface.find_entry(inside[index], backward / np.linalg.norm(backward))
            if entry is not None:
                angles[index] = min(angles[index], measure_angle(outward[index], entry[None]))
    return angles
