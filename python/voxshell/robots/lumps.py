"""Lumps: links that fixed joints join to one body."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.robots.description import RobotDescription


@dataclass(eq=False)
class Lump:
    """Links that move as one body, whose frame is that of the first link."""

    links: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    """Poses ``lump_from_link`` by name."""

    @property
    def first(self) -> str:
        """The link nearest to the root."""
        return next(iter(self.links))


def find_lumps(robot: RobotDescription) -> dict[str, Lump]:
    """Return the lump of each link, by the link's name."""
    lumps = {root: Lump({root: np.eye(4)}) for root in robot.roots}
    for joint in robot.joints:
        if joint.type == "fixed":
            lump = lumps[joint.parent]
            lump.links[joint.child] = lump.links[joint.parent] @ joint.parent_from_child
        else:
            lump = Lump({joint.child: np.eye(4)})
        lumps[joint.child] = lump
    return lumps
