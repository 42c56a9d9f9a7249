"""Conversion of a model's bodies to links and joints."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from voxshell.robots.description import (
    MOST_LINKS,
    Collision,
    JointDescription,
    LinkDescription,
    RobotDescription,
)
from voxshell.robots.mjcf.actuators import Actuators
from voxshell.robots.mjcf.defaults import MAIN
from voxshell.robots.mjcf.geoms import Geom, read_geom
from voxshell.robots.mjcf.inertias import BodyMatter, as_inertial
from voxshell.robots.mjcf.joints import JointPlace, is_aligned, read_joint, type_of
from voxshell.robots.mjcf.model_file import MOST_LEVELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.model.mass_properties import MassProperties
    from voxshell.robots.mjcf.filters import Filters
    from voxshell.robots.mjcf.left_out import LeftOut
    from voxshell.robots.mjcf.parts import Part
    from voxshell.robots.xml_elements import Element

WORLD = "world"


@dataclass(frozen=True, eq=False)
class _Scope:
    """The model of an element, and the default class of its surroundings."""

    part: Part
    child_class: str

    def inside(self, element: Element) -> _Scope:
        """Return the scope of the elements in a body or frame.

        Raises:
            RobotError: The element names an unknown class.
        """
        name = element.attributes.get("childclass", self.child_class)
        self.part.defaults.check(element, name)
        return _Scope(self.part, name)


@dataclass(eq=False)
class _Body:
    """A body that is being read, with the elements in it and in its frames.

    Attributes:
        name: Its name, or one made from its number.
        above: Name of the body that contains it.
        above_from_body: (4, 4).
        file_from_body: (4, 4), before joints move.
        is_static: True if neither it nor the bodies above it have joints.
        part: The model that it belongs to.
    """

    name: str
    where: str
    above: str
    above_from_body: NDArray[np.float64]
    file_from_body: NDArray[np.float64]
    is_static: bool
    part: Part
    inertial: tuple[Element, NDArray[np.float64]] | None = None
    joints: list[tuple[Element, NDArray[np.float64]]] = field(default_factory=list)
    geoms: list[Geom] = field(default_factory=list)
    bodies: list[tuple[Element, NDArray[np.float64], _Scope]] = field(default_factory=list)

    def weigh(self, element: Element) -> BodyMatter:
        """Return the shape that the mass and inertia are computed from."""
        inertial, frame = self.inertial or (None, np.eye(4))
        return BodyMatter(element, inertial, frame, self.geoms)

    def align(self, element: Element) -> None:
        """Move the frame to that of the inertia; everything in it stays in place.

        Raises:
            RobotError: A number is wrong, or a mesh cannot be read.
        """
        body_from_aligned = self.weigh(element).find_frame(self.part.compiler)
        if body_from_aligned is None:
            return
        aligned_from_body = np.linalg.inv(body_from_aligned).astype(np.float64)
        self.above_from_body = self.above_from_body @ body_from_aligned
        self.file_from_body = self.file_from_body @ body_from_aligned
        self.geoms = [geom.move(aligned_from_body) for geom in self.geoms]
        if self.inertial is not None:
            inertial, frame = self.inertial
            self.inertial = inertial, aligned_from_body @ frame


class BodyReader:
    """Reads the bodies of a model into a description of a robot.

    Args:
        part: The model.
        robot: Receives the links and joints.
        filters: Receives what collides with what.
        left_out: Receives what is not simulated.

    Attributes:
        carriers: The body of each link between joints, by name.
    """

    def __init__(
        self, part: Part, robot: RobotDescription, filters: Filters, left_out: LeftOut
    ) -> None:
        self._weighs_static = part.compiler.total_mass is not None
        self._robot = robot
        self._filters = filters
        self._left_out = left_out
        self._actuators = Actuators()
        self.carriers: dict[str, str] = {}
        self._joint_names: set[str] = set()
        self._count = 0
        self._level = 0
        world = _Body(WORLD, part.file.path, WORLD, np.eye(4), np.eye(4), is_static=True, part=part)
        self._note_part(part)
        children = [child for it in part.file.sections("worldbody") for child in it.children]
        self._collect(children, world, np.eye(4), _Scope(part, MAIN))
        self._add_link(world, WORLD, None)
        robot.roots[WORLD] = np.eye(4)
        self._read_below(world)
        robot.joints[:] = map(self._actuators.limit, robot.joints)

    def _note_part(self, part: Part) -> None:
        self._filters.read_pairs(part)
        self._left_out.note_sections(part.file.root)
        self._actuators.read(part)

    def _read_below(self, body: _Body) -> None:
        self._level += 1
        for element, frame, scope in body.bodies:
            if self._level > MOST_LEVELS:
                element.refuse(
                    f"is nested in more than {MOST_LEVELS} bodies; make the tree flatter"
                )
            self._read_body(element, body, frame, scope)
        self._level -= 1

    def _read_body(
        self, element: Element, above: _Body, frame: NDArray[np.float64], scope: _Scope
    ) -> None:
        self._count += 1
        if self._count >= MOST_LINKS:
            element.refuse(f"is beyond the limit of {MOST_LINKS} bodies")
        part = scope.part
        name = element.attributes.get("name")
        name = f"body {self._count}" if name is None else part.prefix + name
        if name in self._robot.links:
            element.refuse("is the second body with that name; rename one")
        place = frame @ part.compiler.read_pose(element)
        body = _Body(
            name,
            element.where,
            above.name,
            place,
            above.file_from_body @ place,
            is_static=above.is_static,
            part=part,
        )
        self._collect(element.children, body, np.eye(4), scope.inside(element))
        if body.joints:
            body.is_static = False
        if is_aligned(body.joints, bool(body.bodies), part.compiler):
            body.align(element)
        if element.attributes.get("mocap") == "true":
            self._left_out.note("mocap bodies, which stand still", name)
        if element.number("gravcomp"):
            self._left_out.note("gravcomp", name)
        self._add_body(body, element)
        self._filters.place(name, above.name, self._is_top(body))
        self._read_below(body)

    @staticmethod
    def _is_top(body: _Body) -> bool:
        return body.above == WORLD

    def _collect(
        self, children: list[Element], body: _Body, frame: NDArray[np.float64], scope: _Scope
    ) -> None:
        """Return the elements in a body, or in a frame of it."""
        part = scope.part
        for child in children:
            match child.tag:
                case "body":
                    body.bodies.append((child, frame, scope))
                case "frame":
                    inner = frame @ part.compiler.read_pose(child)
                    self._collect(child.children, body, inner, scope.inside(child))
                case "inertial":
                    body.inertial = child, frame
                case "joint" | "freejoint":
                    complete = child
                    if child.tag == "joint":
                        complete = part.defaults.complete(child, scope.child_class)
                    body.joints.append((complete, frame))
                case "geom":
                    body.geoms.append(self._read_geom(child, body, frame, scope))
                case "attach":
                    attached, elements = part.attach(child)
                    self._note_part(attached)
                    self._level += 1
                    if self._level > MOST_LEVELS:
                        child.refuse(
                            f"is nested in more than {MOST_LEVELS} frames; make the tree flatter"
                        )
                    self._collect(elements, body, frame, _Scope(attached, MAIN))
                    self._level -= 1
                case "replicate":
                    child.refuse(
                        "has a <replicate>, which is not supported; save the compiled model with "
                        "mujoco.mj_saveLastXML, and load that"
                    )
                case "composite" | "flexcomp":
                    self._left_out.note(f"<{child.tag}>", child.attributes.get("name", "")[:60])
                case _:
                    pass

    def _read_geom(
        self, element: Element, body: _Body, frame: NDArray[np.float64], scope: _Scope
    ) -> Geom:
        part = scope.part
        is_paired = self._filters.is_paired(part.prefix + element.attributes.get("name", ""))
        complete = part.defaults.complete(element, scope.child_class)
        geom = read_geom(complete, frame, part, is_paired)
        if geom.surface is None:
            self._left_out.note(f"geoms of type {geom.type}", geom.name or f"of {body.name}")
        return geom

    def _add_body(self, body: _Body, element: Element) -> None:
        """Add its links and joints: one link for each joint; the last one has the surface."""
        compiler = body.part.compiler
        matter = None
        if not body.is_static or self._weighs_static:
            matter = body.weigh(element).compute(compiler)
        if not body.joints:
            self._add_link(body, body.name, matter)
            if self._is_top(body):
                self._robot.roots[body.name] = body.above_from_body
            else:
                self._robot.joints.append(_weld(body))
            return
        types = [type_of(joint) for joint, _ in body.joints]
        if "floating" in types and (len(types) > 1 or not self._is_top(body)):
            element.refuse(
                "has a free joint beside others, or is in another body; only a body directly in "
                "<worldbody> can be free"
            )
        parent, place = body.above, body.above_from_body
        for index, (joint, frame) in enumerate(body.joints):
            is_last = index == len(types) - 1
            name = joint.attributes.get("name")
            name = f"{body.name}/joint {index}" if name is None else body.part.prefix + name
            if name in self._joint_names:
                joint.refuse(f"has a second joint {name!r}; rename one")
            self._joint_names.add(name)
            child = body.name if is_last else f"{body.name}/{name}"
            if is_last:
                self._add_link(body, child, matter)
            else:
                self._add_carrier(joint, child, body.name)
            self._robot.joints.append(
                read_joint(
                    joint, frame, JointPlace(name, parent, child, place), compiler, self._left_out
                )
            )
            parent, place = child, np.eye(4)

    def _add_carrier(self, joint: Element, name: str, body: str) -> None:
        """Add a link between two joints of a body."""
        if name in self._robot.links:
            joint.refuse(f"makes a link {name!r}, but that name exists already; rename the joint")
        self._robot.links[name] = LinkDescription(name, joint.where, (), None, None)
        self.carriers[name] = body

    def _add_link(self, body: _Body, name: str, matter: MassProperties | None) -> None:
        meeting = [geom for geom in body.geoms if geom.collides and geom.surface is not None]
        solids: list[Collision] = []
        for geom in meeting:
            if geom.type == "plane":
                self._add_plane(body, geom)
            elif geom.surface is not None:
                solids.append(geom.surface)
        color = next((geom.color for geom in body.geoms if geom.color is not None), None)
        friction = max((geom.friction for geom in meeting), default=None)
        self._robot.links[name] = LinkDescription(
            name, body.where, tuple(solids), as_inertial(matter), color, friction
        )
        self._filters.add(name, [geom for geom in meeting if geom.type != "plane"])

    def _add_plane(self, body: _Body, geom: Geom) -> None:
        """Add a separate link: a plane cannot be a part of a body."""
        if not body.is_static:
            geom.element.refuse("is a plane of a moving body; make it a box")
        assert geom.surface is not None
        name = f"{body.name}/{geom.element.attributes.get('name') or f'plane {len(self._robot.links)}'}"
        if name in self._robot.links:
            geom.element.refuse(f"makes a link {name!r}, but that name exists already; rename it")
        surface = Collision(geom.surface.geometry, np.eye(4))
        self._robot.links[name] = LinkDescription(
            name, geom.element.where, (surface,), None, geom.color, geom.friction
        )
        self._robot.roots[name] = body.file_from_body @ geom.surface.link_from_geometry
        self._filters.place(name, WORLD, True)
        self._filters.add(name, [geom])


def _weld(body: _Body) -> JointDescription:
    """Return a fixed joint between a body without joints and the body that contains it."""
    return JointDescription(
        f"{body.name}/weld",
        body.where,
        "fixed",
        body.above,
        body.name,
        body.above_from_body,
        np.eye(4),
    )
