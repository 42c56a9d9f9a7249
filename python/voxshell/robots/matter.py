"""Masses and inertias of a robot's links, completed if the file lacks them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from voxshell.base.arguments import FARTHEST
from voxshell.base.extras import explain_import
from voxshell.model.mass_properties import MassProperties
from voxshell.robots.description import Primitive
from voxshell.robots.link_meshes import read_link_mesh
from voxshell.robots.sheets import find_sheet
from voxshell.robots.solids import add_up, bound_moments, weigh_primitive

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from voxshell.robots.description import Collision, Inertial, RobotDescription
    from voxshell.robots.lumps import Lump

DENSITY = 1000.0
"""Density of links without a mass, kg/m3. That of water is between the 300 of a robot's arm, which
is mostly empty, and the 2700 of aluminum."""

GHOST_MASS = 0.1
"""Mass of moving links with neither a mass nor a shape, kilograms. A mass far below that of its
neighbors would make Bullet's solver converge slowly; a far larger one would change the robot's
motion."""


_ROUNDING = 0.01
"""Part of an inertia that may be the rounding of the numbers in a file."""


@dataclass(eq=False)
class Matter:
    """Mass properties of a robot's bodies.

    Attributes:
        of_lumps: Mass properties in the lump's frame, except of lumps that are fixed to the world.
        without_mass: Links that got a mass from their collision geometry at :data:`DENSITY`.
        without_shape: Links that got :data:`GHOST_MASS`.
        without_inertia: Links whose inertia was computed from their mass and collision geometry.
        with_bounded_inertia: Links whose inertia is that of no body, by more than rounding.
        with_large_inertia: Links whose inertia is far beyond that of a body of their size, and how many
            times it exceeds the largest of those.
    """

    of_lumps: dict[Lump, MassProperties] = field(default_factory=dict)
    without_mass: list[str] = field(default_factory=list)
    without_shape: list[str] = field(default_factory=list)
    without_inertia: list[str] = field(default_factory=list)
    with_bounded_inertia: list[str] = field(default_factory=list)
    with_large_inertia: dict[str, float] = field(default_factory=dict)


def complete_matter(
    robot: RobotDescription, lumps: Iterable[Lump], *, inertia: Literal["file", "shape"] = "file"
) -> Matter:
    """Add up the mass properties of each lump's links, and complete them if the file lacks them.

    A link with a mass but without a valid inertia gets that of the convex hulls of its collision
    geometry with its mass. An inertia that no body has is reduced. If no link of a lump has a mass, each link gets that of its hulls at
    :data:`DENSITY`.

    Args:
        robot: The robot.
        lumps: Those that move.
        inertia: "shape" gives the inertia of their hulls to all links with collision geometry.

    Raises:
        RobotError: A mesh cannot be read.
        MissingExtraError: A hull is needed, and scipy is not installed.
    """
    matter = Matter()
    for lump in lumps:
        parts: list[tuple[MassProperties, NDArray[np.float64]]] = []
        weighed = [name for name in lump.links if robot.links[name].inertial is not None]
        for name in weighed:
            inertial = robot.links[name].inertial
            assert inertial is not None
            tensor = _complete_inertia(robot, name, inertial, matter, from_shape=inertia == "shape")
            own = MassProperties(inertial.mass, inertial.center, tensor)
            parts.append((own, lump.links[name]))
        if not weighed:
            for name, lump_from_link in lump.links.items():
                solid = _weigh(robot, name)
                if solid is not None:
                    parts.append((solid, lump_from_link))
                    matter.without_mass.append(name)
        if not parts:
            parts.append((MassProperties(GHOST_MASS, np.zeros(3), np.zeros((3, 3))), np.eye(4)))
            matter.without_shape.append(lump.first)
        whole = add_up(parts)
        if not np.linalg.eigvalsh(whole.inertia)[0] > 0.0:
            # All points are on a line.
            ball = np.eye(3) * _moment_of_ball(whole.mass)
            whole = MassProperties(whole.mass, whole.center_of_mass, whole.inertia + ball)
            if weighed:
                matter.without_inertia.append(weighed[0])
        matter.of_lumps[lump] = whole
    return matter


def _complete_inertia(
    robot: RobotDescription, link: str, inertial: Inertial, matter: Matter, *, from_shape: bool
) -> NDArray[np.float64]:
    """Return the inertia of a link with a mass, kg m2 about its center; 0 if nothing tells it."""
    given = inertial.inertia
    if given is None or from_shape:
        solid = _weigh(robot, link)
        if solid is not None:
            if given is None:
                matter.without_inertia.append(link)
            return solid.inertia * (inertial.mass / solid.mass)
        if given is None:
            return np.zeros((3, 3))
    tensor = bound_moments(given)
    if np.trace(tensor) < (1.0 - _ROUNDING) * np.trace(given):
        matter.with_bounded_inertia.append(link)
    return tensor


def _moment_of_ball(mass: float) -> float:
    """Return the moment of inertia of a solid ball of :data:`DENSITY`, kg m2."""
    radius = (3.0 * mass / (4.0 * math.pi * DENSITY)) ** (1.0 / 3.0)
    return 0.4 * mass * radius**2


def _weigh(robot: RobotDescription, link: str) -> MassProperties | None:
    """Return a link's collision geometry at :data:`DENSITY`, link frame; None without a volume."""
    parts = []
    for collision in robot.links[link].collisions:
        solid = _weigh_collision(robot, link, collision)
        if solid is not None:
            parts.append((solid, collision.link_from_geometry))
    return add_up(parts) if parts else None


def _weigh_collision(
    robot: RobotDescription, link: str, collision: Collision
) -> MassProperties | None:
    from trimesh.convex import convex_hull

    if isinstance(collision.geometry, Primitive):
        solid = weigh_primitive(collision.geometry, DENSITY)
        return solid if solid.mass > 0.0 else None
    mesh = read_link_mesh(robot.links[link].owner, collision.geometry)
    sheet = find_sheet(mesh)
    vertices = mesh.vertices if sheet is None else sheet.find_points()
    if np.abs(vertices).max(initial=0.0) > FARTHEST:
        return None  # no shape can be made of it, either
    try:
        hull = convex_hull(vertices)
    except ImportError as error:
        raise explain_import(
            error,
            f"{robot.path}: the mass or inertia of link {link!r} is computed from a convex hull, which "
            f"needs scipy ({error}); run: pip install 'voxshell[urdf]'",
        ) from error
    except Exception:  # scipy raises several types if the points are in a plane
        return None
    if not (hull.volume > 0.0 and np.linalg.eigvalsh(hull.moment_inertia)[0] > 0.0):
        return None
    return MassProperties(
        DENSITY * float(hull.volume),
        np.asarray(hull.center_mass),
        DENSITY * np.asarray(hull.moment_inertia),
    )
