"""Masses and inertias of a robot's links, completed where the file leaves them out."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from voxshell.base.arguments import FARTHEST
from voxshell.errors import MissingExtraError
from voxshell.model.mass_properties import MassProperties
from voxshell.robots.description import Primitive
from voxshell.robots.mesh_files import read_link_mesh
from voxshell.robots.solids import add_up, weigh_primitive

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from voxshell.robots.description import Collision, RobotDescription
    from voxshell.robots.lumps import Lump

DENSITY = 1000.0
"""Of links without a mass, kg/m3: that of water, between the 300 of a robot's whole arm, which is mostly
empty, and the 2700 of aluminum."""

GHOST_MASS = 0.1
"""Of what moves and has neither a mass nor a shape, kilograms. Far less than its neighbors' would make
Bullet's solver converge slowly; far more would change how the robot moves."""


@dataclass(eq=False)
class Matter:
    """What the bodies of a robot weigh.

    Attributes:
        of_lumps: In the lump's frame; without those that are fixed to the world.
        without_mass: Links that were given a mass of their collision geometry at :data:`DENSITY`.
        without_shape: Links that were given :data:`GHOST_MASS`.
        without_inertia: Links whose inertia was computed from their mass and collision geometry.
    """

    of_lumps: dict[Lump, MassProperties] = field(default_factory=dict)
    without_mass: list[str] = field(default_factory=list)
    without_shape: list[str] = field(default_factory=list)
    without_inertia: list[str] = field(default_factory=list)


def complete_matter(robot: RobotDescription, lumps: Iterable[Lump]) -> Matter:
    """Adds up the matter of each lump's links, and completes it where the file leaves it out.

    A link with a mass and without a valid inertia gets that of the convex hulls of its collision geometry
    at its mass. Where no link of a lump has a mass, each gets that of its hulls at :data:`DENSITY`.

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
            inertia = inertial.inertia
            if inertia is None:
                solid = _weigh(robot, name)
                inertia = np.zeros((3, 3))
                if solid is not None:
                    inertia = solid.inertia * (inertial.mass / solid.mass)
                    matter.without_inertia.append(name)
            parts.append(
                (MassProperties(inertial.mass, inertial.center, inertia), lump.links[name])
            )
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
            # Points in a line.
            ball = np.eye(3) * _moment_of_ball(whole.mass)
            whole = MassProperties(whole.mass, whole.center_of_mass, whole.inertia + ball)
            if weighed:
                matter.without_inertia.append(weighed[0])
        matter.of_lumps[lump] = whole
    return matter


def _moment_of_ball(mass: float) -> float:
    """Of a solid ball of :data:`DENSITY`, kg m2."""
    radius = (3.0 * mass / (4.0 * math.pi * DENSITY)) ** (1.0 / 3.0)
    return 0.4 * mass * radius**2


def _weigh(robot: RobotDescription, link: str) -> MassProperties | None:
    """Of a link's collision geometry at :data:`DENSITY`, link frame; None where it has no volume."""
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
    vertices, _ = read_link_mesh(robot.links[link].owner, collision.geometry)
    if np.abs(vertices).max(initial=0.0) > FARTHEST:
        return None  # which no shape takes, either
    try:
        hull = convex_hull(vertices)
    except ImportError as error:
        raise MissingExtraError(
            f"{robot.path}: the mass or inertia of link {link!r} is computed from a convex hull, which "
            f"needs scipy ({error}); run: pip install 'voxshell[urdf]'"
        ) from error
    except Exception:  # of any kind, where the points lie in a plane
        return None
    if not (hull.volume > 0.0 and np.linalg.eigvalsh(hull.moment_inertia)[0] > 0.0):
        return None
    return MassProperties(
        DENSITY * float(hull.volume),
        np.asarray(hull.center_mass),
        DENSITY * np.asarray(hull.moment_inertia),
    )
