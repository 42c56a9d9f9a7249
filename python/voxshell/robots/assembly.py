"""Adding robots to a world: bodies and joints."""

from __future__ import annotations

import os
from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

from voxshell.base.pose_forms import as_rigid_pose
from voxshell.errors import InputTypeError, PoseError, RobotError, SettingsError
from voxshell.model.shapes import Sphere
from voxshell.robots.description import MIMIC_EFFORT
from voxshell.robots.kinematics import find_child, move_along
from voxshell.robots.link import Link
from voxshell.robots.robot import Robot
from voxshell.simulation.joint_kinds import HingeJoint, PointJoint, SliderJoint
from voxshell.simulation.material import Material
from voxshell.simulation.world import World

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike, NDArray

    from voxshell.model.shapes import Plane
    from voxshell.robots.description import JointDescription, RobotDescription
    from voxshell.robots.lumps import Lump
    from voxshell.robots.matter import Matter
    from voxshell.simulation.body import Body
    from voxshell.simulation.compound import Compound, Part
    from voxshell.simulation.joints import Joint

_MARKER_RADIUS = 0.005
"""Radius of the ball that represents a body without a surface, meters; it does not collide."""


def check_place(world: World, pose: ArrayLike | None, friction: float) -> NDArray[np.float64]:
    """Check a loader's arguments before reading the file; return ``world_from_file``.

    Raises:
        InputTypeError: ``world`` is not a world.
        PoseError: ``pose`` is in no form that :func:`pose` lists, is not rigid, or is not finite.
        SettingsError: ``friction`` is out of range.
    """
    world_from_file = np.eye(4) if pose is None else as_rigid_pose(pose, "pose")
    if not isinstance(world, World):
        is_path = isinstance(world, (str, os.PathLike))
        hint = "; the world comes first, and then the path" if is_path else ""
        raise InputTypeError(f"world must be a World, not {type(world).__name__}{hint}")
    World().add(Sphere(_MARKER_RADIUS), mass=0.0, pose=world_from_file, friction=friction)
    return world_from_file


class Assembly:
    """The parts of a robot; :meth:`add` adds them to a world.

    Args:
        robot: The description from the file.
        lumps: Lumps by the names of links.
        matter: Mass properties of the moving lumps.
        shapes: Shapes of all lumps.
        world_from_file: (4, 4).
        friction: Friction of all bodies; None for that of the file, or 0.5 if it states none.
        apart: Lumps with shapes that do not collide with each other.
        joints_collide: True if the links of a joint collide, unless they are in ``apart``.
    """

    def __init__(
        self,
        robot: RobotDescription,
        lumps: dict[str, Lump],
        matter: Matter,
        shapes: dict[Lump, Part | Compound | Plane | None],
        world_from_file: NDArray[np.float64],
        *,
        friction: float | None,
        apart: Iterable[tuple[Lump, Lump]],
        joints_collide: bool,
    ) -> None:
        self._robot = robot
        self._lumps = lumps
        self._matter = matter
        self._shapes = shapes
        self._friction = friction
        self._apart = apart
        self._joints_collide = joints_collide
        self._places = {name: world_from_file @ it for name, it in robot.roots.items()}
        for joint in robot.joints:
            self._places[joint.child] = self._places[joint.parent] @ find_child(joint, joint.start)

    def add(self, world: World) -> Robot:
        """Add bodies and joints; after an exception, the world has none of them.

        Raises:
            RobotError: The file requires something that a world does not support.
        """
        added: list[Body] = []
        try:
            made = self._add(world, added)
        except BaseException as error:
            for each in added:
                world.remove(each)
            # The arguments have been checked, so the file is the cause.
            if isinstance(error, (PoseError, SettingsError)):
                raise RobotError(f"{self._robot.path}: {error}") from error
            raise
        return made

    def _add(self, world: World, added: list[Body]) -> Robot:
        robot = self._robot
        bodies: dict[Lump, Body | None] = {}
        for lump, shape in self._shapes.items():
            own = self._matter.of_lumps.get(lump)
            if own is None and shape is None:
                bodies[lump] = None
                continue
            body = bodies[lump] = world.add(
                Sphere(_MARKER_RADIUS) if shape is None else shape,
                mass=0.0 if own is None else own.mass,
                inertia="solid" if own is None else own,
                pose=self._places[lump.first],
                material=self._find_material(lump),
                name=f"{robot.name}/{lump.first}",
                group=1 if shape is not None else 0,
            )
            added.append(body)
        links = {}
        for name, lump in self._lumps.items():
            body = bodies[lump]
            offset = lump.links[name] if body is not None else self._places[name]
            links[name] = Link(name, body, offset, robot.links[name].color)
        for a, b in self._apart:
            one, other = bodies[a], bodies[b]
            assert one is not None
            assert other is not None
            world.set_collision(one, other, False)
        joints: dict[str, Joint] = {}
        ball_joints: dict[str, Joint] = {}
        for joint in robot.joints:
            made = self._add_joint(world, joint, links)
            if made is not None:
                (ball_joints if joint.type == "spherical" else joints)[joint.name] = made
        self._let_follow(joints)
        return Robot(world, robot.name, links, joints, ball_joints, robot.joints)

    def _find_material(self, lump: Lump) -> Material:
        """Return a lump's material: of each property, the largest that the file states for its links."""
        links = [self._robot.links[name] for name in lump.links]
        stated: dict[str, list[float]] = {
            one.name: [it for link in links if (it := getattr(link, one.name)) is not None]
            for one in fields(Material)
        }
        if self._friction is not None:
            stated["friction"] = [self._friction]
        return Material(**{name: max(values) for name, values in stated.items() if values})

    def _add_joint(
        self, world: World, joint: JointDescription, links: dict[str, Link]
    ) -> Joint | None:
        match joint.type:
            case "revolute" | "continuous" | "prismatic":
                kind = (SliderJoint if joint.type == "prismatic" else HingeJoint)(
                    joint.axis,
                    joint.limits,
                    joint.friction,
                    joint.damping,
                    joint.stiffness,
                    joint.spring_position,
                    joint.armature,
                )
            case "spherical":
                kind = PointJoint()
            case _:
                return None
        parent, child = links[joint.parent], links[joint.child]
        assert child.body is not None
        parent_from_joint = joint.parent_from_child @ joint.child_from_joint
        if joint.position != 0.0:
            parent_from_joint = parent_from_joint @ move_along(joint, -joint.position)
        made = world.add_joint(
            kind,
            parent.body,
            child.body,
            parent_from_joint=parent.body_from_link @ parent_from_joint,
            child_from_joint=joint.child_from_joint,
            collide=self._joints_collide,
            name=f"{self._robot.name}/{joint.name}",
        )
        if isinstance(kind, HingeJoint):
            made._count_turns_from(joint.start)
        return made

    def _let_follow(self, joints: dict[str, Joint]) -> None:
        by_name = {joint.name: joint for joint in self._robot.joints}
        for joint in self._robot.joints:
            if joint.mimic is not None:
                leader, multiplier, offset = joint.mimic
                joints[joint.name].follow(
                    joints[leader],
                    multiplier=multiplier,
                    offset=offset,
                    max_force=joint.effort or by_name[leader].effort or MIMIC_EFFORT,
                )
