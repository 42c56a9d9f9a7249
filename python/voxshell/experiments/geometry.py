"""How right the geometry of contacts is at default settings, against the meshes themselves.

Each scene of :mod:`voxshell.scenes.geometry` brings one body nearer to another along a direction. The
first touch of the meshes is known exactly (:mod:`voxshell.experiments.first_touch`), and with it yes,
no and depth of every pose on the way. Normals and places are judged by the nearest faces
(:mod:`voxshell.experiments.surface_truth`).
"""

from __future__ import annotations

import re
import time
import warnings
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from voxshell._arguments import as_integer
from voxshell.contact_bounds import contact_bounds
from voxshell.errors import SettingsError
from voxshell.experiments.first_touch import find_first_touch
from voxshell.experiments.part import Part
from voxshell.experiments.surface_truth import Surface, measure_angle
from voxshell.model import Model
from voxshell.queries import collide, contacts, distance
from voxshell.scenes.geometry import (
    BUILT,
    COINCIDENT,
    PAIRS,
    SCENES,
    GeometryScene,
    random_rotation,
)
from voxshell.scenes.geometry_bodies import BODIES, make_body, retriangulate, turn_mesh
from voxshell.scenes.solids import as_mesh, import_manifold

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from voxshell.contact_set import Contacts
    from voxshell.experiments.part import Tables
    from voxshell.meshes import Mesh

RETRIANGULATED = -1
"""The copy with other triangles; 0 is the scene itself, 1 and above are rotated copies."""

ORDERS = (0, 1)
"""Of arguments: a before b, and b before a."""

_NEAREST_STEP = 1e-6
"""Metres from the first touch to the nearest offset at which ``collide`` is asked."""

_SCANNED = 48
"""Offsets on each side of the first touch at which it is asked."""

_OFFSETS = 5
"""Poses of a pair on each of its approaches."""

_FACES = 3
"""Largest faces of an overlap along whose normals a shorter way out is looked for."""

_LOOKED_AT = 5
"""Denied overlaps, of which the one that reaches deepest is made worse."""

_PLACES = 100
"""Of the surface of an overlap that are looked at."""

_EXACT = 1e-7
"""Metres to which the first yes is bracketed."""


@dataclass(frozen=True)
class GeometrySettings:
    """Settings of the study.

    Attributes:
        scenes: Names of scenes; empty for all.
        poses: Of each scene.
        rotations: Copies of each scene whose meshes are rotated before they are built.
        retriangulated: Copies with other triangles on the same surfaces: 1 or 0.
        copied_poses: Of each copy.
        judged: Contacts of a query whose normals and places are judged, at most.
        pairs: How many pairs of mixed size, in any pose, the first of the list.
        pair_poses: Of all pairs together.
        optimized: Poses that are tried to make the worst one of a pair worse.
        builds: How many bodies' builds are timed, the first of the list.
        seed: Of poses and rotations.
    """

    scenes: tuple[str, ...] = ()
    poses: int = 6
    rotations: int = 10
    retriangulated: int = 1
    copied_poses: int = 2
    judged: int = 24
    pairs: int = len(PAIRS)
    pair_poses: int = 10_000
    optimized: int = 60
    builds: int = len(BUILT)
    seed: int = 18

    def __post_init__(self) -> None:
        for name, least, most in (
            ("poses", 1, 1_000_000),
            ("rotations", 0, 1_000),
            ("retriangulated", 0, 1),
            ("copied_poses", 1, 1_000_000),
            ("judged", 1, 1_000_000),
            ("pairs", 0, len(PAIRS)),
            ("pair_poses", 1, 100_000_000),
            ("optimized", 0, 1_000_000),
            ("builds", 0, len(BUILT)),
            ("seed", 0, 2**31 - 1),
        ):
            as_integer(getattr(self, name), name, least, most)
        for name in self.scenes:
            if name not in SCENES:
                raise SettingsError(f"scenes: unknown scene {name!r}")

    @property
    def chosen(self) -> tuple[str, ...]:
        """Names of the scenes that are run."""
        return self.scenes or tuple(SCENES)


def plan(settings: GeometrySettings) -> list[Part]:
    """One part a scene, one a pair, one for bodies in one pose, and one for builds, which are timed."""
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
    parts.append(Part("coincident", measure_coincident, {"settings": settings}, cost=2.0))
    parts.append(
        Part("builds", time_builds, {"settings": settings}, timed=True, cost=0.5 * settings.builds)
    )
    return parts


def name_scene(name: str) -> str:
    """The name of a scene's part.

    Example:
        >>> name_scene("ball on slab 0.3 m")
        'scene-ball-on-slab-0-3-m'
    """
    return "scene-" + re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")


def name_pair(index: int) -> str:
    """The name of a pair's part."""
    return f"pair-{index + 1}"


# ---- bodies and poses ----------------------------------------------------------------------------


class _Copy(NamedTuple):
    """A body as one copy of a scene has it: its model, and how its mesh is rotated."""

    model: Model
    rotation: NDArray[np.float64]


@cache
def build_copy(body: str, copy: int) -> _Copy:
    """The default model of a body, as it is, with other triangles, or rotated by chance.

    Args:
        body: A key of ``BODIES``.
        copy: 0, :data:`RETRIANGULATED`, or the number of a rotated copy.
    """
    mesh, rotation = make_body(body), np.eye(3)
    if copy == RETRIANGULATED:
        mesh = retriangulate(mesh)
    elif copy > 0:
        rotation = random_rotation(np.random.default_rng((copy, list(BODIES).index(body))))
        mesh = turn_mesh(mesh, rotation)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return _Copy(Model.from_mesh(mesh), rotation)


@cache
def find_surface(body: str) -> Surface:
    """The faces of a body."""
    return Surface(make_body(body))


class Pair:
    """Two bodies' models, which are asked in either order, in poses of the bodies' own frames."""

    def __init__(self, a: str, b: str, copy: int = 0) -> None:
        self.a, self.b = a, b
        self._models = build_copy(a, copy), build_copy(b, copy)

    def ask(
        self,
        query: Callable[..., Any],
        b_from_a: NDArray[np.float64],
        order: int,
        **options: object,
    ) -> Any:
        """The answer of a query, b at the origin; order 1 gives b first."""
        pair = []
        for (model, rotation), pose in zip(self._models, (b_from_a, np.eye(4)), strict=True):
            turned = pose.copy()
            turned[:3, :3] = pose[:3, :3] @ rotation.T
            pair.append((model, turned))
        if order == 1:
            pair.reverse()
        (first, first_pose), (second, second_pose) = pair
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return query(first, second, first_pose, second_pose, **options)

    def find_voxel_size(self, of_a: bool) -> float:
        """Of a's field or b's, metres."""
        return self._models[0 if of_a else 1].model.field.voxel_size

    def find_bounds(self, shell: str, order: int) -> tuple[float, float]:
        """Overlap and clearance that the library states for a shell's contacts, metres."""
        a, b = (each.model for each in self._models)
        if order == 1:
            a, b = b, a
        found = [contact_bounds(*pair) for pair in ((a, b), (b, a))]
        if shell == "both":
            overlap = min(each.overlap for each in found)
            return overlap, max(each.clearance for each in found)
        chosen = found[0 if shell == "a" else 1]
        return chosen.overlap, chosen.clearance


def move(
    pose: NDArray[np.float64], direction: NDArray[np.float64], by: float
) -> NDArray[np.float64]:
    """The pose moved along a direction, metres."""
    moved = pose.copy()
    moved[:3, 3] += by * direction
    return moved


@cache
def _as_solid(body: str) -> Any:
    solids = import_manifold()
    mesh = make_body(body)
    return solids.Manifold(
        solids.Mesh64(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.uint64))
    )


def overlap(a: str, b: str, b_from_a: NDArray[np.float64]) -> Any:
    """What two bodies have in common, exactly, as a ``manifold3d.Manifold`` in b's frame."""
    return _as_solid(a).transform(b_from_a[:3]) ^ _as_solid(b)


# ---- scenes --------------------------------------------------------------------------------------


def measure_scene(settings: GeometrySettings, name: str) -> Tables:
    """Measures a scene in all its poses and copies, in both orders of the bodies.

    Args:
        settings: Of the study.
        name: Of the scene.

    Returns:
        "approaches", a row a pose, copy and order: "onset", how far beyond the true first touch, along the
        approach, ``collide`` first says yes (infinite: never), and "unseen", how far beyond it the last
        overlap is to which it says no, metres; "slope", by which both become lengths of the shortest
        separating translation, as an approach may graze. "depths", a row a depth along the approach as well: the
        true depth ("way_out", the shortest separating translation), whether ``collide`` says yes so deep
        and so far apart (-1: not asked), how many contacts there are, the deepest of them, and what
        ``distance`` says so deep and so far apart, metres. "contacts", a row for each that is
        judged: the angle of its normal, radians, and how far its places are off their bodies, metres.
    """
    scene = SCENES[name]
    touches = [_touch(scene, index) for index in range(settings.poses)]
    tables: dict[str, list[tuple[float, ...]]] = {"approaches": [], "depths": [], "contacts": []}
    ways = [
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
                for depth, way in zip(scene.looked_at, ways[index], strict=True):
                    row, judged = _look(settings, scene, pair, pose, touch, depth, order)
                    tables["depths"].append((*key, depth, way, *row))
                    tables["contacts"] += [(*key, depth, *each) for each in judged]
    key = ("copy", "pose", "order")
    names = {
        "approaches": (*key, "touch", "slope", "onset", "unseen"),
        "depths": (
            *key,
            "depth",
            "way_out",
            "yes",
            "apart_yes",
            "count",
            "deepest",
            "distance",
            "gap",
        ),
        "contacts": (*key, "depth", "angle", "a_off", "b_off", "voxel"),
    }
    return {table: as_columns(names[table], rows) for table, rows in tables.items()}


def as_columns(names: tuple[str, ...], rows: list[tuple[float, ...]]) -> dict[str, Any]:
    """Rows of numbers as columns."""
    values = np.array(rows, dtype=np.float64).reshape(-1, len(names))
    return dict(zip(names, values.T.copy(), strict=True))


def _touch(scene: GeometryScene, index: int) -> float:
    return find_first_touch(
        make_body(scene.a),
        make_body(scene.b),
        scene.place(index),
        scene.direction,
        from_here=scene.start == "here",
    )


def _measure_depth(scene: GeometryScene, index: int, touch: float, depth: float) -> float:
    """The shortest separating translation of bodies at rest, and the way back of others, metres.

    NaN where the bodies never touch.
    """
    if not np.isfinite(touch):
        return np.nan
    return depth if scene.group != "rest" else _find_way_out(scene, index, touch, depth)


def _measure_slope(scene: GeometryScene, index: int, touch: float) -> float:
    """The shortest separating translation over the way along the approach, just beyond the touch."""
    if not np.isfinite(touch):
        return np.nan
    depth = min(0.25 * scene.onset_bar, 0.1 * scene.reach)
    return _find_way_out(scene, index, touch, depth) / depth


def _find_way_out(scene: GeometryScene, index: int, touch: float, depth: float) -> float:
    """The length of the shortest separating translation that is found, metres: at least the shortest.

    Tried are the way back, and the normals of the largest faces of what the bodies have in common, which
    are faces of theirs.
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
    shares = np.bincount(which.ravel(), sizes[sound])
    lengths = [depth]
    for normal in normals[np.argsort(-shares, kind="stable")[:_FACES]]:
        into = normal / np.linalg.norm(normal)
        into *= 1.0 if into @ scene.direction > 0.0 else -1.0
        # Moved out and come back along the normal, the bodies touch before they are in this pose.
        lengths.append(-find_first_touch(make_body(scene.a), make_body(scene.b), pose, into))
    return min(length for length in lengths if np.isfinite(length) and length >= 0.0)


def _approach(
    scene: GeometryScene, pair: Pair, pose: NDArray[np.float64], touch: float, order: int
) -> tuple[float, float]:
    """The offset of the first yes on the way, and of the last no, from the first touch, metres."""

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
        # Far beyond the first touch a body may have come out on the other side.
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
    """What the queries say at a depth, and so far apart; and the contacts that are judged."""
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
    return row, _judge(settings, pair, inside, found, order)


def _judge(
    settings: GeometrySettings,
    pair: Pair,
    b_from_a: NDArray[np.float64],
    found: Contacts,
    order: int,
) -> list[tuple[float, ...]]:
    """Of some contacts, the deepest among them: the angle of the normal, and how far off places are."""
    if len(found) == 0:
        return []
    chosen = np.unique(np.linspace(0, len(found) - 1, settings.judged).astype(int))
    chosen = np.union1d(chosen, [int(np.argmax(found.depths))])
    a_from_b = _invert(b_from_a)
    # The first and the second body of the query, with the poses of both in the world, which is b's frame.
    bodies = [
        (find_surface(pair.a), b_from_a, a_from_b),
        (find_surface(pair.b), np.eye(4), np.eye(4)),
    ]
    if order == 1:
        bodies.reverse()
    places = found.points_a, found.points_b
    rows = []
    for index in chosen:
        off = [
            surface.measure_distance(_carry(local, places[side][index]))
            for side, (surface, _, local) in enumerate(bodies)
        ]
        of_a = found.shells[index] == "a"
        shell, field = (bodies[0], bodies[1]) if of_a else (bodies[1], bodies[0])
        place = places[0 if of_a else 1][index]
        # Outwards of the body whose surface was come through.
        normal = found.normals[index] * (1.0 if of_a else -1.0)
        angle = _find_angle(shell, field, place, normal)
        rows.append((angle, *off, pair.find_voxel_size(of_a == (order == 1))))
    return rows


_Placed = tuple[Surface, "NDArray[np.float64]", "NDArray[np.float64]"]


def _find_angle(
    shell: _Placed, field: _Placed, place: NDArray[np.float64], normal: NDArray[np.float64]
) -> float:
    """Radians between a normal and what the nearest surface, or the one come through, allows."""
    surface, _, local = field
    inside = _carry(local, place)
    outward = local[:3, :3] @ normal
    _, cones = surface.find_nearest(inside)
    angle = min(measure_angle(outward, cone) for cone in cones)
    if angle < np.radians(2.0):
        return angle
    own, own_pose, own_local = shell
    for own_cone in own.find_nearest(_carry(own_local, place))[1]:
        for own_normal in np.unique(own_cone.round(6), axis=0):
            backward = -(local[:3, :3] @ own_pose[:3, :3] @ own_normal)
            entry = surface.find_entry(inside, backward / np.linalg.norm(backward))
            if entry is not None:
                angle = min(angle, measure_angle(outward, entry[None]))
    return angle


def _invert(pose: NDArray[np.float64]) -> NDArray[np.float64]:
    inverse = np.eye(4)
    inverse[:3, :3] = pose[:3, :3].T
    inverse[:3, 3] = -pose[:3, :3].T @ pose[:3, 3]
    return inverse


def _carry(pose: NDArray[np.float64], place: NDArray[np.float64]) -> NDArray[np.float64]:
    return pose[:3, :3] @ place + pose[:3, 3]


# ---- bodies in the very same pose ----------------------------------------------------------------


def measure_coincident(settings: GeometrySettings) -> Tables:
    """Asks about bodies in one pose with their copies.

    Returns:
        "bodies", a row a body of ``COINCIDENT``: whether ``collide`` says yes, how many contacts there
        are, how deep the deepest is, and what ``distance`` says, metres.
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


# ---- pairs of mixed size in any pose -------------------------------------------------------------


class _Meeting(NamedTuple):
    """A pose at first touch, and the direction of the approach."""

    pose: NDArray[np.float64]
    direction: NDArray[np.float64]


class _Missed(NamedTuple):
    """An overlap that was denied, and how far it is beyond the first touch, metres."""

    offset: float
    meeting: _Meeting


def measure_pair(settings: GeometrySettings, index: int) -> Tables:
    """Asks a pair in many poses, overlapping and apart near the first touch, and looks for the worst.

    Returns:
        "poses", a row a pose and order: "offset" beyond the first touch along a random direction, whether
        the meshes overlap and whether ``collide`` says "yes", the stated bounds of what it must see ("overlap") and of what it must
        deny ("clearance"), and how deep or how far apart the bodies are where the answer is wrong beyond
        the bounds along the direction ("proven", 0 elsewhere), metres. "worst", a row an order: the
        how deep the shell's surface reaches into the other body in the worst overlap that was denied, by
        chance and after the search, metres.
    """
    a, b = PAIRS[index]
    rng = np.random.default_rng((settings.seed, index))
    pair = Pair(a, b)
    mesh_a, mesh_b = make_body(a), make_body(b)
    size = min(float(np.ptp(mesh.vertices, axis=0).max()) for mesh in (mesh_a, mesh_b))
    count = max(1, settings.pair_poses // max(settings.pairs, 1) // _OFFSETS)
    rows: list[tuple[float, ...]] = []
    missed: tuple[list[_Missed], ...] = ([], [])
    for _ in range(count):
        meeting = _meet(mesh_a, mesh_b, rng)
        if meeting is None:
            continue
        depths = 10.0 ** rng.uniform(-5.0, np.log10(0.15 * size), _OFFSETS)
        signs = np.where(rng.random(_OFFSETS) < 0.6, 1.0, -1.0)
        for offset in (depths * signs).tolist():
            pose = move(meeting.pose, meeting.direction, offset)
            said = [pair.ask(collide, pose, order) for order in ORDERS]
            # Where one body has passed through a thin one, no is right again.
            overlaps = offset > 0.0 and (all(said) or not overlap(a, b, pose).is_empty())
            for order in ORDERS:
                shell = pair.ask(contacts, pose, order, max_points=1).shell
                most, clearance = pair.find_bounds(shell, order)
                proven = 0.0
                if overlaps and not said[order]:
                    missed[order].append(_Missed(offset, meeting))
                    if offset > most:
                        proven = _prove_depth(pair, pose, order)
                elif -offset > clearance and said[order]:
                    proven = _measure_gap(a, b, pose, -offset)
                rows.append(
                    (offset, order, float(overlaps), float(said[order]), most, clearance, proven)
                )
    names = ("offset", "order", "overlaps", "yes", "overlap", "clearance", "proven")
    return {
        "poses": as_columns(names, rows),
        "worst": as_columns(
            ("order", "random", "optimized"),
            [_worsen(settings, pair, order, missed[order], rng) for order in ORDERS],
        ),
    }


def _meet(a: Mesh, b: Mesh, rng: np.random.Generator) -> _Meeting | None:
    """A pose of first touch: a random orientation, and a random place of each that would meet."""
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    pose = np.eye(4)
    pose[:3, :3] = random_rotation(rng)
    place_a = pose[:3, :3] @ _pick(a, rng)
    pose[:3, 3] = _pick(b, rng) - place_a
    touch = find_first_touch(a, b, pose, direction)
    return _Meeting(move(pose, direction, touch), direction) if np.isfinite(touch) else None


def _pick(mesh: Mesh, rng: np.random.Generator) -> NDArray[np.float64]:
    """A random place on a random face, (3,)."""
    shares = rng.dirichlet(np.ones(3))
    return shares @ mesh.vertices[mesh.faces[rng.integers(len(mesh.faces))]]


def _prove_depth(pair: Pair, pose: NDArray[np.float64], order: int) -> float:
    """How deep the surface of the shell, or of both, certainly reaches into the other body, metres."""
    common = overlap(pair.a, pair.b, pose)
    if common.is_empty():
        return 0.0
    shell = pair.ask(contacts, pose, order, max_points=1).shell
    mesh = as_mesh(common)
    places = np.concatenate([mesh.vertices, mesh.vertices[mesh.faces].mean(axis=1)])
    places = places[:: max(1, len(places) // _PLACES)]
    # On the surface of what they have in common and deep in one body: on the other one's surface.
    a_is_shell = (shell == "a") == (order == 0)
    depths = []
    if shell == "both" or a_is_shell:
        surface = find_surface(pair.b)
        depths += [surface.measure_distance(place) for place in places]
    if shell == "both" or not a_is_shell:
        surface, a_from_b = find_surface(pair.a), _invert(pose)
        depths += [surface.measure_distance(_carry(a_from_b, place)) for place in places]
    return max(depths)


def _measure_gap(a: str, b: str, pose: NDArray[np.float64], most: float) -> float:
    """How far two bodies are apart, metres, at most so much."""
    return float(_as_solid(a).transform(pose[:3]).min_gap(_as_solid(b), 1.01 * most))


def _worsen(
    settings: GeometrySettings,
    pair: Pair,
    order: int,
    missed: list[_Missed],
    rng: np.random.Generator,
) -> tuple[float, ...]:
    """The deepest overlap that is denied, by chance and after a search for worse poses."""
    if not missed:
        return (order, 0.0, 0.0)
    # What is far beyond the first touch may lie on a grazing way: a few of the farthest are looked at.
    farthest = sorted(missed, key=lambda each: -each.offset)[:_LOOKED_AT]
    reaches = [
        _prove_depth(pair, move(each.meeting.pose, each.meeting.direction, each.offset), order)
        for each in farthest
    ]
    random = max(reaches)
    offset, meeting = farthest[int(np.argmax(reaches))]
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
        return _prove_depth(pair, move(pose, meeting.direction, deepest), order)

    best = random
    if settings.optimized > 0:
        best = max(best, -_minimize(lambda change: -judge(change), step, settings.optimized, rng))
    return (order, random, best)


def _turn(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    angle = float(np.linalg.norm(angles))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = angles / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * (cross @ cross)


def _find_last_no(
    pair: Pair,
    touching: NDArray[np.float64],
    direction: NDArray[np.float64],
    order: int,
    scale: float,
) -> float:
    """How deep the first yes comes after the touch, metres, found up to four times ``scale``."""
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
    """The least value that Nelder and Mead's simplex finds from the origin with so many evaluations."""
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


# ---- builds --------------------------------------------------------------------------------------


def time_builds(settings: GeometrySettings) -> Tables:
    """Builds bodies at default settings.

    Returns:
        "builds", a row a body of ``BUILT``: seconds, bytes of field and shell, points, voxel size,
        metres, and how many warnings were given.
    """
    rows = []
    for body in BUILT[: settings.builds]:
        mesh = make_body(body)
        with warnings.catch_warnings(record=True) as given:
            warnings.simplefilter("always")
            start = time.perf_counter()
            model = Model.from_mesh(mesh, cache=False)
            seconds = time.perf_counter() - start
        shell = model.shell
        shell_bytes = sum(array.nbytes for array in (shell.points, shell.normals, shell.areas))
        size = model.field.nbytes + shell_bytes
        rows.append((seconds, size, len(shell), model.field.voxel_size, len(given)))
    return {"builds": as_columns(("seconds", "bytes", "points", "voxel_size", "warnings"), rows)}
