"""What a file says of robots, as data: links, joints, and where each link is."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, NoReturn, TypeAlias

import numpy as np

from voxshell.errors import RobotError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from voxshell.model.meshes import Mesh


JointType: TypeAlias = Literal[
    "fixed", "revolute", "continuous", "prismatic", "floating", "spherical"
]

MOST_LINKS = 1000
"""Of a file; each two of them are kept apart, which takes time that grows as their square."""

Color: TypeAlias = tuple[int, int, int]
"""Red, green and blue, 0 to 255."""


Affine: TypeAlias = tuple[tuple[float, float, float, float], ...]
"""Three rows of a matrix."""


@dataclass(frozen=True)
class MeshFile:
    """A mesh by the path that it was found at, and what moves and scales its points."""

    path: str
    geometry_from_file: Affine


@dataclass(frozen=True, eq=False)
class MeshArrays:
    """A mesh that the robot's file holds itself, under a name for errors."""

    path: str
    mesh: Mesh


@dataclass(frozen=True)
class Primitive:
    """A shape of a formula.

    Attributes:
        kind: What it is; a plane, at z = 0, has no end and cannot move.
        sizes: Metres: of a box its edges, of a sphere the radius, of a cylinder or capsule the radius and
            the length without caps, of an ellipsoid three radii, of a plane none.
    """

    kind: Literal["box", "sphere", "cylinder", "capsule", "ellipsoid", "plane"]
    sizes: tuple[float, ...]


Geometry: TypeAlias = MeshFile | MeshArrays | Primitive


@dataclass(frozen=True, eq=False)
class Collision:
    """A part of a link's surface, in its place."""

    geometry: Geometry
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
    """A link.

    Attributes:
        name: As in the file.
        where: File and line, for errors.
        collisions: Its surface.
        inertial: None where the file gives no mass, or 0.
        color: Of its first visual.
        friction: Of its surface; None where the format has no frictions.
    """

    name: str
    where: str
    collisions: tuple[Collision, ...]
    inertial: Inertial | None
    color: Color | None
    friction: float | None = None

    @property
    def owner(self) -> str:
        """What errors begin with: "robot.urdf:7: link 'arm'"."""
        return f"{self.where}: link {self.name!r}"


@dataclass(frozen=True, eq=False)
class JointDescription:
    """A joint; effort and velocity are None where the file gives none, or 0.

    Attributes:
        parent_from_child: (4, 4) float64, as the file has the links.
        child_from_joint: (4, 4) float64.
        position: At which the file has the links.
        start: At which the joint begins in a world.
        mimic: Name of the leader, multiplier, offset.
    """

    name: str
    where: str
    type: JointType
    parent: str
    child: str
    parent_from_child: NDArray[np.float64]
    child_from_joint: NDArray[np.float64]
    position: float = 0.0
    start: float = 0.0
    axis: tuple[float, float, float] = (1.0, 0.0, 0.0)
    limits: tuple[float, float] | None = None
    effort: float | None = None
    velocity: float | None = None
    friction: float = 0.0
    damping: float = 0.0
    mimic: tuple[str, float, float] | None = None


@dataclass(frozen=True, eq=False)
class RobotDescription:
    """Trees of links.

    Attributes:
        path: Of the file.
        name: As in the file.
        roots: Links that no joint moves, with their ``file_from_link``.
        links: All, by name.
        joints: Each before those of its child.
        without_limits: Joints that need limits, and have none in the file.
        left_out: What the file holds and a world does not simulate.
    """

    path: str
    name: str
    roots: dict[str, NDArray[np.float64]]
    links: dict[str, LinkDescription]
    joints: list[JointDescription] = field(default_factory=list)
    without_limits: list[str] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)

    def refuse(self, what: str, at: LinkDescription | JointDescription | None = None) -> NoReturn:
        """Raises a :class:`RobotError` that names the file, and the line of what is wrong."""
        raise RobotError(f"{self.path if at is None else at.where}: {what}")


def shorten_names(names: Sequence[str]) -> str:
    """The first ten, quoted."""
    shown = ", ".join(map(repr, names[:10]))
    return f"{shown}, ..." if len(names) > 10 else shown
