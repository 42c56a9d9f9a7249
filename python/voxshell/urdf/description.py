"""What a URDF file says of a robot, as data: links, joints, and where each link is."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, NoReturn, TypeAlias

import numpy as np

from voxshell.errors import RobotError

if TYPE_CHECKING:
    from numpy.typing import NDArray


JointType: TypeAlias = Literal[
    "fixed", "revolute", "continuous", "prismatic", "floating", "spherical"
]

Color: TypeAlias = tuple[int, int, int]
"""Red, green and blue, 0 to 255."""


@dataclass(frozen=True)
class MeshFile:
    """A mesh by the path that it was found at, and its scale along x, y and z."""

    path: str
    scale: tuple[float, float, float]


@dataclass(frozen=True)
class Primitive:
    """A box (edges), sphere (radius), cylinder or capsule (radius, length without caps), metres."""

    kind: Literal["box", "sphere", "cylinder", "capsule"]
    sizes: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Collision:
    """A part of a link's surface, in its place."""

    geometry: MeshFile | Primitive
    link_from_geometry: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Inertial:
    """What a file says about a link's matter.

    Attributes:
        mass: Kilograms, above 0.
        center: (3,) float64, metres, link frame.
        inertia: (3, 3) float64, kg m2, about the center, along the link's axes; None where the file gives
            none, zeros, or what is not positive definite.
    """

    mass: float
    center: NDArray[np.float64]
    inertia: NDArray[np.float64] | None


@dataclass(frozen=True, eq=False)
class LinkDescription:
    """A link; ``inertial`` is None where the file gives no mass, or 0."""

    name: str
    line: int
    collisions: tuple[Collision, ...]
    inertial: Inertial | None
    color: Color | None


@dataclass(frozen=True, eq=False)
class JointDescription:
    """A joint; effort and velocity are None where the file gives none, or 0."""

    name: str
    line: int
    type: JointType
    parent: str
    child: str
    parent_from_joint: NDArray[np.float64]
    axis: tuple[float, float, float]
    limits: tuple[float, float] | None
    effort: float | None
    velocity: float | None
    friction: float
    damping: float
    mimic: tuple[str, float, float] | None
    """Name of the leader, multiplier, offset."""


@dataclass(frozen=True, eq=False)
class RobotDescription:
    """A tree of links; joints come before those of their children."""

    path: str
    name: str
    root: str
    links: dict[str, LinkDescription]
    joints: list[JointDescription] = field(default_factory=list)
    without_limits: list[str] = field(default_factory=list)
    """Joints that need limits, and have none in the file."""

    def refuse(self, what: str, at: LinkDescription | JointDescription | None = None) -> NoReturn:
        """Raises a :class:`RobotError` that names the file, and the line of what is wrong."""
        where = self.path if at is None else f"{self.path}:{at.line}"
        raise RobotError(f"{where}: {what}")
