"""Descriptions of robots as data: links, joints, and the place of each link."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, NoReturn, TypeAlias

import numpy as np

from voxshell.base.arguments import show_value
from voxshell.errors import RobotError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from voxshell.model.build_warnings import Finding
    from voxshell.model.meshes import Mesh


JointType: TypeAlias = Literal[
    "fixed", "revolute", "continuous", "prismatic", "floating", "spherical"
]

MOST_LINKS = 1000
"""Largest number of links. Every pair of links is considered, so time grows with the square."""

MIMIC_EFFORT = 1000.0
"""Effort of a joint that follows another if the file states none for either, newtons or newton
meters. It exceeds what robots' joints can exert, so the joint follows like a gear."""

Color: TypeAlias = tuple[int, int, int]
"""Red, green and blue, 0 to 255."""


Affine: TypeAlias = tuple[tuple[float, float, float, float], ...]
"""The upper three rows of a 4x4 matrix."""


@dataclass(frozen=True)
class MeshFile:
    """A mesh file that was found.

    Attributes:
        path: Its path.
        geometry_from_file: The transform and scale of its points.
        has_scale: True if the robot's file states the scale.
    """

    path: str
    geometry_from_file: Affine
    has_scale: bool


@dataclass(frozen=True, eq=False)
class MeshArrays:
    """A mesh that the robot's file contains, with a name for error messages."""

    path: str
    mesh: Mesh


@dataclass(frozen=True)
class Primitive:
    """An analytic shape.

    Attributes:
        kind: The shape. A plane, at z = 0, is unbounded and cannot move.
        sizes: Meters: edge lengths of a box; radius of a sphere; radius and length, without caps,
            of a cylinder or capsule; three radii of an ellipsoid; nothing for a plane.
    """

    kind: Literal["box", "sphere", "cylinder", "capsule", "ellipsoid", "plane"]
    sizes: tuple[float, ...]


Geometry: TypeAlias = MeshFile | MeshArrays | Primitive


@dataclass(frozen=True, eq=False)
class Collision:
    """A part of a link's surface, with its place."""

    geometry: Geometry
    link_from_geometry: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Inertial:
    """Mass properties that a file states for a link.

    Attributes:
        mass: Kilograms, above 0.
        center: (3,) float64, meters, link frame.
        inertia: (3, 3) float64, kg m2, about the center, along the link's axes. None if the file's
            is missing, zero, or not positive definite.
    """

    mass: float
    center: NDArray[np.float64]
    inertia: NDArray[np.float64] | None


@dataclass(frozen=True, eq=False)
class LinkDescription:
    """A link.

    Attributes:
        name: As in the file.
        where: File and line, for error messages.
        collisions: Its surface.
        inertial: None if the file states no mass, or 0.
        color: Color of its first visual.
        friction: Friction of its surface; None if the file states none.
        restitution: That of its surface; None if the file states none.
        rolling_friction: As in :class:`Material`, meters; None if the file states none.
        spinning_friction: As in :class:`Material`, meters; None if the file states none.
        is_seen: Whether it has a visual in a format in which each visual needs a collision beside it.
    """

    name: str
    where: str
    collisions: tuple[Collision, ...]
    inertial: Inertial | None
    color: Color | None
    friction: float | None = None
    restitution: float | None = None
    rolling_friction: float | None = None
    spinning_friction: float | None = None
    is_seen: bool = False

    @property
    def owner(self) -> str:
        """The start of error messages: "robot.urdf:7: link 'arm'"."""
        return f"{self.where}: link {self.name!r}"


@dataclass(frozen=True, eq=False)
class JointDescription:
    """A joint; effort and velocity are None if the file states none, or 0.

    Attributes:
        parent_from_child: (4, 4) float64, with the links as in the file.
        child_from_joint: (4, 4) float64.
        position: Position of the joint with the links as in the file.
        start: Initial position of the joint in a world.
        mimic: Name of the leader, multiplier, offset.
        no_effort: Where the effort is None, what an error says between "the file" and "for joint 'elbow'".
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
    stiffness: float = 0.0
    spring_position: float = 0.0
    armature: float = 0.0
    no_effort: str = "states no effort"


@dataclass(frozen=True, eq=False)
class RobotDescription:
    """Trees of links.

    Attributes:
        path: The file's path.
        name: As in the file.
        roots: Links that no joint moves, with their ``file_from_link``.
        links: All links, by name.
        joints: All joints, each before those of its child.
        without_limits: Joints that need limits, but have none in the file.
        intangible: Links that are seen, of bodies without a surface.
        moved_to_limits: Joints that the file has beyond their limits, and the limits that they begin at.
        doubts: Why meshes are probably not in meters, a text for each.
        flaws: Links with a faulty mesh or model, by what was done about the fault, "" if nothing, and by
            the name of the mesh and the fault: "foot.stl: 3 open edges".
        flat: Links with a collision mesh in a plane, and the thickness that it was given, meters.
        left_out: Contents of the file that are not simulated.
        unknown: Places of elements that the format does not have, by what is there.
    """

    path: str
    name: str
    roots: dict[str, NDArray[np.float64]]
    links: dict[str, LinkDescription]
    joints: list[JointDescription] = field(default_factory=list)
    without_limits: list[str] = field(default_factory=list)
    intangible: list[str] = field(default_factory=list)
    moved_to_limits: dict[str, float] = field(default_factory=dict)
    doubts: list[str] = field(default_factory=list)
    flaws: dict[str, dict[str, list[str]]] = field(default_factory=dict)
    flat: dict[str, float] = field(default_factory=dict)
    left_out: list[str] = field(default_factory=list)
    unknown: dict[str, list[str]] = field(default_factory=dict)

    def note_flaws(self, link: str, mesh: str, flaws: Iterable[Finding]) -> None:
        """Note what is wrong with the mesh of a link.

        Args:
            link: The link.
            mesh: The mesh's path.
            flaws: What was found.
        """
        for flaw in flaws:
            links = self.flaws.setdefault(flaw.handling, {}).setdefault(
                f"{os.path.basename(mesh)}: {flaw.defect}", []
            )
            if link not in links:
                links.append(link)

    def refuse(self, what: str, at: LinkDescription | JointDescription | None = None) -> NoReturn:
        """Raise a :class:`RobotError` that names the file, and the line of the error."""
        raise RobotError(f"{self.path if at is None else at.where}: {what}")


def shorten_names(names: Sequence[str]) -> str:
    """Return the first five names, quoted, and how many more there are; of a long name, its beginning."""
    shown = ", ".join(map(show_value, names[:5]))
    return f"{shown}, and {len(names) - 5} more" if len(names) > 5 else shown
