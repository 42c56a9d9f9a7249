"""Accuracy of a model, measured on its surface when it is built."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from voxshell.base.lengths import in_millimeters

if TYPE_CHECKING:
    from voxshell._core import Model as CoreModel


class AccuracyWarning(UserWarning):
    """A model's error exceeds its tolerance, or two bodies may miss deep contacts."""


@dataclass(frozen=True)
class ErrorStatistic:
    """Absolute errors at many places on a surface.

    Attributes:
        median: Half of the places have at most this error.
        p99: 99 % of the places have at most this error.
        max: The largest error of all places.
    """

    median: float
    p99: float
    max: float


@dataclass(frozen=True)
class Accuracy:
    """Accuracy of a model, measured at 100,000 places on its surface when it was built.

    The places lie on faces (in proportion to their area), along edges and at vertices. Half of
    those along edges are on sharp edges, if there are any. This is a statistic, not a proof. For
    proven bounds see :func:`contact_bounds`.

    Attributes:
        places: Number of places.
        distance: Error of the field's distance, which should be 0 on the surface; meters.
        normal: Angle between the field's gradient just inside the surface and the cone of the
            normals of the nearest faces; radians. It is pi where the gradient is 0.
        coverage: How far the surface rises along its own normal above the nearest points and edge
            segments of the shell; meters. The shell may miss a flat body that overlaps by less.
        gap: Largest distance of any place from the nearest point or edge segment of the shell that
            does not face away from it; meters. A body that is narrower than this may slip between
            them.
        is_sharp: True if faces meet at a convex edge by more than 20 degrees.
        curvature: Largest convex curvature elsewhere, from the angles between faces; 1/meters.

    Example:
        >>> import trimesh
        >>> import voxshell as vx
        >>> ball = trimesh.creation.icosphere(radius=0.1, subdivisions=4)
        >>> accuracy = vx.Model.from_mesh(ball, resolution=50).accuracy
        >>> accuracy.places >= 100_000
        True
        >>> accuracy.distance.median < accuracy.distance.p99 < accuracy.distance.max < 0.001
        True
        >>> accuracy.is_sharp
        False
    """

    places: int
    distance: ErrorStatistic
    normal: ErrorStatistic
    coverage: ErrorStatistic
    gap: float
    is_sharp: bool
    curvature: float

    def __repr__(self) -> str:
        def lengths(errors: ErrorStatistic) -> str:
            return "/".join(map(in_millimeters, (errors.median, errors.p99, errors.max)))

        # Below a thousandth of a degree, angles are rounding.
        degrees = "/".join(
            f"{round(math.degrees(x), 3):.3g}"
            for x in (self.normal.median, self.normal.p99, self.normal.max)
        )
        shape = "sharp" if self.is_sharp else f"rounded by {self.curvature:.3g} /m"
        return (
            f"Accuracy(median/99 %/max at {self.places:,} places: distance {lengths(self.distance)} "
            f"mm, normal {degrees} degrees, coverage {lengths(self.coverage)} mm; "
            f"gap {in_millimeters(self.gap)} mm, {shape})"
        )


def read_accuracy(core: CoreModel) -> Accuracy:
    """Return the accuracy of a model of the core."""
    places, distance, normal, coverage, gap, is_sharp, curvature = core.accuracy
    return Accuracy(
        places,
        ErrorStatistic(*distance),
        ErrorStatistic(*normal),
        ErrorStatistic(*coverage),
        gap,
        is_sharp,
        curvature,
    )
