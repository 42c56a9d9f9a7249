"""Bodies of everyday scenes: a closed mesh, and the convex parts that represent it in other engines."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from voxshell.simulation.body_shapes import compute_mass_properties
from voxshell.simulation.comparison_shapes import GImpact
from voxshell_studies.scenes.bolt import make_bolt, make_nut
from voxshell_studies.scenes.everyday.scene import Form, Piece, Vector, X, Z, shift, turn
from voxshell_studies.scenes.geometry_bodies import make_body
from voxshell_studies.scenes.solids import as_mesh, import_manifold

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from voxshell.model.mass_properties import MassProperties
    from voxshell.model.meshes import Mesh

FINE = 192
"""Edges of a full turn of bodies that roll: a facet turns the normal by 1.9 degrees."""

PLANE = Form("plane", None)
"""The half-space below z = 0 of its frame."""


@cache
def box(x: float, y: float, z: float) -> Form:
    """A box with these sides about the origin, meters.

    Example:
        >>> box(0.1, 0.2, 0.3).vertices.max(axis=0)
        array([0.05, 0.1 , 0.15])
    """
    solid = import_manifold().Manifold.cube((x, y, z), True)
    return Form(f"box {x:g} {y:g} {z:g}", as_mesh(solid), (Piece("box", (x / 2, y / 2, z / 2)),))


@cache
def slab(length: float, thickness: float = 0.05) -> Form:
    """A square slab whose upper face is at z = 0."""
    return boxes(
        f"slab {length:g} {thickness:g}",
        (((0.0, 0.0, -0.5 * thickness), (length, length, thickness)),),
    )


@cache
def boxes(name: str, parts: tuple[tuple[Vector, Vector], ...]) -> Form:
    """The union of boxes.

    Args:
        name: Unique.
        parts: Middle and sides of each, meters.
    """
    solids = import_manifold()
    all_of_them = [solids.Manifold.cube(sides, True).translate(at) for at, sides in parts]
    pieces = tuple(
        Piece("box", (sides[0] / 2, sides[1] / 2, sides[2] / 2), shift(*at)) for at, sides in parts
    )
    solid = solids.Manifold.batch_boolean(all_of_them, solids.OpType.Add)
    return Form(name, as_mesh(solid), pieces)


@cache
def ball(radius: float) -> Form:
    """A ball; the mesh's vertices are on the sphere."""
    solid = import_manifold().Manifold.sphere(radius, FINE)
    return Form(f"ball {radius:g}", as_mesh(solid), (Piece("sphere", (radius,)),))


@cache
def spheroid(radius: float, half_height: float) -> Form:
    """An ellipsoid of revolution about z."""
    scale = (radius, radius, half_height)
    mesh = as_mesh(import_manifold().Manifold.sphere(1.0, FINE).scale(scale))
    return Form(f"spheroid {radius:g} {half_height:g}", mesh, (Piece("ellipsoid", scale),))


@cache
def cylinder(radius: float, length: float, segments: int = 64) -> Form:
    """A cylinder about z, its middle at the origin."""
    solid = import_manifold().Manifold.cylinder(length, radius, radius, segments, True)
    name = f"cylinder {radius:g} {length:g} {segments}"
    return Form(name, as_mesh(solid), (Piece("cylinder", (radius, length)),))


@cache
def torus(major: float, minor: float, parts: int = 24, segments: int = 96) -> Form:
    """A torus about z; elsewhere a ring of capsules."""
    solids = import_manifold()
    circle = solids.CrossSection.circle(minor, segments // 2).translate((major, 0.0))
    mesh = as_mesh(solids.Manifold.revolve(circle, segments))
    return Form(f"torus {major:g} {minor:g} {segments}", mesh, _ring(major, minor, parts))


@cache
def tube(outer: float, inner: float, height: float, segments: int = 96) -> Form:
    """A ring with a rectangular section about z; elsewhere a ring of staves."""
    solids = import_manifold()
    outside = solids.Manifold.cylinder(height, outer, outer, segments, True)
    whole = outside - solids.Manifold.cylinder(2.0 * height, inner, inner, segments, True)
    name = f"tube {outer:g} {inner:g} {height:g} {segments}"
    return Form(name, as_mesh(whole), _staves(outer, inner, height, segments))


@cache
def named(name: str) -> Form:
    """A body of the study of geometry; elsewhere its convex hull."""
    mesh = make_body(name)
    return Form(name, mesh, (hull_of(mesh),))


@cache
def solid(name: str, points: tuple[Vector, ...]) -> Form:
    """The convex hull of points, meters, body frame."""
    body = import_manifold().Manifold.hull_points(np.array(points))
    mesh = as_mesh(body)
    return Form(name, mesh, (hull_of(mesh),))


def hull_of(mesh: Mesh) -> Piece:
    """The convex hull's vertices as a part."""
    return Piece("hull", points=hull_mesh(mesh).vertices)


def hull_mesh(mesh: Mesh) -> Mesh:
    """The convex hull of a mesh."""
    return as_mesh(import_manifold().Manifold.hull_points(np.array(mesh.vertices)))


@cache
def mug() -> Form:
    """The study of geometry's mug; elsewhere 24 staves, a floor and a handle of capsules."""
    floor = Piece("cylinder", (0.04, 0.005), shift(0.0, 0.0, -0.0475))
    handle = tuple(
        Piece(piece.kind, piece.size, shift(0.042, 0.0, 0.0) @ turn(X, 0.5 * np.pi) @ piece.pose)
        for piece in _ring(0.028, 0.005, 16)
        # Only what is outside the wall.
        if piece.pose[0, 3] > -0.002
    )
    staves = _staves(0.04, 0.036, 0.1, 24)
    return Form("mug", make_body("mug"), (floor, *staves, *handle))


@cache
def hook() -> Form:
    """Three quarters of a ring in the plane x z, open to the right above, on a shaft that goes up.

    The ring's circle has a radius of 30 mm about the origin, and the wire one of 5 mm.
    """
    solids = import_manifold()
    circle = solids.CrossSection.circle(0.005, 48).translate((0.03, 0.0))
    ring = solids.Manifold.revolve(circle, 96).rotate((90.0, 0.0, 0.0))
    ring = ring - solids.Manifold.cube((0.1, 0.1, 0.1)).translate((0.0, -0.05, 0.0))
    shaft = solids.Manifold.cylinder(0.06, 0.005, 0.005, 48).translate((0.0, 0.0, 0.03))
    pieces = [
        Piece(piece.kind, piece.size, turn(X, 0.5 * np.pi) @ piece.pose)
        for piece in _ring(0.03, 0.005, 24)
    ]
    pieces = [each for each in pieces if not (each.pose[0, 3] > 0.0 and each.pose[2, 3] > 0.0)]
    pieces.append(Piece("capsule", (0.005, 0.06), shift(0.0, 0.0, 0.06)))
    return Form("hook", as_mesh(ring + shaft), tuple(pieces))


@cache
def bowl(radius: float = 0.2) -> Form:
    """Half a hollow ball, open above, with a wall of a tenth of its inner radius."""
    solids = import_manifold()
    solid_ball = solids.Manifold.sphere(1.1 * radius, FINE) - solids.Manifold.sphere(radius, FINE)
    lid = solids.Manifold.cube((3 * radius, 3 * radius, 3 * radius), True)
    return Form(f"bowl {radius:g}", as_mesh(solid_ball - lid.translate((0.0, 0.0, 1.5 * radius))))


@cache
def nut_and_bolt() -> tuple[Form, Form]:
    """A bolt with a thread of 10 mm radius and a pitch of 6 mm, and a nut with 0.4 mm of play."""
    thread = (0.010, 0.0015, 0.006)
    bolt = make_bolt(*thread, 0.048, 0.006, 64, 64)
    nut = make_nut(*thread, 0.009, 0.0004, 64, 64)
    return Form("bolt", as_mesh(bolt)), Form("nut", as_mesh(nut))


@cache
def galton(rows: int, pitch: float, peg: float, depth: float) -> Form:
    """Pegs along y between two panes, with a funnel above; open below.

    Args:
        rows: Of pegs, the first one at z = 0 and each next one ``pitch`` times 0.9 lower.
        pitch: Between pegs of a row, meters.
        peg: Radius of a peg, meters.
        depth: Between the panes, meters.
    """
    width = pitch * (rows + 5)
    drop = 0.9 * pitch * rows
    height = drop + 0.32
    middle = -0.5 * drop + 0.14
    parts: list[tuple[Any, Piece]] = []
    for side in (-1.0, 1.0):
        parts.append(_block((0.0, side * (0.5 * depth + 0.005), middle), (width, 0.01, height)))
        parts.append(
            _block((side * 0.5 * width, 0.0, middle), (0.01, depth + 0.02, height)),
        )
    for row in range(rows):
        for place in range(row + 5):
            x = (place - 0.5 * (row + 4)) * pitch
            if abs(x) < 0.5 * width - peg:
                pose = shift(x, 0.0, -0.9 * pitch * row) @ turn(X, 0.5 * np.pi)
                rod = import_manifold().Manifold.cylinder(depth + 0.01, peg, peg, 32, True)
                piece = Piece("cylinder", (peg, depth + 0.01), pose)
                parts.append((rod.transform(pose[:3].tolist()), piece))
    solids = import_manifold()
    whole = solids.Manifold.batch_boolean([solid for solid, _ in parts], solids.OpType.Add)
    name = f"galton {rows} {pitch:g} {peg:g} {depth:g}"
    return Form(name, as_mesh(whole), tuple(piece for _, piece in parts))


@cache
def dented_ball(radius: float) -> Form:
    """A ball with three dents; elsewhere its hull."""
    solids = import_manifold()
    dents = [
        solids.Manifold.sphere(0.5 * radius, 48).translate(tuple((1.25 * radius * d).tolist()))
        for d in (np.eye(3)[0], np.eye(3)[1], -np.eye(3).sum(axis=0) / np.sqrt(3.0))
    ]
    mesh = as_mesh(
        solids.Manifold.sphere(radius, 64) - solids.Manifold.batch_boolean(dents, solids.OpType.Add)
    )
    return Form(f"dented ball {radius:g}", mesh, (hull_of(mesh),))


@cache
def spinning_top() -> Form:
    """A disk of 50 mm radius, 20 mm thick, 40 mm over a tip of 3 mm radius; the tip's center is the origin."""
    solids = import_manifold()
    disk = solids.Manifold.cylinder(0.02, 0.05, 0.05, 96, True).translate((0.0, 0.0, 0.04))
    stem = solids.Manifold.cylinder(0.04, 0.003, 0.003, 48)
    tip = solids.Manifold.sphere(0.003, 48)
    pieces = (
        Piece("cylinder", (0.05, 0.02), shift(0.0, 0.0, 0.04)),
        Piece("capsule", (0.003, 0.04), shift(0.0, 0.0, 0.02)),
    )
    return Form(
        "top", as_mesh(solids.Manifold.batch_boolean([disk, stem, tip], solids.OpType.Add)), pieces
    )


def _block(at: Vector, sides: Vector) -> tuple[Any, Piece]:
    solid_box = import_manifold().Manifold.cube(sides, True).translate(at)
    return solid_box, Piece("box", (sides[0] / 2, sides[1] / 2, sides[2] / 2), shift(*at))


def _ring(major: float, minor: float, parts: int) -> tuple[Piece, ...]:
    """Capsules along the chords of a circle about z."""
    length = 2.0 * major * float(np.sin(np.pi / parts))
    reach = major * float(np.cos(np.pi / parts))
    return tuple(
        Piece(
            "capsule",
            (minor, length),
            turn(Z, 2.0 * np.pi * (i + 0.5) / parts)
            @ shift(reach, 0.0, 0.0)
            @ turn(X, 0.5 * np.pi),
        )
        for i in range(parts)
    )


def _staves(outer: float, inner: float, height: float, parts: int) -> tuple[Piece, ...]:
    """Hulls of the sectors of a tube about z."""
    pieces = []
    for i in range(parts):
        angles = 2.0 * np.pi * np.array([i, i + 1]) / parts
        points = [
            (radius * np.cos(angle), radius * np.sin(angle), z)
            for radius in (inner, outer)
            for angle in angles
            for z in (-0.5 * height, 0.5 * height)
        ]
        pieces.append(Piece("hull", points=np.array(points)))
    return tuple(pieces)


# ---- standing ------------------------------------------------------------------------------------


@cache
def standing(form: Form) -> NDArray[np.float64]:
    """The pose over z = 0 in which the body touches it as it was modeled, (4, 4)."""
    return shift(0.0, 0.0, -float(form.vertices[:, 2].min()))


@cache
def settled(form: Form) -> NDArray[np.float64]:
    """The pose in which a body stands most stably on z = 0, its solid's center of mass over the origin.

    Of the faces of its convex hull, it stands on the one whose edges are farthest from below the center
    of mass, beside the height of that.
    """
    assert form.mesh is not None
    center = center_of(form)
    hull = hull_mesh(form.mesh)
    best, pose = -np.inf, np.eye(4)
    corners = hull.vertices[hull.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sizes = np.linalg.norm(normals, axis=1)
    normals /= np.maximum(sizes, 1e-300)[:, None]
    for normal, first in zip(normals[sizes > 0.0], corners[sizes > 0.0, 0], strict=True):
        on_it = np.abs((hull.vertices - first) @ normal) < 1e-7
        side = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
        side /= np.linalg.norm(side)
        rotation = np.stack([side, np.cross(-normal, side), -normal])
        margin = _margin(hull.vertices[on_it] @ rotation.T, rotation @ center)
        height = float(rotation[2] @ center - (hull.vertices @ rotation[2]).min())
        if margin / height > best:
            best = margin / height
            pose = np.eye(4)
            pose[:3, :3] = rotation
            pose[:3, 3] = -(rotation @ center)
            pose[2, 3] = -(hull.vertices @ rotation[2]).min()
    return pose


def _margin(points: NDArray[np.float64], center: NDArray[np.float64]) -> float:
    """How far inside the polygon of points, seen along z, the center is; negative outside."""
    middle = points[:, :2].mean(axis=0)
    order = np.argsort(np.arctan2(*(points[:, :2] - middle).T[::-1]))
    ring = points[order, :2]
    edges = np.roll(ring, -1, axis=0) - ring
    lengths = np.maximum(np.linalg.norm(edges, axis=1), 1e-300)
    to_center = center[:2] - ring
    return float(((edges[:, 0] * to_center[:, 1] - edges[:, 1] * to_center[:, 0]) / lengths).min())


@cache
def center_of(form: Form) -> NDArray[np.float64]:
    """Of mass of the uniform solid, (3,), meters, body frame.

    Example:
        >>> round(float(center_of(slab(1.0, 0.1))[2]), 6)
        -0.05
    """
    return matter(form, 1.0).center_of_mass


def matter(form: Form, mass: float) -> MassProperties:
    """Of the uniform solid that the form's mesh encloses, body frame."""
    assert form.mesh is not None
    return compute_mass_properties(GImpact(form.mesh), mass, "solid")


def spheroid_points(half_axes: tuple[float, ...]) -> NDArray[np.float64]:
    """Of an ellipsoid, for engines without one: 1,986 points of its surface, (n, 3), meters."""
    sphere = import_manifold().Manifold.sphere(1.0, 64)
    return as_mesh(sphere).vertices * half_axes
