"""Arrows for the normal forces of contacts, as long as the forces are large."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from voxshell.recording import Recording

LONGEST_ARROW, ARROW_SHAFT = 0.6, 0.008
"""Length of the longest arrow of a recording, and radius of all shafts, in diameters of a typical body."""

_LEAST_FRACTION = 2.5e-4
"""Of the force of the longest arrow: smaller forces have none."""
_FULL_FORCE_QUANTILE = 0.98
"""The blow of one landing should not shorten all other arrows."""


def full_force(recordings: Sequence[Recording]) -> float:
    """The force, newtons, of the longest arrow: about the largest of all; 0 without forces.

    Rounded up to 1, 2 or 5 times a power of ten, because it is written in the legend.
    """
    sizes = np.concatenate([np.linalg.norm(one.contacts.forces, axis=1) for one in recordings])
    sizes = sizes[sizes > 0.0]
    if len(sizes) == 0:
        return 0.0
    large = float(np.quantile(sizes, _FULL_FORCE_QUANTILE))
    power = 10.0 ** math.floor(math.log10(large))
    return power * next(
        step for step in (1.0, 2.0, 5.0, 10.0) if step * power >= large * (1 - 1e-9)
    )


def find_arrows(
    points: NDArray[np.float64],
    forces: NDArray[np.float64],
    *,
    strongest: float,
    longest: float,
    limit: int,
) -> NDArray[np.float64]:
    """The arrows of one frame, (k, 2, 3): each from its contact in the direction of its force.

    Args:
        points: (n, 3) of the contacts.
        forces: (n, 3) newtons.
        strongest: Newtons above which arrows no longer grow.
        longest: Their length then, in the unit of ``points``.
        limit: Arrows at most, those of the largest forces.
    """
    sizes = np.linalg.norm(forces, axis=1)
    chosen = np.argsort(-sizes, kind="stable")[:limit]
    chosen = np.sort(chosen[sizes[chosen] > _LEAST_FRACTION * strongest])
    lengths = np.minimum(sizes[chosen] / max(strongest, 1e-300), 1.0) * longest
    directions = forces[chosen] / np.maximum(sizes[chosen], 1e-300)[:, None]
    return np.stack([points[chosen], points[chosen] + lengths[:, None] * directions], axis=1)
