"""How exact a model is, measured on its surface when it was built."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from voxshell._core import Model as CoreModel


class AccuracyWarning(UserWarning):
    """A model is off by more than its tolerance, or two bodies may miss contacts that are deep."""


@dataclass(frozen=True)
class ErrorStatistic:
    """The absolute errors at many places of a surface.

    Attributes:
        median: Half of the places have at most this error.
        p99: 99 % of the places have at most this error.
        max: The largest error at any of the places that were looked at.
    """

    median: float
    p99: float
    max: float


@dataclass(frozen=True)
class Accuracy:
    """How exact a model is, measured at 100,000 places of its surface when it was built.

    The places lie on faces, by area, along edges and at vertices; half of those along edges are on
    sharp edges, if there are any. This is a statistic, not a proof: for what holds everywhere, see
    :func:`contact_bounds`.

    Attributes:
        places: How many places were looked at.
        distance: Error of the field's distance, which is 0 on the surface; metres.
        normal: Angle from the field's gradient, just inside of the surface, to the cone of the
            normals of the nearest faces; radians. pi where the gradient is 0.
        coverage: How far the surface stands out above the nearest elements of the shell, along its
            own normal; metres. A flat body may get this deep without being seen by the shell.
        gap: Largest distance of any place from the nearest element of the shell that does not face
            away from it; metres. A body that is sharper than this may enter between elements.
        is_sharp: Whether faces meet at a convex edge by more than 20 degrees.
        curvature: Largest convex curvature elsewhere, from the angles between faces; 1/metres.

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
            return "/".join(f"{1e3 * x:.3g}" for x in (errors.median, errors.p99, errors.max))

        degrees = "/".join(
            f"{math.degrees(x):.3g}" for x in (self.normal.median, self.normal.p99, self.normal.max)
        )
        shape = "sharp" if self.is_sharp else f"rounded by {self.curvature:.3g} /m"
        return (
            f"Accuracy(median/99 %/max at {self.places:,} places: distance {lengths(self.distance)} "
            f"mm, normal {degrees} degrees, coverage {lengths(self.coverage)} mm; "
            f"gap {1e3 * self.gap:.3g} mm, {shape})"
        )


def read_accuracy(core: CoreModel) -> Accuracy:
    """The accuracy that a model of the core holds."""
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
