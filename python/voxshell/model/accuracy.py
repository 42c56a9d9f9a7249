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
        distance, normal, coverage = ("/".join(column) for column in self._list_errors())
        return (
            f"Accuracy(median/99 %/max at {self.places:,} places: distance {distance} "
            f"mm, normal {normal} degrees, coverage {coverage} mm; "
            f"gap {in_millimeters(self.gap)} mm, {self._shape})"
        )

    def __str__(self) -> str:
        distance, normal, coverage = (
            f"median {median}, 99 % below {most}, largest {largest}"
            for median, most, largest in self._list_errors()
        )
        edges = "; large ones are usual at edges, where normals jump"
        return (
            f"Errors at {self.places:,} places of the surface:\n"
            f"distance: {distance} mm\n"
            f"normal: {normal} degrees{edges if self.is_sharp else ''}\n"
            f"coverage, the height of the surface above the points of the shell: {coverage} mm\n"
            f"gap {in_millimeters(self.gap)} mm, {self._shape}"
        )

    def _list_errors(self) -> tuple[tuple[str, str, str], ...]:
        """Return median, 99 % and maximum of distances in mm, normals in degrees, and coverage in mm."""

        def lengths(errors: ErrorStatistic) -> tuple[str, str, str]:
            return (
                in_millimeters(errors.median),
                in_millimeters(errors.p99),
                in_millimeters(errors.max),
            )

        def degrees(angle: float) -> str:  # below a thousandth, it is rounding
            return f"{round(math.degrees(angle), 3):.3g}"

        normal = self.normal
        angles = degrees(normal.median), degrees(normal.p99), degrees(normal.max)
        return lengths(self.distance), angles, lengths(self.coverage)

    @property
    def _shape(self) -> str:
        return "sharp" if self.is_sharp else f"rounded by {self.curvature:.3g} /m"


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
