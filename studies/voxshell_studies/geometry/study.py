"""Correctness of contact geometry at default settings, compared with the meshes themselves.

Each scene of :mod:`voxshell_studies.scenes.geometry` moves one body toward another along a
direction. The first touch of the meshes is known exactly (:mod:`voxshell_studies.geometry.first_touch`), and
therefore also contact and depth in every pose of the motion. The nearest faces are the reference
for normals and points (:mod:`voxshell_studies.geometry.surface_truth`).
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np
from voxshell.query.distances import distance
from voxshell.query.queries import collide, contacts

from voxshell_studies.geometry.contacts import JUDGED, judge_contacts, measure_contacts
from voxshell_studies.geometry.costs import compare_costs, time_builds
from voxshell_studies.geometry.first_touch import find_first_touch
from voxshell_studies.geometry.models import (
    ORDERS,
    RETRIANGULATED,
    Pair,
    build_copy,
    measure_reach,
    move,
    overlap,
)
from voxshell_studies.geometry.pairs import measure_pair
from voxshell_studies.geometry.settings import GeometrySettings
from voxshell_studies.part import Part, as_columns
from voxshell_studies.scenes.geometry import (
    COINCIDENT,
    SCENES,
    THIN,
    GeometryScene,
    random_rotation,
)
from voxshell_studies.scenes.geometry_bodies import make_body
from voxshell_studies.scenes.solids import as_mesh

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from voxshell.query.contact_set import Contacts

    from voxshell_studies.part import Tables

_NEAREST_STEP = 1e-6
"""Smallest offset from the first touch at which ``collide`` is called, meters."""

_SCANNED = 48
"""Number of offsets on each side of the first touch."""

_FACES = 3
"""Number of the largest faces of an overlap whose normals are tried as shorter separations."""

_REACH_PLACES = 300
"""Number of places on the surface of an overlap at which its depth is measured."""

_EXACT = 1e-7
"""Width of the interval to which the first yes is narrowed, meters."""


def plan(settings: GeometrySettings) -> list[Part]:
    """Return parts for scenes, pairs, thin bodies, equal poses, and two of timed costs."""
    cost = 1.0 + 0.3 * settings.poses + settings.rotations + settings.retriangulated
    parts = [
        Part(name_scene(name), measure_scene, {"settings": settings, "name": name}, cost=cost)
        for name in settings.chosen
    ]
    parts += [
        Part(
            name_pair(index),
            measure_pair,
            {"settings": settings, "index": index},
            cost=1.0 + 0.002 * settings.pair_poses / max(settings.pairs, 1),
        )
        for index in range(settings.pairs)
    ]
    if settings.judged_pairs > 0:
        parts += [
            Part(
                name_contacts(body),
                measure_contacts,
                {"settings": settings, "body": body},
                cost=5.0,
            )
            for body in THIN
        ]
    parts.append(Part("coincident", measure_coincident, {"settings": settings}, cost=2.0))
    for name, function, cost in (
        ("builds", time_builds, 1.5 * settings.builds),
        ("costs", compare_costs, 100.0 * (settings.compared_poses > 0)),
    ):
        if cost > 0.0:
            parts.append(Part(name, function, {"settings": settings}, timed=True, cost=cost))
    return parts


def name_scene(name: str) -> str:
    """Return the name of a scene's part.

    Example:
        >>> name_scene("ball on slab 0.3 m")
        'scene-ball-on-slab-0-3-m'
    """
    return "scene-" + re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")


def name_pair(index: int) -> str:
    """Return the name of a pair's part."""
    return f"pair-{index + 1}"


def name_contacts(body: str) -> str:
    """Return the name of the part that judges a thin body's contacts."""
    return "contacts-" + body.replace(" ", "-")


# ---- scenes --------------------------------------------------------------------------------------


def measure_scene(settings: GeometrySettings, name: str) -> Tables:
    """Measure a scene in all its poses and copies, in both orders of the bodies.

    Args:
        settings: Settings of the study.
        name: Name of the scene.

    Returns:
        "approaches" has a row for each pose, copy and order. "onset" is how far beyond the true
        first touch, along the approach, ``collide`` first says yes, meters (infinite: never).
        "unseen" is how far beyond it the last overlap is to which it says no, meters. "slope"
        converts both to lengths of the shortest separating translation, because approaches may
        graze. "depths" has a row for each depth along the approach: the true depth as the shortest
        separating translation ("way_out") and as the proven depth of a surface in the other body
        ("reach", which is less where edges cross); whether ``collide`` says yes at this depth and
        at this distance (-1: not queried); the number of contacts and the deepest of them; and the
        results of ``distance`` at this depth and at this distance, meters. "contacts" has a row
        for each judged contact: the error of its normal, radians, the distances of its points from
        their bodies, meters, and whether it reports an ambiguous depth.
    """
    scene = SCENES[name]
    touches = [_touch(scene, index) for index in range(settings.poses)]
    tables: dict[str, list[tuple[float, ...]]] = {"approaches": [], "depths": [], "contacts": []}
    truths = [
        [_measure_depth(scene, index, touch, depth) for depth in scene.looked_at]
        for index, touch in enumerate(touches)
    ]
    slopes = [_measure_slope(scene, index, touch) for index, touch in enumerate(touches)]
    copies = [0] + [RETRIANGULATED] * settings.retriangulated
    copies += range(1, settings.rotations + 1)
    for copy in copies:
        pair = Pair(scene.a, scene.b, copy)
        poses = settings.poses if copy == 0 else min(settings.copied_poses, settings.poses)
        for index in range(poses):
            pose, touch = scene.place(index), touches[index]
            if not np.isfinite(touch):
                continue
            for order in ORDERS:
                key = (copy, index, order)
                tables["approaches"].append(
                    (*key, touch, slopes[index], *_approach(scene, pair, pose, touch, order))
                )
                for depth, truth in zip(scene.looked_at, truths[index], strict=True):
                    row, judged = _look(settings, scene, pair, pose, touch, depth, order)
                    tables["depths"].append((*key, depth, *truth, *row))
                    tables["contacts"] += [(*key, depth, *each) for each in judged]
    key = ("copy", "pose", "order")
    names = {
        "approaches": (*key, "touch", "slope", "onset", "unseen"),
        "depths": (
            *key,
            "depth",
            "way_out",
            "reach",
            "yes",
            "apart_yes",
            "count",
            "deepest",
            "distance",
            "gap",
        ),
        "contacts": (*key, "depth", *JUDGED),
    }
    return {table: as_columns(names[table], rows) for table, rows in tables.items()}


def _touch(scene: GeometryScene, index: int) -> float:
    return find_first_touch(
        make_body(scene.a),
        make_body(scene.b),
        scene.place(index),
        scene.direction,
        from_here=scene.start == "here",
    )


def _measure_depth(
    scene: GeometryScene, index: int, touch: float, depth: float
) -> tuple[float, float]:
    """Return the shortest separating translation, and how deep a surface is, meters.

    This applies to bodies at rest; for others, both are the distance back along the motion. NaN if
    the bodies never touch.
    """
    if not np.isfinite(touch):
        return np.nan, np.nan
    if scene.group != "rest":
        return depth, depth
    pose = move(scene.place(index), scene.direction, touch + depth)
    return (
        _find_way_out(scene, index, touch, depth),
        max(measure_reach(scene.a, scene.b, pose, _REACH_PLACES)),
    )


def _measure_slope(scene: GeometryScene, index: int, touch: float) -> float:
    """Return the shortest separating translation divided by the motion, just beyond the touch."""
    if not np.isfinite(touch):
        return np.nan
    depth = min(0.25 * scene.onset_bar, 0.1 * scene.reach)
    return _find_way_out(scene, index, touch, depth) / depth


def _find_way_out(scene: GeometryScene, index: int, touch: float, depth: float) -> float:
    """Return an upper bound of the shortest separating translation, meters.

    The candidates are the way back, and the normals of the largest faces of the intersection, which
    are faces of the bodies.
    """
    pose = move(scene.place(index), scene.direction, touch + depth)
    common = overlap(scene.a, scene.b, pose)
    if common.is_empty():
        return depth
    mesh = as_mesh(common)
    corners = mesh.vertices[mesh.faces]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sizes = np.linalg.norm(areas, axis=1)
    sound = sizes > 1e-18
    normals, which = np.unique(
        (areas[sound] / sizes[sound, None]).round(6), axis=0, return_inverse=True
    )
    face_sizes = np.bincount(which.ravel(), sizes[sound])
    lengths = [depth]
    for normal in normals[np.argsort(-face_sizes, kind="stable")[:_FACES]]:
        into = normal / np.linalg.norm(normal)
        into *= 1.0 if into @ scene.direction > 0.0 else -1.0
        # When the body is moved out and back along the normal, it touches before this pose.
        lengths.append(-find_first_touch(make_body(scene.a), make_body(scene.b), pose, into))
    return min(length for length in lengths if np.isfinite(length) and length >= 0.0)


def _approach(
    scene: GeometryScene, pair: Pair, pose: NDArray[np.float64], touch: float, order: int
) -> tuple[float, float]:
    """Return the offsets of the first yes and of the last no from the first touch, meters."""

    def says(offset: float) -> bool:
        return pair.ask(collide, move(pose, scene.direction, touch + offset), order)

    far = 0.25 * scene.size
    if scene.start == "here":
        far = min(far, touch)
    before = -np.geomspace(max(far, 2.0 * _NEAREST_STEP), _NEAREST_STEP, _SCANNED)
    after = np.geomspace(_NEAREST_STEP, scene.reach, _SCANNED)
    even = np.linspace(0.0, scene.reach, _SCANNED + 1)[1:]
    offsets = np.unique(np.concatenate([before, [0.0], after, even]))
    said = np.array([says(float(offset)) for offset in offsets])
    onset, unseen = np.inf, 0.0
    if said.any():
        first = int(np.argmax(said))
        onset = float(offsets[first])
        if first > 0:
            low, high = float(offsets[first - 1]), onset
            while high - low > _EXACT:
                middle = 0.5 * (low + high)
                low, high = (low, middle) if says(middle) else (middle, high)
            onset = high
    missed = offsets[~said & (offsets > 0.0)][::-1]
    for offset in missed:
        # Far beyond the first touch, a body may have come out on the other side.
        common = overlap(scene.a, scene.b, move(pose, scene.direction, touch + float(offset)))
        if not common.is_empty():
            unseen = float(offset)
            break
    return onset, max(unseen, onset if np.isfinite(onset) else 0.0)


def _look(
    settings: GeometrySettings,
    scene: GeometryScene,
    pair: Pair,
    pose: NDArray[np.float64],
    touch: float,
    depth: float,
    order: int,
) -> tuple[tuple[float, ...], list[tuple[float, ...]]]:
    """Return the results of queries at a depth and a distance, and the judged contacts."""
    inside = move(pose, scene.direction, touch + depth)
    apart = move(pose, scene.direction, touch - depth)
    has_room = scene.start == "far" or touch > depth
    found: Contacts = pair.ask(contacts, inside, order)
    row = (
        float(pair.ask(collide, inside, order)),
        float(pair.ask(collide, apart, order)) if has_room else -1.0,
        float(len(found)),
        float(found.depths.max(initial=-np.inf)),
        pair.ask(distance, inside, order).distance,
        pair.ask(distance, apart, order).distance if has_room else np.nan,
    )
    return row, judge_contacts(pair, inside, found, order, settings.judged)


# ---- bodies in the very same pose ----------------------------------------------------------------


def measure_coincident(settings: GeometrySettings) -> Tables:
    """Query bodies that have the same pose as their copies.

    Returns:
        "bodies", a row a body of ``COINCIDENT``: whether ``collide`` says yes, how many contacts
        there are, how deep the deepest is, and what ``distance`` says, meters.
    """
    rows = []
    rng = np.random.default_rng(settings.seed)
    for body in COINCIDENT:
        pair = Pair(body, body)
        pose = np.eye(4)
        pose[:3, :3] = random_rotation(rng)
        model = build_copy(body, 0).model
        found = contacts(model, model, pose, pose)
        rows.append(
            (
                float(collide(model, model, pose, pose)),
                float(len(found)),
                float(found.depths.max(initial=-np.inf)),
                pair.ask(distance, np.eye(4), 0).distance,
            )
        )
    return {"bodies": as_columns(("yes", "count", "deepest", "distance"), rows)}
