"""Scenes of the study of geometry: which two bodies meet, in which poses, and what is demanded.

The list was written before anything was tuned by it. Scenes with ``held_out=True`` were chosen by
someone who did not write the code, and are for judging alone: tune by the others.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from voxshell_studies.scenes.geometry_bodies import make_body

if TYPE_CHECKING:
    from numpy.typing import NDArray

MM = 1e-3
LEAST_BAR = 0.1 * MM
"""Meters: no contact of resting bodies has to be nearer to the truth than this."""

FRACTION_OF_OBJECT = 0.005
"""Nor nearer than this fraction of the smaller body."""

EDGE_BAR = 0.2 * MM
"""Meters, for contacts of edges, corners and tips."""

Group = Literal["rest", "edges", "thin", "inside"]
"""Bodies at rest on others; edges and tips; thin parts edgewise; bodies within or about others."""


@dataclass(frozen=True)
class GeometryScene:
    """Body a comes nearer to body b along a direction, from poses drawn by a seed.

    Attributes:
        name: Unique.
        group: What kind of contact it is.
        a: The body that moves, a key of :data:`voxshell_studies.scenes.geometry_bodies.BODIES`.
        b: The other one; it stays at the origin.
        turn: Euler angles of a before it is turned on, degrees: about x, then y, then z of the world.
        at: Where a's origin is, meters. The approach begins here with ``start="here"``, and infinitely far
            behind it with ``start="far"``.
        spread: Poses differ by up to this much along each axis, meters; along the approach it is without
            effect where that begins far away.
        spin: How poses differ in orientation: not at all, about the approach by up to ``spin_degrees``, or
            in any way.
        spin_degrees: Degrees, to either side.
        approach: Direction in which a moves, (3,); need not be unit length.
        start: Where the approach begins.
        bar: How far off the true first touch the first contact may be, meters; 0 for that of resting
            bodies, which follows from the smaller body's size.
        depths: How deep beyond the first touch contacts are looked at, meters. Empty: a quarter, one and
            four times the bar.
        deepest: How deep an overlap that is not seen is looked for, meters; 0 for the smaller body's
            thinnest side.
        judge_normals: Whether normals are judged by the bar as well; they are reported of all.
        held_out: Whether nothing may be tuned by it.
    """

    name: str
    group: Group
    a: str
    b: str
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0)
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    spread: tuple[float, float, float] = (0.0, 0.0, 0.0)
    spin: Literal["none", "spin", "any"] = "none"
    spin_degrees: float = 180.0
    approach: tuple[float, float, float] = (0.0, 0.0, -1.0)
    start: Literal["far", "here"] = "far"
    bar: float = 0.0
    depths: tuple[float, ...] = ()
    deepest: float = 0.0
    judge_normals: bool = False
    held_out: bool = False

    def place(self, index: int) -> NDArray[np.float64]:
        """``b_from_a`` before the approach, (4, 4); the first pose is the one without chance.

        Example:
            >>> SCENES["ball on slab 1 m"].place(0)[:3, 3]
            array([0., 0., 0.])
        """
        digest = sum(ord(letter) * (place + 1) for place, letter in enumerate(self.name))
        rng = np.random.default_rng((digest, index))
        pose = np.eye(4)
        pose[:3, :3] = turn_about(np.radians(self.turn))
        pose[:3, 3] = self.at
        if index > 0:
            if self.spin == "any":
                pose[:3, :3] = random_rotation(rng)
            elif self.spin == "spin":
                angle = np.radians(rng.uniform(-self.spin_degrees, self.spin_degrees))
                pose[:3, :3] = turn_about_axis(self.direction, angle) @ pose[:3, :3]
            pose[:3, 3] += rng.uniform(-1.0, 1.0, 3) * self.spread
        return pose

    @property
    def direction(self) -> NDArray[np.float64]:
        """Of the approach, unit length."""
        return np.array(self.approach) / np.linalg.norm(self.approach)

    @property
    def size(self) -> float:
        """The longest side of the smaller body, meters."""
        return float(min(_extents(self.a).max(), _extents(self.b).max()))

    @property
    def onset_bar(self) -> float:
        """How far off the true first touch the first contact may be, meters."""
        return self.bar or max(LEAST_BAR, FRACTION_OF_OBJECT * self.size)

    @property
    def looked_at(self) -> tuple[float, ...]:
        """The depths at which contacts are looked at, meters; none is beyond the middle of a thin body."""
        if self.depths:
            return self.depths
        return tuple(min(factor * self.onset_bar, 0.4 * self.reach) for factor in (0.25, 1.0, 4.0))

    @property
    def reach(self) -> float:
        """How deep an overlap that is not seen is looked for, meters."""
        return self.deepest or float(min(_extents(self.a).min(), _extents(self.b).min()))


def _extents(body: str) -> NDArray[np.float64]:
    return np.ptp(make_body(body).vertices, axis=0)


# ---- rotations -----------------------------------------------------------------------------------


def turn_about_axis(axis: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """The rotation about a unit axis, (3, 3); radians."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * (cross @ cross)


def turn_about(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """The rotation about x, then y, then z of the world, (3, 3); radians."""
    rotation = np.eye(3)
    for axis, angle in zip(np.eye(3), angles, strict=True):
        rotation = turn_about_axis(axis, float(angle)) @ rotation
    return rotation


def random_rotation(rng: np.random.Generator) -> NDArray[np.float64]:
    """Uniform: a normalized Gaussian quaternion, (3, 3)."""
    quaternion = rng.normal(size=4)
    w, *axis = quaternion / np.linalg.norm(quaternion)
    length = float(np.linalg.norm(axis))
    return turn_about_axis(np.array(axis) / length, 2.0 * float(np.arctan2(length, w)))


# ---- scenes --------------------------------------------------------------------------------------


def _rest(name: str, a: str, b: str, spread: float, **settings: object) -> GeometryScene:
    """A body in any orientation comes down somewhere on a ground."""
    values: dict[str, object] = {"spread": (spread, spread, 0.0), "spin": "any", **settings}
    return GeometryScene(name, "rest", a, b, **values)  # pyright: ignore[reportArgumentType]


_EDGES = {"bar": EDGE_BAR, "depths": (0.05 * MM, 0.2 * MM, 0.8 * MM)}
_ROOT_HALF_DEGREES = 35.26438968  # between a cube's face and its diagonal
_TABLE_DEPTHS = (1 * MM, 3 * MM, 5 * MM, 12 * MM)

_ALL = (
    # ---- those of the table of what was measured before
    *(
        _rest(f"ball on slab {length:g} m", "ball 30 mm", f"slab {length:g} m", 0.4 * length)
        for length in (0.3, 1.0, 2.0, 5.0)
    ),
    _rest("bunny on terrain 5 m", "bunny 0.2 m", "terrain 5 m", 2.0),
    _rest("bunny on slab 1.5 m", "bunny 0.2 m", "slab 1.5 m", 0.5),
    _rest("mug on table", "mug", "table 1.2 m", 0.25, depths=_TABLE_DEPTHS, at=(0.03, 0.02, 0.0)),
    GeometryScene(
        *("mug upright on table", "rest", "mug", "table 1.2 m"),
        at=(0.031, 0.022, 0.0),
        spread=(0.3, 0.2, 0.0),
        spin="spin",
        depths=_TABLE_DEPTHS,
    ),
    GeometryScene(
        *("crossed bars, face on face", "edges", "bar 1 m x 10 mm", "bar 1 m x 10 mm"),
        turn=(0.0, 0.0, 90.0),
        at=(0.0123, 0.0077, 0.0),
        spread=(0.2, 0.2, 0.0),
        spin="spin",
        spin_degrees=40.0,
        **_EDGES,
    ),
    GeometryScene(
        *("crossed bars, edge on edge", "edges", "bar 1 m x 10 mm", "bar 1 m x 10 mm"),
        # They come nearer along the diagonal of both sections.
        turn=(45.0, 45.0, 90.0),
        at=(0.0123, 0.0, 0.0),
        spread=(0.2, 0.1, 0.1),
        spin="spin",
        spin_degrees=40.0,
        approach=(0.0, -1.0, -1.0),
        **_EDGES,
    ),
    GeometryScene(
        *("crossed knives", "edges", "blade", "blade"),
        turn=(180.0, 0.0, 90.0),
        at=(0.0037, 0.0051, 0.0),
        spread=(0.05, 0.05, 0.0),
        spin="spin",
        spin_degrees=60.0,
        **_EDGES,
    ),
    GeometryScene(
        *("pyramid tip on slab 1 m", "edges", "pyramid", "slab 1 m"),
        at=(0.0123, 0.0077, 0.0),
        spread=(0.35, 0.35, 0.0),
        spin="spin",
        **_EDGES,
    ),
    GeometryScene(
        *("box on its edge on slab 1 m", "edges", "box 0.1 m", "slab 1 m"),
        turn=(40.0, 0.0, 0.0),
        at=(0.0123, 0.0077, 0.0),
        spread=(0.35, 0.35, 0.0),
        spin="spin",
        **_EDGES,
    ),
    GeometryScene(
        *("box on its edge on slab 2 m", "edges", "box 0.1 m", "slab 2 m"),
        turn=(40.0, 0.0, 0.0),
        at=(0.0123, 0.0077, 0.0),
        spread=(0.7, 0.7, 0.0),
        spin="spin",
        **_EDGES,
    ),
    GeometryScene(
        *("box on its corner on slab 1 m", "edges", "box 0.1 m", "slab 1 m"),
        turn=(45.0, _ROOT_HALF_DEGREES, 0.0),
        at=(0.0123, 0.0077, 0.0),
        spread=(0.35, 0.35, 0.0),
        spin="spin",
        **_EDGES,
    ),
    GeometryScene(
        *("plate edgewise on plate's face", "thin", "plate 1 mm", "plate 1 mm"),
        turn=(90.0, 0.0, 0.0),
        at=(0.0011, 0.0007, 0.0),
        spread=(0.01, 0.02, 0.0),
        spin="spin",
        **_EDGES,
    ),
    GeometryScene(
        *("plates crossed edge on edge", "thin", "plate 1 mm", "plate 1 mm"),
        # b lies; a stands upright beside it and comes in from the side.
        turn=(90.0, 0.0, 90.0),
        at=(0.1, 0.0071, 0.0033),
        spread=(0.0, 0.03, 0.03),
        spin="spin",
        spin_degrees=50.0,
        approach=(-1.0, 0.0, 0.0),
        **_EDGES,
    ),
    _rest("bracket on slab 0.3 m", "bracket 6 mm", "slab 0.3 m", 0.08),
    _rest(
        "ball on bracket",
        "ball 30 mm",
        "bracket 6 mm",
        0.02,
        at=(0.04, 0.0, 0.0),
        judge_normals=True,
        depths=(0.5 * MM, 2 * MM, 4 * MM),
    ),
    _rest(
        "bracket on bracket",
        "bracket 6 mm",
        "bracket 6 mm",
        0.02,
        at=(0.03, 0.0, 0.0),
        judge_normals=True,
        depths=(0.5 * MM, 2 * MM, 4 * MM),
    ),
    _rest(
        "ball on cup",
        "ball 30 mm",
        "cup 1.5 mm",
        0.02,
        judge_normals=True,
        depths=(0.2 * MM, 0.6 * MM, 1.2 * MM),
    ),
    _rest(
        "cup on cup",
        "cup 1.5 mm",
        "cup 1.5 mm",
        0.02,
        judge_normals=True,
        depths=(0.2 * MM, 0.6 * MM, 1.2 * MM),
    ),
    # ---- of other kinds and sizes
    _rest("can on table", "can", "table 1.2 m", 0.25),
    GeometryScene(
        *("can on its side on slab 2 m", "rest", "can", "slab 2 m"),
        turn=(90.0, 0.0, 0.0),
        spread=(0.8, 0.8, 0.0),
        spin="spin",
    ),
    GeometryScene(
        *("cube flat on table", "rest", "cube 50 mm", "table 1.2 m"),
        at=(0.0123, 0.0077, 0.0),
        spread=(0.4, 0.25, 0.0),
        spin="spin",
    ),
    _rest("cube on stairs 2 m", "cube 50 mm", "stairs 2 m", 0.8),
    _rest("cube on terrain 5 m", "cube 50 mm", "terrain 5 m", 2.0),
    _rest("screw on slab 1 m", "screw 5 mm", "slab 1 m", 0.4),
    _rest("screw on table", "screw 5 mm", "table 1.2 m", 0.35),
    _rest("bunny on stairs 2 m", "bunny 0.2 m", "stairs 2 m", 0.7),
    _rest("bunny on table", "bunny 0.2 m", "table 1.2 m", 0.25),
    _rest("mug on terrain 5 m", "mug", "terrain 5 m", 2.0),
    _rest("mug on stairs 2 m", "mug", "stairs 2 m", 0.8),
    _rest("ellipsoid on slab 1 m", "ellipsoid", "slab 1 m", 0.4),
    _rest("dented box on slab 1 m", "dented box", "slab 1 m", 0.4),
    _rest("bunny on bunny", "bunny 0.2 m", "bunny 0.2 m", 0.05),
    _rest("mug on mug", "mug", "mug", 0.03),
    GeometryScene(
        *("gear and pinion", "inside", "pinion", "gear"),
        at=(0.1, 0.0003, 0.001),
        spread=(0.0, 0.002, 0.002),
        spin="none",
        approach=(-1.0, 0.0, 0.0),
    ),
    GeometryScene(
        *("crossed rods of 2 mm", "thin", "rod 2 mm", "rod 2 mm"),
        turn=(0.0, 90.0, 0.0),
        at=(0.0123, 0.0, 0.0077),
        spread=(0.1, 0.0, 0.1),
        spin="spin",
        spin_degrees=60.0,
        approach=(0.0, -1.0, 0.0),
        **_EDGES,
    ),
    GeometryScene(
        *("wedge across wedge", "edges", "wedge", "wedge"),
        turn=(180.0, 0.0, 90.0),
        at=(0.0037, 0.0051, 0.0),
        spread=(0.08, 0.08, 0.0),
        spin="spin",
        spin_degrees=60.0,
        **_EDGES,
    ),
    GeometryScene(
        *("L-profile across L-profile", "thin", "L-profile", "L-profile"),
        turn=(160.0, 0.0, 80.0),
        at=(0.0237, 0.0151, 0.0),
        spread=(0.08, 0.01, 0.0),
        spin="spin",
        spin_degrees=30.0,
        **_EDGES,
    ),
    # ---- chosen by someone who did not write the code
    GeometryScene(
        *("linked rings", "inside", "torus", "torus"),
        turn=(90.0, 0.0, 0.0),
        at=(0.04, 0.0, 0.0),
        spread=(0.005, 0.005, 0.005),
        spin="spin",
        spin_degrees=25.0,
        approach=(1.0, 0.2, 0.1),
        start="here",
        held_out=True,
    ),
    GeometryScene(
        *("cone tip on cube 0.5 m", "edges", "cone", "cube 0.5 m"),
        at=(0.0123, 0.0077, 0.0),
        spread=(0.2, 0.2, 0.0),
        spin="spin",
        held_out=True,
        **_EDGES,
    ),
    GeometryScene(
        *("ring on peg, sideways", "inside", "ring", "peg"),
        at=(0.0, 0.0, 0.005),
        spread=(0.0002, 0.0002, 0.01),
        spin="spin",
        spin_degrees=1.0,
        approach=(1.0, 0.3, 0.0),
        start="here",
        bar=LEAST_BAR,
        held_out=True,
    ),
    _rest("tetrahedron on tetrahedron", "tetrahedron", "tetrahedron", 0.01, held_out=True),
    GeometryScene(
        *("tetrahedron's edge on octahedron's edge", "edges", "tetrahedron", "octahedron"),
        at=(0.011, 0.0052, 0.0),
        turn=(0.0, 0.0, 45.0),
        spread=(0.004, 0.004, 0.0),
        spin="spin",
        spin_degrees=30.0,
        approach=(0.3, 0.2, -1.0),
        held_out=True,
        **_EDGES,
    ),
    _rest("star on terrain 5 m", "star", "terrain 5 m", 2.0, held_out=True),
    _rest("star on star", "star", "star", 0.02, bar=EDGE_BAR, held_out=True),
    _rest("icosahedron on slab 3 m", "icosahedron", "slab 3 m", 1.2, held_out=True),
    GeometryScene(
        *("card in slot, sideways", "inside", "card 0.4 mm", "slotted block"),
        at=(0.001, 0.0, 0.02),
        spread=(0.003, 0.00005, 0.005),
        approach=(0.0, 1.0, 0.0),
        start="here",
        bar=LEAST_BAR,
        held_out=True,
    ),
    _rest("cube of 5 mm on slab 5 m", "cube 5 mm", "slab 5 m", 2.2, held_out=True),
    GeometryScene(
        *("screw on the edge of stairs 5 m", "rest", "screw 5 mm", "stairs 5 m"),
        # An edge of the steps is at the height and the place of a tread's front.
        at=(-2.5 + 5.0 / 12.0, 0.013, 0.0),
        spread=(0.0015, 1.0, 0.0),
        spin="any",
        held_out=True,
    ),
    GeometryScene(
        *("needle on bunny", "thin", "needle", "bunny 0.2 m"),
        at=(0.011, 0.007, 0.0),
        spread=(0.03, 0.03, 0.0),
        spin="spin",
        held_out=True,
        **_EDGES,
    ),
    GeometryScene(
        *("comb into comb", "inside", "comb", "comb"),
        turn=(180.0, 0.0, 0.0),
        at=(0.0015, 0.0011, 0.03),
        spread=(0.0003, 0.004, 0.003),
        approach=(1.0, 0.0, 0.0),
        start="here",
        bar=LEAST_BAR,
        deepest=0.0009,  # farther on, fins come out of fins
        held_out=True,
    ),
    _rest(
        "bunny under sheet 1 m x 0.5 mm",
        "sheet 1 m x 0.5 mm",
        "bunny 0.2 m",
        0.1,
        bar=EDGE_BAR,
        held_out=True,
    ),
    GeometryScene(
        *("knurl on knurl", "edges", "knurl", "knurl"),
        turn=(180.0, 0.0, 0.0),
        at=(0.0011, 0.0007, 0.0),
        spread=(0.01, 0.01, 0.0),
        spin="spin",
        held_out=True,
        **_EDGES,
    ),
    GeometryScene(
        *("ball in bowl", "inside", "ball 30 mm", "bowl"),
        spread=(0.005, 0.005, 0.0),
        spin="any",
        approach=(0.3, 0.1, -1.0),
        at=(0.0, 0.0, -0.01),
        start="here",
        held_out=True,
    ),
    _rest("cube of 5 mm on I-beam 5 m", "cube 5 mm", "I-beam 5 m", 0.09, held_out=True),
    GeometryScene(
        *("hook on wire", "thin", "hook", "wire 1 m x 1 mm"),
        turn=(0.0, 0.0, 0.0),
        at=(0.003, 0.002, 0.01),
        spread=(0.002, 0.002, 0.2),
        spin="spin",
        spin_degrees=20.0,
        approach=(1.0, 0.1, 0.0),
        start="here",
        held_out=True,
        **_EDGES,
    ),
    GeometryScene(
        *("window frame on table", "thin", "window frame", "table 1.2 m"),
        turn=(0.0, 75.0, 10.0),
        at=(0.02, 0.03, 0.0),
        spread=(0.03, 0.03, 0.0),
        spin="spin",
        spin_degrees=15.0,
        held_out=True,
        **_EDGES,
    ),
    GeometryScene(
        *("blade across I-beam 5 m", "edges", "blade", "I-beam 5 m"),
        turn=(180.0, 3.0, 90.0),
        at=(0.123, 0.007, 0.0),
        spread=(2.2, 0.05, 0.0),
        spin="spin",
        spin_degrees=20.0,
        held_out=True,
        **_EDGES,
    ),
    _rest("octahedron on knurl", "octahedron", "knurl", 0.03, bar=EDGE_BAR, held_out=True),
)

SCENES: dict[str, GeometryScene] = {scene.name: scene for scene in _ALL}
"""All scenes by name, in the order of the report."""

COINCIDENT: tuple[str, ...] = (
    "cube 50 mm",
    "bunny 0.2 m",
    "mug",
    "plate 1 mm",
    "torus",
    "ball 30 mm",
)
"""Bodies that are put into the very same pose as a copy of theirs, which is a contact."""

THIN: tuple[str, ...] = ("bracket 6 mm", "cup 1.5 mm")
"""Bodies on which normals and places of contacts are judged."""

PAIRS: tuple[tuple[str, str], ...] = (
    ("ball 30 mm", "slab 2 m"),
    ("bunny 0.2 m", "terrain 5 m"),
    ("mug", "table 1.2 m"),
    ("bar 1 m x 10 mm", "bar 1 m x 10 mm"),
    ("screw 5 mm", "cube 50 mm"),
    ("cube 5 mm", "slab 5 m"),
    ("plate 1 mm", "bunny 0.2 m"),
    ("star", "dented box"),
    ("gear", "L-profile"),
    ("torus", "window frame"),
    ("blade", "I-beam 5 m"),
    ("cup 1.5 mm", "stairs 2 m"),
)
"""Pairs of mixed size that meet in any pose."""

BUILT: tuple[str, ...] = (
    *("ball 30 mm", "slab 0.3 m", "slab 5 m", "terrain 5 m", "bunny 0.2 m", "mug", "table 1.2 m"),
    *(
        "bar 1 m x 10 mm",
        "blade",
        "pyramid",
        "box 0.1 m",
        "plate 1 mm",
        "bracket 6 mm",
        "cup 1.5 mm",
    ),
    *(
        "can",
        "cube 5 mm",
        "screw 5 mm",
        "stairs 5 m",
        "gear",
        "rod 2 mm",
        "ellipsoid",
        "dented box",
    ),
    *("torus", "L-profile", "I-beam 5 m", "star", "comb", "sheet 1 m x 0.5 mm", "knurl", "bowl"),
    *("hook", "wire 1 m x 1 mm", "window frame"),
)
"""Bodies whose default build is judged by time and memory."""
