"""Reading and checking URDF files."""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING, Literal, NoReturn, cast

import numpy as np

from voxshell.base.arguments import as_path, show_value
from voxshell.base.poses import pose as make_pose
from voxshell.errors import RobotError
from voxshell.robots.description import (
    MOST_LINKS,
    Collision,
    Color,
    Inertial,
    JointDescription,
    JointType,
    LinkDescription,
    MeshFile,
    Primitive,
    RobotDescription,
    shorten_names,
)
from voxshell.robots.solids import is_sound
from voxshell.robots.urdf.contacts import read_material
from voxshell.robots.urdf.mesh_paths import find_mesh
from voxshell.robots.urdf.names import find_unknown, refuse_macros
from voxshell.robots.xml_elements import Dialect, read_elements

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from voxshell.robots.xml_elements import Element

_JOINT_TYPES: dict[str, JointType] = {
    "fixed": "fixed",
    "revolute": "revolute",
    "continuous": "continuous",
    "prismatic": "prismatic",
    "floating": "floating",
    "spherical": "spherical",
    "ball": "spherical",
}
"""URDF's shapes, and those that simulators add."""

_WITH_AXIS = ("revolute", "continuous", "prismatic")


def read_urdf(path: str | os.PathLike[str]) -> RobotDescription:
    """Read and check a file.

    Raises:
        MissingFileError: The file does not exist.
        FileAccessError: The file cannot be read.
        RobotError: The file cannot be simulated; the message names the file, the line, the link or
            joint, and a remedy.
    """
    name = os.fsdecode(as_path(path, "path"))
    return _describe(name, read_elements(name, _DIALECT))


def _find_owner(tag: str, name: str, level: int, above: str) -> str:
    return f"{tag} {name!r}" if level == 2 and tag in ("link", "joint") else above


_DIALECT = Dialect(("robot",), most_levels=8, refuses_deeper=False, find_owner=_find_owner)


def _describe(path: str, element: Element) -> RobotDescription:
    robot = RobotDescription(path, element.attributes.get("name", "robot"), {}, {})
    found = list(element.all("link"))
    if not found:
        _refuse_without_links(robot, element)
    refuse_macros(element)
    if len(found) > MOST_LINKS:
        robot.refuse(f"it has {len(found)} links; at most {MOST_LINKS} are read")
    colors = {
        material.attributes.get("name", ""): color
        for material in element.all("material")
        if (color := _read_color(material)) is not None
    }
    links: dict[str, LinkDescription] = {}
    unread: dict[str, list[str]] = {}
    for each in found:
        link = _describe_link(each, colors, robot.left_out, unread)
        if link.name in links:
            each.refuse(
                f"is the second link of that name; the first is in line "
                f"{links[link.name].where.rpartition(':')[2]}; rename one"
            )
        links[link.name] = link
    robot.left_out.extend(_list_unread(unread))
    joints: dict[str, JointDescription] = {}
    for each in element.all("joint"):
        joint = _describe_joint(robot, each, links)
        if joint.name in joints:
            each.refuse(
                f"is the second joint of that name; the first is in line "
                f"{joints[joint.name].where.rpartition(':')[2]}; rename one"
            )
        joints[joint.name] = joint
    parents: dict[str, str] = {}
    for joint in joints.values():
        if joint.child in parents:
            robot.refuse(
                f"link {joint.child!r} is the child of two joints, {parents[joint.child]!r} and "
                f"{joint.name!r}, but URDF supports only trees; remove one and add it with World.add_joint",
                joint,
            )
        parents[joint.child] = joint.name
        if joint.mimic is not None:
            leader = joints.get(joint.mimic[0])
            if leader is None or leader.type not in _WITH_AXIS or leader is joint:
                robot.refuse(
                    f"joint {joint.name!r} mimics {joint.mimic[0]!r}, which is not a moving joint; "
                    "correct the name",
                    joint,
                )
    _check_mimics(robot, joints)
    roots = [name for name in links if name not in parents]
    if len(roots) != 1:
        robot.refuse(
            f"it must have exactly one link that is not a joint's child, but has {len(roots)} "
            f"({shorten_names(roots) or 'its joints form a loop'}); connect them with joints, or "
            "split the file"
        )
    children: dict[str, list[JointDescription]] = {name: [] for name in links}
    for joint in joints.values():
        children[joint.parent].append(joint)
    ordered: list[JointDescription] = []
    reached = [roots[0]]
    for name in reached:
        for joint in children[name]:
            ordered.append(joint)
            reached.append(joint.child)
    if len(reached) != len(links):
        lost = sorted(set(links) - set(reached))
        robot.refuse(f"links {shorten_names(lost)} form a loop")
    return RobotDescription(
        path,
        robot.name,
        {roots[0]: np.eye(4)},
        links,
        ordered,
        without_limits=robot.without_limits,
        left_out=robot.left_out,
        unknown=find_unknown(element),
    )


def _list_unread(unread: dict[str, list[str]]) -> Iterator[str]:
    """Yield elements of contacts with the names of the links that have them: "<damping> of <contact> ('a')"."""
    tags_of: dict[tuple[str, ...], list[str]] = {}
    for tag, links in unread.items():
        tags_of.setdefault(tuple(links), []).append(f"<{tag}>")
    for links, tags in tags_of.items():
        yield f"{', '.join(tags)} of <contact> ({shorten_names(links)})"


def _refuse_without_links(robot: RobotDescription, element: Element) -> NoReturn:
    macro = next((it.tag for it in element.children if it.tag.startswith("xacro:")), None)
    if macro is None:
        robot.refuse("it has no <link>")
    robot.refuse(
        f"it has no <link>, but <{macro[:60]}>: it is a xacro file that is not expanded; run "
        f"xacro {robot.path} > robot.urdf, and load the result"
    )


def _check_mimics(robot: RobotDescription, joints: dict[str, JointDescription]) -> None:
    checked: set[str] = set()
    for name in joints:
        followed: dict[str, None] = {}
        at = name
        while at not in checked and (mimic := joints[at].mimic) is not None:
            if at in followed:
                robot.refuse(f"joints mimic each other in a loop, including {at!r}", joints[at])
            followed[at] = None
            at = mimic[0]
        checked.update(followed)


def _describe_link(
    element: Element, colors: dict[str, Color], left_out: list[str], unread: dict[str, list[str]]
) -> LinkDescription:
    name = element.text("name")
    collisions = tuple(
        collision
        for each in element.all("collision")
        if (collision := _describe_collision(each, name, left_out)) is not None
    )
    return LinkDescription(
        name,
        element.where,
        collisions,
        _describe_inertial(element.first("inertial")),
        _find_color(element, colors),
        is_seen=element.first("visual") is not None,
        **read_material(element, unread),
    )


def _find_color(link: Element, named: dict[str, Color]) -> Color | None:
    """Return the first color of a visual, given directly or by the name of a material."""
    for visual in link.all("visual"):
        material = visual.first("material")
        if material is None:
            continue
        color = _read_color(material)
        if color is None:
            color = named.get(material.attributes.get("name", ""))
        if color is not None:
            return color
    return None


def _read_color(material: Element) -> Color | None:
    """Return a color; None if it is invalid, because colors do not affect the simulation."""
    color = material.first("color")
    try:
        numbers = None if color is None else color.numbers("rgba", (3, 4))
    except RobotError:
        return None
    if numbers is None:
        return None
    red, green, blue = (round(255.0 * min(max(it, 0.0), 1.0)) for it in numbers[:3])
    return red, green, blue


def _describe_inertial(element: Element | None) -> Inertial | None:
    if element is None:
        return None
    mass_element, tensor = element.first("mass"), element.first("inertia")
    mass = mass_element.number("value") if mass_element is not None else None
    place = _read_pose(element.first("origin"))
    inertia = None
    if tensor is not None:
        read = {name: tensor.number(name) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")}
        if None in (read["ixx"], read["iyy"], read["izz"]):
            tensor.refuse("has an <inertia> without ixx, iyy or izz; add it")
        xx, xy, xz, yy, yz, zz = (value or 0.0 for value in read.values())
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if not mass:
        return None
    if mass < 0.0:
        element.refuse(f"has a mass of {mass:g} kg; it must not be below 0")
    if inertia is not None:
        inertia = place[:3, :3] @ inertia @ place[:3, :3].T if is_sound(inertia) else None
    return Inertial(mass, place[:3, 3], inertia)


def _describe_collision(element: Element, link: str, left_out: list[str]) -> Collision | None:
    """Return a collision; None without geometry or with a point, which some exporters write."""
    geometry = element.first("geometry")
    if geometry is None or not geometry.children:
        return None
    place = _read_pose(element.first("origin"))
    shape = geometry.children[0]
    match shape.tag:
        case "mesh":
            return Collision(_read_mesh_name(shape), place)
        case "box":
            sizes = shape.numbers("size", (3,))
        case "sphere":
            sizes = _read_sizes(shape, "radius")
        case "cylinder" | "capsule":
            sizes = _read_sizes(shape, "radius", "length")
        case _:
            shape.refuse(
                f"has a <{shape.tag[:60]}>, which is not a shape; use a box, sphere, cylinder, capsule or "
                "mesh"
            )
    if sizes is None:
        shape.refuse("has a box without a size; add it")
    if shape.tag == "sphere" and sizes == [0.0]:
        left_out.append(f"a sphere of radius 0 ({show_value(link)})")
        return None
    if min(sizes) <= 0.0:
        shape.refuse(f"has a {shape.tag} of {sizes} m; it must be above 0")
    kind = cast("Literal['box', 'sphere', 'cylinder', 'capsule']", shape.tag)
    return Collision(Primitive(kind, tuple(sizes)), place)


def _read_sizes(shape: Element, *names: str) -> list[float]:
    sizes = []
    for name in names:
        shape.text(name)
        sizes.append(shape.number(name) or 0.0)
    return sizes


def _read_mesh_name(mesh: Element) -> MeshFile:
    name = mesh.text("filename")
    path = find_mesh(mesh.path, name)
    if path is None:
        mesh.refuse(
            f"has a mesh {name[:200]!r} that is missing; put it where the path points, relative to the "
            "file's folder or one above it, or name the folder of its package in ROS_PACKAGE_PATH"
        )
    scales = mesh.numbers("scale", (1, 3)) or [1.0]
    x, y, z = scales if len(scales) == 3 else scales * 3
    if not (x and y and z):
        mesh.refuse(f"has a mesh with a scale of {[x, y, z]}; it must not be 0")
    affine = ((x, 0.0, 0.0, 0.0), (0.0, y, 0.0, 0.0), (0.0, 0.0, z, 0.0))
    return MeshFile(path, affine, has_scale="scale" in mesh.attributes)


def _describe_joint(
    robot: RobotDescription, element: Element, links: dict[str, LinkDescription]
) -> JointDescription:
    kind = _JOINT_TYPES.get(element.text("type"))
    if kind is None:
        element.refuse(
            f"has the type {element.text('type')[:60]!r}; types are {', '.join(_JOINT_TYPES)}: replace a "
            "planar joint by two prismatic ones and a continuous one"
        )
    ends = {}
    for end in ("parent", "child"):
        link = element.first(end)
        if link is None:
            element.refuse(f"has no <{end}>; add it")
        ends[end] = link.text("link")
        if ends[end] not in links:
            link.refuse(f"has a {end} {ends[end][:60]!r}, but there is no such link")
    axis = _read_axis(element) if kind in _WITH_AXIS else (1.0, 0.0, 0.0)
    limit, dynamics, mimic = (element.first(tag) for tag in ("limit", "dynamics", "mimic"))
    limits = _read_limits(limit) if kind in ("revolute", "prismatic") else None
    name = element.text("name")
    if kind in ("revolute", "prismatic") and limits is None:
        robot.without_limits.append(name)
    losses = [
        (dynamics.number(loss) if dynamics is not None else None) or 0.0
        for loss in ("friction", "damping")
    ]
    if min(losses) < 0.0:
        element.refuse("has a friction or damping below 0")
    return JointDescription(
        name,
        element.where,
        kind,
        ends["parent"],
        ends["child"],
        _read_pose(element.first("origin")),
        np.eye(4),
        0.0,
        0.0,
        axis,
        limits,
        _read_bound(limit, "effort"),
        _read_bound(limit, "velocity"),
        losses[0],
        losses[1],
        _read_mimic(mimic) if mimic is not None and kind in _WITH_AXIS else None,
        no_effort=_explain_effort(limit),
    )


def _read_axis(joint: Element) -> tuple[float, float, float]:
    """Return the axis; x by default, as URDF specifies."""
    axis = joint.first("axis")
    numbers = None if axis is None else axis.numbers("xyz", (3,))
    x, y, z = numbers or (1.0, 0.0, 0.0)
    if axis is not None and not (x or y or z):
        axis.refuse(f"has an axis of {[x, y, z]}; give three numbers, not all 0")
    return x, y, z


def _read_limits(limit: Element | None) -> tuple[float, float] | None:
    """Return the limits; None if both are missing or infinite, or if lower exceeds upper."""
    if limit is None:
        return None
    lower, upper = (limit.number(end, finite=False) for end in ("lower", "upper"))
    if lower is None and upper is None:
        return None
    lower, upper = lower or 0.0, upper or 0.0
    if lower == -math.inf and upper == math.inf:
        return None
    if not (math.isfinite(lower) and math.isfinite(upper)):
        limit.refuse(f"has limits {lower:g} to {upper:g}; give finite ones")
    if lower > upper:
        return None
    return lower, upper


def _read_mimic(mimic: Element) -> tuple[str, float, float]:
    multiplier = mimic.number("multiplier")
    return (
        mimic.text("joint"),
        1.0 if multiplier is None else multiplier,
        mimic.number("offset") or 0.0,
    )


def _read_bound(limit: Element | None, name: str) -> float | None:
    """Return a bound, or None if there is none."""
    value = None if limit is None else limit.number(name, finite=False)
    return value if value is not None and 0.0 < value < math.inf else None


def _explain_effort(limit: Element | None) -> str:
    """Return what the file does instead of stating an effort."""
    effort = None if limit is None else limit.attributes.get("effort")
    return "states no effort" if effort is None else f'states effort="{effort[:60]}"'


def _read_pose(origin: Element | None) -> NDArray[np.float64]:
    if origin is None:
        return make_pose()
    zero = (0.0, 0.0, 0.0)
    return make_pose(origin.numbers("xyz", (3,)) or zero, euler=origin.numbers("rpy", (3,)) or zero)
