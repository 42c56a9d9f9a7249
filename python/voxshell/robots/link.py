"""Links of a robot in a world."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell.robots.kinematics import Twist

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.simulation.body import Body


@dataclass(frozen=True, eq=False)
class Link:
    """A link of a robot. Links that fixed joints hold together are one body.

    Attributes:
        name: As in the file.
        body: The body that it is part of; None if it is fixed to the world and has no surface.
        body_from_link: (4, 4) float64; without a body, ``world_from_link``.
        color: Red, green and blue, 0 to 255, of its first visual; None if the file states none.
    """

    name: str
    body: Body | None
    body_from_link: NDArray[np.float64]
    color: tuple[int, int, int] | None

    def __repr__(self) -> str:
        place = "fixed to the world" if self.body is None else f"part of {self.body!r}"
        return f"Link({self.name!r}, {place})"

    @property
    def pose(self) -> NDArray[np.float64]:
        """``world_from_link``, (4, 4) float64."""
        return self.body_from_link if self.body is None else self.body.pose @ self.body_from_link


def find_twist(link: Link) -> Twist:
    """Return the present motion of a link."""
    if link.body is None:
        return Twist(np.zeros(3), np.zeros(3))
    return Twist(link.body.angular_velocity, link.body.velocity_at((0.0, 0.0, 0.0)))
