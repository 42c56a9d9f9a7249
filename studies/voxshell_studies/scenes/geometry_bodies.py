"""Bodies of the study of geometry: closed meshes from 3 mm to 5 m, made on demand. Meters; z is up."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from voxshell.errors import MeshError, SettingsError
from voxshell.model.meshes import Mesh, read_mesh
from voxshell_studies.scenes.bolt import make_bolt
from voxshell_studies.scenes.bunny import find_bunny
from voxshell_studies.scenes.gear import make_gear
from voxshell_studies.scenes.solids import as_mesh, import_manifold

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

_ROUND = 64
"""Edges of a full turn: a circle is a polygon, and the mesh is the truth."""


@cache
def make_body(name: str) -> Mesh:
    """The mesh of a body, closed and oriented outward.

    Args:
        name: A key of :data:`BODIES`.

    Raises:
        SettingsError: There is no such body.
        MissingExtraError: manifold3d is not installed.
        MeshError: The body is the bunny, and its file is not installed.

    Example:
        >>> mesh = make_body("slab 1 m")
        >>> (mesh.vertices.max(axis=0) - mesh.vertices.min(axis=0)).round(3)
        array([1.  , 1.  , 0.05])
    """
    if name not in BODIES:
        raise SettingsError(f"unknown body {name!r}; valid bodies: {', '.join(BODIES)}")
    body = BODIES[name]()
    mesh = body if isinstance(body, Mesh) else as_mesh(body)
    for array in mesh:
        array.flags.writeable = False
    return mesh


def retriangulate(mesh: Mesh, pieces: int = 8) -> Mesh:
    """The same surface with other triangles: no edge is longer than the mesh's size over ``pieces``.

    Example:
        >>> mesh = make_body("cube 50 mm")
        >>> len(mesh.faces), len(retriangulate(mesh, 4).faces) > 100
        (12, True)
    """
    solids = import_manifold()
    solid = solids.Manifold(
        solids.Mesh64(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.uint64))
    )
    if solid.is_empty():  # open, or crosses itself
        raise MeshError("only a closed mesh that does not cross itself can be retriangulated")
    size = float(np.ptp(mesh.vertices, axis=0).max())
    return as_mesh(solid.refine_to_length(size / pieces))


def turn_mesh(mesh: Mesh, rotation: NDArray[np.float64]) -> Mesh:
    """The mesh with its vertices rotated about the origin."""
    return Mesh(mesh.vertices @ rotation.T, mesh.faces)


# ---- profiles and solids -------------------------------------------------------------------------


def _box(x: float, y: float, z: float) -> Any:
    return import_manifold().Manifold.cube((x, y, z), True)


def _slab(length: float, thickness: float = 0.05) -> Any:
    """Its upper face is at z = 0."""
    return _box(length, length, thickness).translate((0.0, 0.0, -0.5 * thickness))


def _cylinder(height: float, low: float, high: float = -1.0, segments: int = _ROUND) -> Any:
    """About z, its middle at the origin."""
    return import_manifold().Manifold.cylinder(height, low, high, segments, True)


def _ball(radius: float, scale: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> Any:
    return import_manifold().Manifold.sphere(radius, _ROUND).scale(scale)


def _extrude(points: list[tuple[float, float]], height: float) -> Any:
    """A polygon in x and y, counter-clockwise, extruded along z about z = 0."""
    solids = import_manifold()
    section = solids.CrossSection([np.array(points)])
    return solids.Manifold.extrude(section, height).translate((0.0, 0.0, -0.5 * height))


def _hull(points: list[tuple[float, float, float]]) -> Any:
    return import_manifold().Manifold.hull_points(np.array(points))


def _torus(major: float, minor: float) -> Any:
    solids = import_manifold()
    circle = solids.CrossSection.circle(minor, 32).translate((major, 0.0))
    return solids.Manifold.revolve(circle, _ROUND)


def _union(parts: list[Any]) -> Any:
    solids = import_manifold()
    return solids.Manifold.batch_boolean(parts, solids.OpType.Add)


# ---- bodies --------------------------------------------------------------------------------------


def _bunny(size: float, error: float) -> Mesh:
    """About the middle of its bounds, z up; with fewer triangles where ``error`` is above 0."""
    solids = import_manifold()
    mesh = read_mesh(find_bunny())
    vertices = mesh.vertices[:, [0, 2, 1]] * (1.0, -1.0, 1.0)
    vertices -= 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    vertices *= size / np.ptp(vertices, axis=0).max()
    solid = solids.Manifold(solids.Mesh64(vertices, mesh.faces.astype(np.uint64)))
    return as_mesh(solid.simplify(error))


def _mug() -> Any:
    """0.1 m high, with walls of 4 mm, a floor of 5 mm and a handle."""
    handle = _torus(0.028, 0.005).rotate((90.0, 0.0, 0.0)).translate((0.042, 0.0, 0.0))
    outside = _cylinder(0.1, 0.04) + handle
    return outside - _cylinder(0.1, 0.036).translate((0.0, 0.0, 0.005))


def _cup(wall: float) -> Any:
    """0.08 m high and open above, narrower below."""
    inside = _cylinder(0.08, 0.025 - wall, 0.035 - wall).translate((0.0, 0.0, wall))
    return _cylinder(0.08, 0.025, 0.035) - inside


def _bowl() -> Any:
    """Half a hollow ball of 60 mm radius with a wall of 2 mm, open above."""
    return (_ball(0.06) - _ball(0.058)) - _box(0.2, 0.2, 0.1).translate((0.0, 0.0, 0.05))


def _table() -> Any:
    """1.2 m x 0.8 m, its top 25 mm thick with its upper face at z = 0, on four legs."""
    top = _box(1.2, 0.8, 0.025).translate((0.0, 0.0, -0.0125))
    legs = [
        _box(0.05, 0.05, 0.7).translate((x * 0.55, y * 0.35, -0.37))
        for x in (-1, 1)
        for y in (-1, 1)
    ]
    return _union([top, *legs])


def _stairs(length: float, steps: int) -> Any:
    """Steps up along x, as deep as high, with their lowest floor at z = 0."""
    depth = length / steps
    points = [(0.0, -depth)]
    points += [(length, -depth)]
    for step in range(steps, 0, -1):
        points += [(step * depth, (step - 1) * depth), ((step - 1) * depth, (step - 1) * depth)]
    solid = _extrude(points, length)
    return solid.rotate((90.0, 0.0, 0.0)).translate((-0.5 * length, 0.0, 0.0))


def _terrain(length: float, cells: int) -> Mesh:
    """Hills of up to 0.2 m on a square ground, closed by walls and a floor 0.4 m below."""
    across = np.linspace(-0.5 * length, 0.5 * length, cells + 1)
    x, y = np.meshgrid(across, across, indexing="ij")
    height = 0.1 * np.sin(2.3 * x + 0.4) * np.cos(1.9 * y) + 0.04 * np.sin(5.1 * x - 3.7 * y)
    height += 0.012 * np.sin(17.0 * y + 3.0 * x)
    top = np.stack([x, y, height], axis=-1).reshape(-1, 3)
    index = np.arange(len(top)).reshape(cells + 1, cells + 1)
    first, right, up, far = index[:-1, :-1], index[1:, :-1], index[:-1, 1:], index[1:, 1:]
    faces = [
        np.stack([first, right, far], axis=-1).reshape(-1, 3),
        np.stack([first, far, up], axis=-1).reshape(-1, 3),
    ]
    floor = top.copy()
    floor[:, 2] = -0.4
    faces += [face[:, ::-1] + len(top) for face in faces[:2]]
    rim = np.concatenate([index[:, 0], index[-1, 1:], index[-2::-1, -1], index[0, -2:0:-1]])
    after = np.roll(rim, -1)
    faces += [
        np.stack([rim, rim + len(top), after + len(top)], axis=-1),
        np.stack([rim, after + len(top), after], axis=-1),
    ]
    return Mesh(np.concatenate([top, floor]), np.concatenate(faces).astype(np.uint32))


def _screw() -> Any:
    """5 mm long: a thread of 1.5 mm with a pitch of 0.4 mm on a hexagonal head."""
    return make_bolt(0.00075, 0.00012, 0.0004, 0.004, 0.001, 24, 8)


def _dented_box() -> Any:
    dents = [
        _ball(0.02).translate((0.02, 0.01, -0.035)),
        _ball(0.015).translate((-0.045, 0.0, 0.01)),
        _ball(0.03).translate((0.0, -0.045, 0.02)),
    ]
    return _box(0.08, 0.06, 0.04) - _union(dents)


def _bracket(thickness: float) -> Any:
    """An angle of two plates, 0.1 m and 0.06 m, with holes for screws."""
    angle = _box(0.1, 0.06, thickness).translate((0.05, 0.0, 0.5 * thickness))
    angle += _box(thickness, 0.06, 0.06).translate((0.5 * thickness, 0.0, 0.03))
    holes = [
        _cylinder(0.1, 0.005).translate((x, y, 0.0)) for x in (0.05, 0.08) for y in (-0.015, 0.015)
    ]
    return angle - _union(holes)


def _profile(shape: str, length: float, height: float, wall: float) -> Any:
    """A bar along x with a section like the letter, its height along z."""
    web = _box(length, wall, height)
    flange = _box(length, height, wall)
    rise = 0.5 * (height - wall)
    if shape == "L":
        return web.translate((0.0, -rise, 0.0)) + flange.translate((0.0, 0.0, -rise))
    return _union([web, flange.translate((0.0, 0.0, rise)), flange.translate((0.0, 0.0, -rise))])


def _blade() -> Any:
    """0.2 m along x with its edge at z = 0, 30 mm high and 6 mm thick at the back."""
    ends = (-0.1, 0.1)
    points = [(x, y, z) for x in ends for y, z in ((0.0, 0.0), (-0.003, -0.03), (0.003, -0.03))]
    return _hull(points)


def _wedge() -> Any:
    """0.3 m along x, with its edge of 60 degrees at z = 0 and below it 0.1 m of body."""
    points = [
        (x, y, z) for x in (-0.15, 0.15) for y, z in ((0, 0), (-0.0577, -0.1), (0.0577, -0.1))
    ]
    return _hull(points)


def _pyramid() -> Any:
    """Its tip at the origin, pointing down; its square base of 0.2 m is 0.15 m above."""
    return _hull([(0.0, 0.0, 0.0), *((x, y, 0.15) for x in (-0.1, 0.1) for y in (-0.1, 0.1))])


def _tetrahedron(edge: float) -> Any:
    signs = ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))
    scale = edge / np.sqrt(8.0)
    return _hull([(scale * x, scale * y, scale * z) for x, y, z in signs])


def _octahedron(edge: float) -> Any:
    reach = edge / np.sqrt(2.0)
    return _hull([tuple(sign * reach * row) for row in np.eye(3) for sign in (-1, 1)])


def _icosahedron(radius: float) -> Any:
    golden = 0.5 * (1.0 + np.sqrt(5.0))
    scale = radius / np.hypot(1.0, golden)
    corners = [
        np.roll((0.0, one * scale, two * golden * scale), shift)
        for one in (-1, 1)
        for two in (-1, 1)
        for shift in range(3)
    ]
    return _hull([tuple(corner) for corner in corners])


def _star(radius: float) -> Any:
    """A small ball with twenty spikes, whose tips are ``radius`` from the middle."""
    rng = np.random.default_rng(7)
    directions = rng.normal(size=(20, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    spikes = []
    for direction in directions:
        side = np.cross(direction, np.roll(direction, 1))
        side /= np.linalg.norm(side)
        other = np.cross(direction, side)
        foot = [
            tuple(radius * (0.2 * direction + 0.12 * (np.cos(t) * side + np.sin(t) * other)))
            for t in np.linspace(0.0, 2.0 * np.pi, 6, endpoint=False)
        ]
        spikes.append(_hull([tuple(radius * direction), (0.0, 0.0, 0.0), *foot]))
    return _union([_ball(0.35 * radius), *spikes])


def _slotted_block() -> Any:
    """A block of 60 mm with a slot of 0.8 mm across, 20 mm deep from above, in the plane y = 0."""
    return _box(0.06, 0.06, 0.04) - _box(0.1, 0.0008, 0.04).translate((0.0, 0.0, 0.02))


def _peg() -> Any:
    """A pin of 10 mm radius and 60 mm height on a foot."""
    pin = _cylinder(0.064, 0.01).translate((0.0, 0.0, -0.002))
    return pin + _box(0.06, 0.06, 0.01).translate((0.0, 0.0, -0.035))


def _ring() -> Any:
    """Fits over the peg with 0.5 mm of play along the radius."""
    return _cylinder(0.01, 0.016) - _cylinder(0.02, 0.0105)


def _comb() -> Any:
    """Fins of 1 mm, 2 mm apart, upward from a back, 40 mm long along y."""
    back = _box(0.04, 0.04, 0.004).translate((0.0, 0.0, -0.002))
    fins = [_box(0.001, 0.04, 0.02).translate((0.003 * i, 0.0, 0.01)) for i in range(-6, 7)]
    return _union([back, *fins])


def _knurl() -> Any:
    """A plate of 0.1 m covered with pyramids 4 mm wide and 3 mm high."""
    tops = [
        _hull(
            [(x, y, 0.003)]
            + [(x + i, y + j, -0.001) for i in (-0.0026, 0.0026) for j in (-0.0026, 0.0026)]
        )
        for x in np.arange(-0.046, 0.0461, 0.004).tolist()
        for y in np.arange(-0.046, 0.0461, 0.004).tolist()
    ]
    return _union([_box(0.1, 0.1, 0.005).translate((0.0, 0.0, -0.0025)), *tops])


def _frame() -> Any:
    """A window frame of 1 m by 0.7 m, its bars 8 mm by 8 mm."""
    return _box(1.0, 0.7, 0.008) - _box(0.984, 0.684, 0.1)


def _hook() -> Any:
    """Two thirds of a ring of 15 mm with a shaft."""
    ring = _torus(0.015, 0.002) - _box(0.05, 0.05, 0.05).translate((0.03, 0.02, 0.0))
    return ring + _cylinder(0.05, 0.002).rotate((90.0, 0.0, 0.0)).translate((-0.015, 0.024, 0.0))


def _ball_of(radius: float) -> Callable[[], Any]:
    return lambda: _ball(radius)


def _slab_of(length: float) -> Callable[[], Any]:
    return lambda: _slab(length)


BODIES: dict[str, Callable[[], Any]] = {
    # Named in the table of what was measured before.
    "ball 30 mm": _ball_of(0.015),
    **{f"slab {length:g} m": _slab_of(length) for length in (0.3, 1.0, 1.5, 2.0, 3.0, 5.0)},
    "terrain 5 m": lambda: _terrain(5.0, 100),
    "bunny 0.2 m": lambda: _bunny(0.2, 5e-5),
    "mug": _mug,
    "table 1.2 m": _table,
    "bar 1 m x 10 mm": lambda: _box(1.0, 0.01, 0.01),
    "blade": _blade,
    "pyramid": _pyramid,
    "box 0.1 m": lambda: _box(0.1, 0.08, 0.06),
    "plate 1 mm": lambda: _box(0.1, 0.1, 0.001),
    "bracket 6 mm": lambda: _bracket(0.006),
    "cup 1.5 mm": lambda: _cup(0.0015),
    # Of other kinds and sizes.
    "can": lambda: _cylinder(0.115, 0.033),
    "cube 50 mm": lambda: _box(0.05, 0.05, 0.05),
    "cube 5 mm": lambda: _box(0.005, 0.005, 0.005),
    "cube 0.5 m": lambda: _box(0.5, 0.5, 0.5),
    "screw 5 mm": _screw,
    "stairs 2 m": lambda: _stairs(2.0, 8),
    "stairs 5 m": lambda: _stairs(5.0, 12),
    "gear": lambda: make_gear(24, 0.003, 0.01, 0.008, 0.0004),
    "pinion": lambda: make_gear(12, 0.003, 0.01, 0.005, 0.0004),
    "rod 2 mm": lambda: _cylinder(0.5, 0.001, segments=16),
    "ellipsoid": lambda: _ball(0.03, (1.0, 0.6, 0.35)),
    "dented box": _dented_box,
    "torus": lambda: _torus(0.04, 0.01),
    "L-profile": lambda: _profile("L", 0.4, 0.04, 0.003),
    "I-beam 5 m": lambda: _profile("I", 5.0, 0.2, 0.012),
    "wedge": _wedge,
    "cone": lambda: _cylinder(0.06, 0.03, 0.0).rotate((180.0, 0.0, 0.0)),
    "ring": _ring,
    "peg": _peg,
    "tetrahedron": lambda: _tetrahedron(0.08),
    "octahedron": lambda: _octahedron(0.05),
    "icosahedron": lambda: _icosahedron(0.05),
    "star": lambda: _star(0.06),
    "card 0.4 mm": lambda: _box(0.05, 0.0004, 0.03),
    "slotted block": _slotted_block,
    "needle": lambda: _cylinder(0.06, 0.0, 0.00025, 12),
    "comb": _comb,
    "sheet 1 m x 0.5 mm": lambda: _box(1.0, 1.0, 0.0005),
    "knurl": _knurl,
    "bowl": _bowl,
    "hook": _hook,
    "wire 1 m x 1 mm": lambda: _cylinder(1.0, 0.0005, segments=12),
    "window frame": _frame,
}
"""What makes each body: a ``manifold3d.Manifold``, or a :class:`Mesh`. Sizes are in the names."""
