"""Pairs of mixed size in any pose: whether stated bounds hold, and the worst poses."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from voxshell.query.queries import collide

from voxshell_studies.geometry.first_touch import find_first_touch
from voxshell_studies.geometry.models import (
    ORDERS,
    Pair,
    measure_gap,
    measure_reach,
    move,
    overlap,
)
from voxshell_studies.part import as_columns
from voxshell_studies.scenes.geometry import PAIRS, random_rotation, turn_about_axis
from voxshell_studies.scenes.geometry_bodies import make_body

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Literal

    from numpy.typing import NDArray
    from voxshell.model.meshes import Mesh

    from voxshell_studies.geometry.settings import GeometrySettings
    from voxshell_studies.part import Tables

_OFFSETS = 5
"""Poses of a pair on each of its approaches."""

_LOOKED_AT = 50
"""Number of denied overlaps farthest beyond the first touch, of which the deepest are worsened."""

_STARTS = 3
"""Number of overlaps to worsen."""

_SHALLOW = 1e-5
"""Smallest distance of a random pose from the first touch, meters."""

_PLACES = 100
"""Places on the surface of an overlap to measure."""


class Meeting(NamedTuple):
    """A pose at first touch, and the direction of the approach."""

    pose: NDArray[np.float64]
    direction: NDArray[np.float64]


class _Missed(NamedTuple):
    """A denied overlap, and its distance beyond the first touch, meters."""

    offset: float
    meeting: Meeting


def measure_pair(settings: GeometrySettings, index: int) -> Tables:
    """Query a pair in many poses near the first touch, and search for the worst.

    Returns:
        "poses" has a row for each pose and order: "offset" beyond the first touch along a random
        direction; whether the meshes overlap, and whether ``collide`` says yes; the stated bounds
        ("overlap", which it must detect, and "clearance", which it must deny), meters; and
        "proven", the depth or distance where the answer violates a bound, otherwise 0, meters.
        "worst" has a row for each order: the depth of the shell's surface in the other body in the
        worst denied overlap, from random poses and after the search, meters.
    """
    a, b = PAIRS[index]
    rng = np.random.default_rng((settings.seed, index))
    pair = Pair(a, b)
    mesh_a, mesh_b = make_body(a), make_body(b)
    size = min(float(np.ptp(mesh.vertices, axis=0).max()) for mesh in (mesh_a, mesh_b))
    count = max(1, settings.pair_poses // max(settings.pairs, 1) // _OFFSETS)
    stated = [pair.state_bounds(order) for order in ORDERS]
    rows: list[tuple[float, ...]] = []
    missed: tuple[list[_Missed], ...] = ([], [])
    meetings: list[Meeting] = []
    for _ in range(count):
        meeting = meet(mesh_a, mesh_b, rng)
        if meeting is None:
            continue
        meetings.append(meeting)
        depths = 10.0 ** rng.uniform(np.log10(_SHALLOW), np.log10(0.15 * size), _OFFSETS)
        signs = np.where(rng.random(_OFFSETS) < 0.6, 1.0, -1.0)
        for offset in (depths * signs).tolist():
            pose = move(meeting.pose, meeting.direction, offset)
            said = [pair.ask(collide, pose, order) for order in ORDERS]
            # After a body has passed through a thin one, "no" is correct again.
            overlaps = offset > 0.0 and (all(said) or not overlap(a, b, pose).is_empty())
            for order in ORDERS:
                bounds = stated[order]
                proven = 0.0
                if overlaps and not said[order]:
                    missed[order].append(_Missed(offset, meeting))
                    if offset > bounds.overlap:
                        proven = _prove_depth(pair, pose, order, bounds.shell)
                elif -offset > bounds.clearance and said[order]:
                    proven = measure_gap(a, b, pose, -1.01 * offset)
                rows.append(
                    (
                        *(offset, order, float(overlaps), float(said[order])),
                        *(bounds.overlap, bounds.clearance, proven),
                    )
                )
    if settings.optimized > 0:
        for order in ORDERS:
            if not missed[order]:
                missed[order].extend(_miss_shallow(pair, order, meetings[:_LOOKED_AT]))
    names = ("offset", "order", "overlaps", "yes", "overlap", "clearance", "proven")
    return {
        "poses": as_columns(names, rows),
        "worst": as_columns(
            ("order", "random", "optimized"),
            [
                _worsen(settings, pair, order, stated[order].shell, missed[order], rng)
                for order in ORDERS
            ],
        ),
    }


def meet(a: Mesh, b: Mesh, rng: np.random.Generator) -> Meeting | None:
    """Return a pose of first touch from a random orientation and random places that meet."""
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    pose = np.eye(4)
    pose[:3, :3] = random_rotation(rng)
    place_a = pose[:3, :3] @ _pick(a, rng)
    pose[:3, 3] = _pick(b, rng) - place_a
    touch = find_first_touch(a, b, pose, direction)
    return Meeting(move(pose, direction, touch), direction) if np.isfinite(touch) else None


def _pick(mesh: Mesh, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return a random place on a random face, (3,)."""
    fractions = rng.dirichlet(np.ones(3))
    return fractions @ mesh.vertices[mesh.faces[rng.integers(len(mesh.faces))]]


def _miss_shallow(pair: Pair, order: int, meetings: list[Meeting]) -> list[_Missed]:
    """Return denied overlaps at smaller depths, if random poses found none."""
    offsets = [
        _find_last_no(pair, meeting.pose, meeting.direction, order, 0.25 * _SHALLOW)
        for meeting in meetings
    ]
    return [
        _Missed(offset, meeting)
        for offset, meeting in zip(offsets, meetings, strict=True)
        if offset > 0.0
    ]


def _prove_depth(
    pair: Pair, pose: NDArray[np.float64], order: int, shell: Literal["a", "b", "both"]
) -> float:
    """Return the proven depth of the tested surface, or of both, in the other body, meters."""
    of_a, of_b = measure_reach(pair.a, pair.b, pose, _PLACES)
    if shell == "both":
        return max(of_a, of_b)
    return of_a if (shell == "a") == (order == 0) else of_b


def _worsen(
    settings: GeometrySettings,
    pair: Pair,
    order: int,
    shell: Literal["a", "b", "both"],
    missed: list[_Missed],
    rng: np.random.Generator,
) -> tuple[float, ...]:
    """Return the deepest denied overlap, from random poses and a search for worse ones."""
    if not missed:
        return (order, 0.0, 0.0)
    # An overlap far beyond the first touch may be on a grazing approach.
    farthest = sorted(missed, key=lambda each: -each.offset)[:_LOOKED_AT]
    reaches = [
        _prove_depth(
            pair, move(each.meeting.pose, each.meeting.direction, each.offset), order, shell
        )
        for each in farthest
    ]
    random = max(reaches)
    best = random
    if settings.optimized > 0:
        for start in np.argsort(reaches)[::-1][:_STARTS].tolist():
            best = max(best, _search(settings, pair, order, shell, farthest[start], rng))
    return (order, random, best)


def _search(
    settings: GeometrySettings,
    pair: Pair,
    order: int,
    shell: Literal["a", "b", "both"],
    start: _Missed,
    rng: np.random.Generator,
) -> float:
    """Return the deepest denied overlap near a given one."""
    offset, meeting = start
    mesh_a, mesh_b = make_body(pair.a), make_body(pair.b)
    step = np.array([0.02, 0.02, 0.02, 0.5 * offset, 0.5 * offset, 0.5 * offset])

    def judge(change: NDArray[np.float64]) -> float:
        pose = meeting.pose.copy()
        pose[:3, :3] = _turn(change[:3]) @ pose[:3, :3]
        pose[:3, 3] += change[3:]
        touch = find_first_touch(mesh_a, mesh_b, pose, meeting.direction)
        if not np.isfinite(touch):
            return 0.0
        pose = move(pose, meeting.direction, touch)
        deepest = _find_last_no(pair, pose, meeting.direction, order, offset)
        if deepest == 0.0:
            return 0.0
        return _prove_depth(pair, move(pose, meeting.direction, deepest), order, shell)

    return -_minimize(lambda change: -judge(change), step, settings.optimized, rng)


def _turn(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    angle = float(np.linalg.norm(angles))
    return turn_about_axis(angles / angle, angle) if angle > 0.0 else np.eye(3)


def _find_last_no(
    pair: Pair,
    touching: NDArray[np.float64],
    direction: NDArray[np.float64],
    order: int,
    scale: float,
) -> float:
    """Return the depth of the first yes, meters, searched up to four times ``scale``."""
    low, high = 0.0, 0.0
    for high in np.linspace(0.0, 4.0 * scale, 25)[1:]:
        if pair.ask(collide, move(touching, direction, float(high)), order):
            break
        low = float(high)
    for _ in range(12):
        middle = 0.5 * (low + high)
        if pair.ask(collide, move(touching, direction, middle), order):
            high = middle
        else:
            low = middle
    return low


def _minimize(
    judge: Callable[[NDArray[np.float64]], float],
    step: NDArray[np.float64],
    evaluations: int,
    rng: np.random.Generator,
) -> float:
    """Return the minimum that Nelder-Mead finds from the origin within some evaluations."""
    size = len(step)
    places = np.concatenate([np.zeros((1, size)), np.diag(step * rng.choice((-1.0, 1.0), size))])
    values = np.array([judge(place) for place in places[: evaluations + 1]])
    if len(values) < len(places):
        return float(values.min())
    used = len(values)
    while used < evaluations:
        order = np.argsort(values)
        places, values = places[order], values[order]
        middle = places[:-1].mean(axis=0)
        used += 1
        reflected = 2.0 * middle - places[-1]
        value = judge(reflected)
        if value < values[0]:
            used += 1
            expanded = 3.0 * middle - 2.0 * places[-1]
            further = judge(expanded)
            places[-1], values[-1] = (expanded, further) if further < value else (reflected, value)
        elif value < values[-2]:
            places[-1], values[-1] = reflected, value
        else:
            used += 1
            contracted = 0.5 * (middle + places[-1])
            value = judge(contracted)
            if value < values[-1]:
                places[-1], values[-1] = contracted, value
            else:
                places[1:] = 0.5 * (places[1:] + places[:1])
                values[1:] = [judge(place) for place in places[1:]]
                used += size
    return float(values.min())
