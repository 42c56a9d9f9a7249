"""A bolt and the nut that fits it: what a convex decomposition cannot tell apart from a solid.

Made with manifold3d, in any resolution and with an exact clearance. Meters; the axis is z.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from voxshell.base.arguments import as_integer, as_positive
from voxshell.errors import SettingsError
from voxshell.model.model import Model
from voxshell_studies.scenes.solids import as_mesh, import_manifold

if TYPE_CHECKING:
    from numpy.typing import NDArray

FitMethod = Literal["voxshell", "gimpact", "decomposition", "hull"]
"""Models, Bullet's GImpact, V-HACD's hulls, and one hull each."""

_DEGREES_A_TURN = 360.0


@dataclass(frozen=True)
class BoltSettings:
    """Settings of bolt and nut.

    Attributes:
        radius: Of the thread, outer, meters.
        depth: Of the thread, meters.
        pitch: Meters a turn.
        length: Of the bolt's thread, meters.
        head: Height of the bolt's head, meters.
        height: Of the nut, meters.
        clearance: Between the threads along the radius, meters.
        segments: Edges of a turn.
        sections: Cuts a pitch. Edges join the same corner of one and the next, which has turned: with 64 they
            go 0.01 mm deeper than the thread; with 12, 0.34 mm, which takes most of its clearance.
        voxel_size: Meters.
        rate: Steps a second.
        friction: Of each of the two.
        seconds: Of the nut at rest, and of its way down.
        fit_methods: Whose view of the fit is compared.

    Raises:
        SettingsError: A number is out of range, or the thread is deeper than the bolt.
        MissingExtraError: manifold3d is not installed, when the shapes are built.
    """

    radius: float = 0.010
    depth: float = 0.0015
    pitch: float = 0.006
    length: float = 0.048
    head: float = 0.006
    height: float = 0.009
    clearance: float = 0.0004
    segments: int = 64
    sections: int = 64
    voxel_size: float = 0.0002
    rate: float = 1000.0
    friction: float = 1.0
    seconds: float = 2.0
    fit_methods: tuple[FitMethod, ...] = ("voxshell", "gimpact", "decomposition", "hull")

    def __post_init__(self) -> None:
        for name in (
            *("radius", "depth", "pitch", "length", "head", "height"),
            *("clearance", "voxel_size", "rate", "friction", "seconds"),
        ):
            as_positive(getattr(self, name), name)
        as_integer(self.segments, "segments", 8, 4096)
        as_integer(self.sections, "sections", 8, 4096)
        if self.depth >= self.radius:
            raise SettingsError("depth must be below radius")

    def build_bolt(self) -> Model:
        """Its thread from z = 0 up, on a hexagonal head below."""
        return _build_models(self)[0]

    def build_nut(self) -> Model:
        """From z = 0 up; it fits at whole turns along its screw."""
        return _build_models(self)[1]

    def compute_clearance(self) -> float:
        """Between the flanks in the middle of the nut's play, meters: less than along the radius."""
        # A cut's radius rises by the thread's depth over a quarter of a turn, which is as much of a pitch.
        along_axis = 4.0 * self.depth / self.pitch
        around = 2.0 * self.depth / (np.pi * (self.radius - 0.5 * self.depth))
        return float(self.clearance / np.sqrt(1.0 + along_axis**2 + around**2))

    def compute_fit(self, turns: float) -> NDArray[np.float64]:
        """The nut's pose on the bolt after so many turns from its foot, (4, 4)."""
        from trimesh.transformations import rotation_matrix

        pose = np.array(rotation_matrix(2.0 * np.pi * turns, (0.0, 0.0, 1.0)))
        pose[2, 3] = turns * self.pitch
        return pose


def measure_turns(pose: NDArray[np.float64]) -> float:
    """The angle about z of a pose, in turns, -0.5 to 0.5."""
    return float(np.arctan2(pose[1, 0], pose[0, 0]) / (2.0 * np.pi))


def make_rod(
    radius: float, depth: float, pitch: float, length: float, segments: int, sections: int
) -> Any:
    """A right-handed trapezoidal thread about z from z = 0, a ``manifold3d.Manifold``.

    A cut across a one-start thread is a polar curve that turns once a pitch. Two rods whose radii
    differ by c are c apart along the radius everywhere: each cut is the other one's moved out by c.

    Args:
        radius: Outer, meters.
        depth: Of the thread, meters.
        pitch: Meters a turn.
        length: Meters.
        segments: Edges of a turn.
        sections: Cuts a pitch.

    Raises:
        MissingExtraError: manifold3d is not installed.
    """
    solids = import_manifold()
    angles = np.linspace(0.0, 2.0 * np.pi, segments, endpoint=False)
    wave = np.clip(2.0 * np.abs(angles / np.pi - 1.0) - 0.5, 0.0, 1.0)
    radii = radius - depth * (1.0 - wave)
    section = solids.CrossSection(
        [np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])]
    )
    turns = length / pitch
    return solids.Manifold.extrude(
        section,
        length,
        n_divisions=round(sections * turns),
        twist_degrees=_DEGREES_A_TURN * turns,
    )


def make_bolt(
    radius: float,
    depth: float,
    pitch: float,
    length: float,
    head: float,
    segments: int,
    sections: int,
) -> Any:
    """A rod from z = 0 up on a hexagonal head below, whose height is ``head``, meters."""
    solids = import_manifold()
    below = solids.Manifold.cylinder(1.02 * head, 1.7 * radius, circular_segments=6)
    rod = make_rod(radius, depth, pitch, length, segments, sections)
    return rod + below.translate((0.0, 0.0, -head))


def make_nut(
    radius: float,
    depth: float,
    pitch: float,
    height: float,
    clearance: float,
    segments: int,
    sections: int,
) -> Any:
    """The nut of the bolt with the same numbers, ``clearance`` from its thread along the radius.

    From z = 0 up; it fits a bolt in the same pose, and at whole turns along its screw.
    """
    solids = import_manifold()
    hexagon = solids.Manifold.cylinder(height, 1.7 * radius, circular_segments=6)
    # The cutter starts a pitch lower, in the same phase, so that its ends are outside the nut.
    cutter = make_rod(radius + clearance, depth, pitch, height + 2.0 * pitch, segments, sections)
    return hexagon - cutter.translate((0.0, 0.0, -pitch))


@cache
def _build_models(settings: BoltSettings) -> tuple[Model, Model]:
    thread = (settings.radius, settings.depth, settings.pitch)
    corners = (settings.segments, settings.sections)
    bolt = make_bolt(*thread, settings.length, settings.head, *corners)
    nut = make_nut(*thread, settings.height, settings.clearance, *corners)
    return _build(bolt, settings.voxel_size), _build(nut, settings.voxel_size)


def _build(solid: Any, voxel_size: float) -> Model:
    return Model.from_mesh(as_mesh(solid), voxel_size=voxel_size, point_spacing=2.0 * voxel_size)
