"""Inertias of links that are too large for their collision geometry."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from voxshell.robots.description import Primitive
from voxshell.robots.link_meshes import read_link_mesh
from voxshell.robots.solids import bound_moments

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from voxshell.robots.description import LinkDescription, RobotDescription
    from voxshell.robots.lumps import Lump

_MOST_REACHES = 5.0
"""Radius of gyration above which an inertia is doubted, in distances from the center of mass to the
farthest point of the collision geometry. Matter inside of the geometry has at most 1; links of real robots
with simplified collision geometry or rough numbers have up to 5, and placeholders such as 1 kg m2 more."""


def find_large_inertias(robot: RobotDescription, lumps: Iterable[Lump]) -> dict[str, float]:
    """Return the links whose inertia in the file is far beyond that of any body of their size.

    Args:
        robot: The robot.
        lumps: Those whose inertia counts.

    Returns:
        By the names of links, the largest moment divided by mass times reach squared, which matter
        inside of the collision geometry does not exceed.

    Raises:
        RobotError: A mesh cannot be read.
    """
    found = {}
    for name in (name for lump in lumps for name in lump.links):
        link = robot.links[name]
        inertial = link.inertial
        if inertial is None or inertial.inertia is None:
            continue
        moment = float(np.linalg.eigvalsh(bound_moments(inertial.inertia))[2])
        reach = find_reach(link, inertial.center)
        most = inertial.mass * reach * reach  # ** raises OverflowError
        if most > 0.0 and moment > _MOST_REACHES**2 * most:
            found[name] = moment / most
    return found


def find_reach(link: LinkDescription, center: NDArray[np.float64]) -> float:
    """Return the distance to the farthest point of a link's collision geometry, meters.

    It is exact for boxes, balls, capsules and meshes, and an upper bound for other shapes; 0 without
    geometry, and infinity with a plane.

    Args:
        link: The link.
        center: The point from which distances count, (3,) meters, link frame.

    Raises:
        RobotError: A mesh cannot be read.
    """
    farthest = 0.0
    for collision in link.collisions:
        geometry, place = collision.geometry, collision.link_from_geometry
        if isinstance(geometry, Primitive):
            points, margin = _find_extremes(geometry)
        else:
            points, margin = read_link_mesh(link.owner, geometry).vertices, 0.0
        placed = points @ place[:3, :3].T + place[:3, 3] - center
        farthest = max(farthest, float(np.linalg.norm(placed, axis=1).max(initial=0.0)) + margin)
    return farthest


def _find_extremes(geometry: Primitive) -> tuple[NDArray[np.float64], float]:
    """Return points, (n, 3) in the geometry's frame, whose hull holds the shape with a margin; meters."""
    sizes = geometry.sizes
    match geometry.kind:
        case "plane":
            return np.zeros((1, 3)), np.inf
        case "sphere":
            return np.zeros((1, 3)), sizes[0]
        case "capsule":
            return np.array([(0.0, 0.0, -0.5), (0.0, 0.0, 0.5)]) * sizes[1], sizes[0]
        case "cylinder":
            halves = (sizes[0], sizes[0], sizes[1] / 2.0)
        case "box":
            halves = (sizes[0] / 2.0, sizes[1] / 2.0, sizes[2] / 2.0)
        case "ellipsoid":
            halves = (sizes[0], sizes[1], sizes[2])
    return np.array(list(product((-1.0, 1.0), repeat=3))) * halves, 0.0
