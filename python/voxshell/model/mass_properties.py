"""Mass, center of mass and inertia of a body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class MassProperties:
    """Mass, center of mass and inertia of a body, in the frame of its mesh.

    Attributes:
        mass: Kilograms.
        center_of_mass: (3,) float64, meters.
        inertia: (3, 3) float64, kg m2, symmetric, about the center of mass.
    """

    mass: float
    center_of_mass: NDArray[np.float64]
    inertia: NDArray[np.float64]
