"""What a URDF file says, checked: links, joints, and where each link is."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, NoReturn, TypeAlias
from xml.parsers import expat

import numpy as np

from voxshell._arguments import as_path
from voxshell._input_files import read_small_file
from voxshell.errors import FileAccessError, MissingExtraError, RobotError, SettingsError
from voxshell.mass_properties import MassProperties

if TYPE_CHECKING:
    from numpy.typing import NDArray

JointType: TypeAlias = Literal["fixed", "revolute", "continuous", "prismatic", "floating"]

_MOST_BYTES = 100_000_000
"""Of a file, without the meshes that it names."""

MOST_LINKS = 1000
"""Of a robot; each two of them are kept apart, which takes time that grows as their square."""

_NUMBERS = {
    "origin": ("xyz", "rpy"),
    "axis": ("xyz",),
    "mass": ("value",),
    "inertia": ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "box": ("size",),
    "mesh": ("scale",),
    "limit": ("lower", "upper", "effort", "velocity"),
    "dynamics": ("damping", "friction"),
    "mimic": ("multiplier", "offset"),
}
"""Attributes of elements that must be numbers."""

_COUNTS = {"xyz": (3,), "rpy": (3,), "size": (3,), "scale": (1, 3)}
"""Of numbers in an attribute; in others one."""

_JOINT_TYPES = ("fixed", "revolute", "continuous", "prismatic", "floating")


@dataclass(frozen=True)
class MeshFile:
    """A mesh by the path that it was found at, and its scale along x, y and z."""

    path: str
    scale: tuple[float, float, float]


@dataclass(frozen=True)
class Primitive:
    """A box (edges), sphere (radius) or cylinder (radius, length), metres."""

    kind: Literal["box", "sphere", "cylinder"]
    sizes: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Collision:
    """A part of a link's surface, in its place."""

    geometry: MeshFile | Primitive
    link_from_geometry: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LinkDescription:
    """A link; ``matter`` in its frame, None where the file gives no mass."""

    name: str
    collisions: tuple[Collision, ...]
    matter: MassProperties | None


@dataclass(frozen=True, eq=False)
class JointDescription:
    """A joint; effort and velocity are None where the file gives none, or 0."""

    name: str
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

    def refuse(self, what: str) -> NoReturn:
        """Raises a :class:`RobotError` that names the file."""
        raise RobotError(f"{self.path}: {what}")


def read_urdf(path: str | os.PathLike[str]) -> RobotDescription:
    """Reads and checks a file.

    Raises:
        FileAccessError: The file cannot be read.
        MissingExtraError: yourdfpy is not installed.
        RobotError: The file does not describe a robot that can be simulated; the message names the
            file, the link or joint, and what to do.
    """
    name = os.fsdecode(as_path(path, "path"))
    if not os.path.isfile(name):
        raise FileAccessError(f"cannot read robot {name}: there is no such file")
    try:
        data = read_small_file(name, _MOST_BYTES, "robot")
    except SettingsError as error:
        raise RobotError(f"cannot read robot {name}: {error}") from None
    try:
        import yourdfpy
    except ImportError as error:
        raise MissingExtraError(
            f"robots need yourdfpy, which cannot be imported ({error}); "
            "run: pip install 'voxshell[urdf]'"
        ) from error
    _check_xml(name, data)
    try:
        raw = yourdfpy.URDF.load(name, build_scene_graph=False, load_meshes=False).robot
    except Exception as error:  # of which files with something missing raise every kind
        raise RobotError(
            f"{name}: it is no robot that can be read: {type(error).__name__}: {error}"
        ) from error
    return _describe(name, raw)


def _check_xml(path: str, data: bytes) -> None:
    """Refuses what yourdfpy reads on beyond: text that is no XML, entities, and no numbers.

    Raises:
        RobotError: It has them.
    """
    parser = expat.ParserCreate(namespace_separator=None)

    def refuse_entity(*_: object) -> None:
        raise RobotError(f"{path}: it declares XML entities, which no robot needs; write them out")

    where = ["robot"]

    def start(element: str, attributes: dict[str, str]) -> None:
        if element in ("link", "joint"):
            where[0] = f"{element} {attributes.get('name', '')[:60]!r}"
        for name in _NUMBERS.get(element, ()):
            if name in attributes and not _are_numbers(attributes[name], name):
                raise RobotError(
                    f'{path}: {where[0]} has <{element} {name}="{attributes[name][:60]}">; give '
                    f"{' or '.join(map(str, _COUNTS.get(name, (1,))))} finite numbers"
                )
        if element == "inertia" and not {"ixx", "iyy", "izz"} <= attributes.keys():
            raise RobotError(f"{path}: {where[0]} has an <inertia> without ixx, iyy or izz; add it")

    parser.StartElementHandler = start
    parser.EntityDeclHandler = refuse_entity
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        raise RobotError(f"{path}: it is no XML: {error}") from None


def _are_numbers(text: str, name: str) -> bool:
    try:
        numbers = [float(word) for word in text.split()]
    except ValueError:
        return False
    if "_" in text or len(numbers) not in _COUNTS.get(name, (1,)):
        return False
    if name in ("effort", "velocity"):  # infinity means that there is no bound
        return not any(map(math.isnan, numbers))
    return all(map(math.isfinite, numbers))


def _describe(path: str, raw: Any) -> RobotDescription:
    robot = RobotDescription(path, str(raw.name), "", {})
    if not raw.links:
        robot.refuse("it has no <link>")
    if len(raw.links) > MOST_LINKS:
        robot.refuse(f"it has {len(raw.links)} links, and at most {MOST_LINKS} are read")
    links = {}
    for link in raw.links:
        if link.name in links:
            robot.refuse(f"two links are named {link.name!r}; rename one")
        links[link.name] = _describe_link(robot, link)
    joints: dict[str, JointDescription] = {}
    for joint in raw.joints:
        if joint.name in joints:
            robot.refuse(f"two joints are named {joint.name!r}; rename one")
        joints[joint.name] = _describe_joint(robot, joint, links)
    parents: dict[str, str] = {}
    for joint in joints.values():
        if joint.child in parents:
            robot.refuse(
                f"link {joint.child!r} is the child of two joints, {parents[joint.child]!r} and "
                f"{joint.name!r}: URDF has trees only; leave one out and add it with World.add_joint"
            )
        parents[joint.child] = joint.name
        if joint.mimic is not None:
            leader = joints.get(joint.mimic[0])
            if leader is None or leader.type in ("fixed", "floating") or leader is joint:
                robot.refuse(
                    f"joint {joint.name!r} mimics {joint.mimic[0]!r}, which is no joint that moves"
                )
    _check_mimics(robot, joints)
    roots = [name for name in links if name not in parents]
    if len(roots) != 1:
        robot.refuse(
            f"it must have one link that is no joint's child, not {len(roots)} "
            f"({', '.join(map(repr, roots)) or 'its joints go round in a circle'})"
        )
    children: dict[str, list[JointDescription]] = {name: [] for name in links}
    for joint in joints.values():
        children[joint.parent].append(joint)
    ordered: list[JointDescription] = []
    reached = [roots[0]]
    for link in reached:
        for joint in children[link]:
            ordered.append(joint)
            reached.append(joint.child)
    if len(reached) != len(links):
        lost = sorted(set(links) - set(reached))
        robot.refuse(f"links {', '.join(map(repr, lost))} hang on each other in a circle")
    return RobotDescription(path, robot.name, roots[0], links, ordered)


def _check_mimics(robot: RobotDescription, joints: dict[str, JointDescription]) -> None:
    checked: set[str] = set()
    for name in joints:
        followed: dict[str, None] = {}
        at = name
        while at not in checked and (mimic := joints[at].mimic) is not None:
            if at in followed:
                robot.refuse(f"joints mimic each other in a circle, {at!r} among them")
            followed[at] = None
            at = mimic[0]
        checked.update(followed)


def _describe_link(robot: RobotDescription, raw: Any) -> LinkDescription:
    where = f"link {raw.name!r}"
    collisions = tuple(_describe_collision(robot, where, it) for it in raw.collisions)
    if raw.inertial is None or not raw.inertial.mass:
        return LinkDescription(raw.name, collisions, None)
    mass, inertia = raw.inertial.mass, raw.inertial.inertia
    if not (np.isfinite(mass) and mass > 0.0):
        robot.refuse(f"{where} has a mass of {mass:g} kg; it must be above 0")
    if inertia is None:
        robot.refuse(f"{where} has a mass but no <inertia>; add it")
    if not (np.isfinite(inertia).all() and np.linalg.eigvalsh(inertia).min() > 0.0):
        robot.refuse(
            f"{where} has an <inertia> with principal moments "
            f"{np.array2string(np.linalg.eigvalsh(np.nan_to_num(inertia)), precision=3)} kg m2; "
            "they must be above 0"
        )
    place = _as_pose(raw.inertial.origin)
    turned = place[:3, :3] @ inertia @ place[:3, :3].T
    return LinkDescription(raw.name, collisions, MassProperties(mass, place[:3, 3], turned))


def _describe_collision(robot: RobotDescription, where: str, raw: Any) -> Collision:
    geometry, place = raw.geometry, _as_pose(raw.origin)
    if geometry.mesh is not None:
        path = _find(robot, where, geometry.mesh.filename)
        scale = geometry.mesh.scale
        scales = np.ravel(1.0 if scale is None else np.asarray(scale, float))
        if len(scales) not in (1, 3):
            robot.refuse(f"{where} has a mesh with {len(scales)} scales; give one number or three")
        scales = np.broadcast_to(scales, 3)
        if not (np.isfinite(scales).all() and scales.all()):
            robot.refuse(f"{where} has a mesh with a scale of {scales.tolist()}; it must not be 0")
        return Collision(MeshFile(path, tuple(scales.tolist())), place)
    if geometry.box is not None:
        primitive = Primitive("box", tuple(float(it) for it in np.ravel(geometry.box.size)))
        if len(primitive.sizes) != 3:
            robot.refuse(f"{where} has a box of {len(primitive.sizes)} sizes; give three")
    elif geometry.sphere is not None:
        primitive = Primitive("sphere", (float(geometry.sphere.radius),))
    else:
        primitive = Primitive(
            "cylinder", (float(geometry.cylinder.radius), float(geometry.cylinder.length))
        )
    if not all(np.isfinite(it) and it > 0.0 for it in primitive.sizes):
        robot.refuse(
            f"{where} has a {primitive.kind} of {list(primitive.sizes)} m; it must be above 0"
        )
    return Collision(primitive, place)


def _find(robot: RobotDescription, where: str, name: str) -> str:
    from yourdfpy import filename_handler_magic

    try:
        path = filename_handler_magic(name, dir=os.path.dirname(robot.path))
    except Exception:  # of any kind, where nothing is left of a name without its scheme
        path = ""
    if not os.path.isfile(path):
        robot.refuse(
            f"{where} has a mesh {name[:200]!r} that is not to be found; put it where the path points, "
            "seen from the file's folder or, for package://, from one above it"
        )
    return path


def _describe_joint(
    robot: RobotDescription, raw: Any, links: dict[str, LinkDescription]
) -> JointDescription:
    where = f"joint {raw.name!r}"
    if raw.type not in _JOINT_TYPES:
        robot.refuse(
            f"{where} is of type {raw.type!r}; types are {', '.join(_JOINT_TYPES)}: make a planar one of "
            "two prismatic ones and a continuous one"
        )
    for end in ("parent", "child"):
        if getattr(raw, end) not in links:
            robot.refuse(f"{where} has a {end} {getattr(raw, end)!r}, and there is no such link")
    axis = np.array([1.0, 0.0, 0.0]) if raw.axis is None else np.asarray(raw.axis, float)
    if axis.shape != (3,) or not np.isfinite(axis).all() or not axis.any():
        robot.refuse(f"{where} has an axis of {axis.tolist()}; give three numbers, not all 0")
    limits = None
    if raw.type in ("revolute", "prismatic"):
        if raw.limit is None:
            robot.refuse(f"{where} is {raw.type} and needs a <limit>; add it")
        limits = (float(raw.limit.lower or 0.0), float(raw.limit.upper or 0.0))
        if not (np.isfinite(limits).all() and limits[0] <= limits[1]):
            robot.refuse(f"{where} has limits {limits[0]:g} to {limits[1]:g}; swap or correct them")
    mimic = None
    if raw.mimic is not None:
        multiplier = 1.0 if raw.mimic.multiplier is None else float(raw.mimic.multiplier)
        mimic = (raw.mimic.joint, multiplier, float(raw.mimic.offset or 0.0))
    losses = [
        float((getattr(raw.dynamics, loss) if raw.dynamics else None) or 0.0)
        for loss in ("friction", "damping")
    ]
    if min(losses) < 0.0:
        robot.refuse(f"{where} has a friction or damping below 0")
    return JointDescription(
        raw.name,
        raw.type,
        raw.parent,
        raw.child,
        _as_pose(raw.origin),
        tuple(axis.tolist()),
        limits,
        _above_zero(raw.limit.effort if raw.limit else None),
        _above_zero(raw.limit.velocity if raw.limit else None),
        losses[0],
        losses[1],
        mimic,
    )


def _above_zero(value: float | None) -> float | None:
    return float(value) if value and np.isfinite(value) and value > 0.0 else None


def _as_pose(origin: NDArray[np.float64] | None) -> NDArray[np.float64]:
    return np.eye(4) if origin is None else np.asarray(origin, np.float64)
