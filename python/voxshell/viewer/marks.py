"""The contacts of a recording as videos and files for other programs show them.

Contacts are balls in the colors of their depths; normal forces on the moving body are arrows.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell.viewer.arrows import LONGEST_ARROW, find_arrows, full_force
from voxshell.viewer.lanes import Lane
from voxshell.viewer.pins import color_depths, full_depth
from voxshell.viewer.stage import plan_stage

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.recording import Recording

_BALL = 0.012
"""Radius of a contact's ball, in diameters of a typical body."""


@dataclass(frozen=True, eq=False)
class Marks:
    """The contacts of one frame.

    Args:
        points: (k, 3) meters, world frame; the centers of the balls.
        fractions: (k,) depths as fractions of that with the darkest color; above 1 for a few.
        arrows: (m, 2, 3) meters; start and tip of each.
    """

    points: NDArray[np.float64]
    fractions: NDArray[np.float64]
    arrows: NDArray[np.float64]

    @property
    def colors(self) -> NDArray[np.float64]:
        """(k, 3) sRGB, 0 to 255, of the balls."""
        return color_depths(self.fractions)


class MarkedContacts:
    """The contacts of all frames.

    Args:
        recording: The recording.
        up: The world axis that points up.
        limit: Balls, and arrows, of a frame at most.
    """

    def __init__(self, recording: Recording, *, up: str, limit: int) -> None:
        self._contacts, self._limit = recording.contacts, limit
        self.body_size: float = plan_stage([Lane("", recording)], up=up).body_size
        self.ball: float = _BALL * self.body_size
        """Radius of a ball, meters."""
        self.deepest: float = full_depth([recording], self.body_size)
        """Depth with the darkest color, meters; 0 if nothing overlaps."""
        self.strongest: float = full_force([recording])
        """Force of the longest arrow, newtons; 0 without forces."""

    def frame(self, number: int) -> Marks:
        """The contacts of a frame; of more than the limit, an even sample."""
        contacts = self._contacts.frame(number)
        chosen = np.arange(len(contacts.points))
        if len(chosen) > self._limit:
            chosen = np.linspace(0, len(chosen) - 1, self._limit).round().astype(np.int64)
        fractions = (
            contacts.depths[chosen] / self.deepest if self.deepest else np.zeros(len(chosen))
        )
        arrows = np.zeros((0, 2, 3))
        if self.strongest > 0.0:
            arrows = find_arrows(
                contacts.points,
                contacts.forces,
                strongest=self.strongest,
                longest=LONGEST_ARROW * self.body_size,
                limit=self._limit,
            )
        return Marks(contacts.points[chosen], fractions, arrows)
