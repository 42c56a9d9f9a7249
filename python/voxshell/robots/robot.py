"""Robots: bodies and joints of a world by their names in a file."""

from __future__ import annotations

import math
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING

from voxshell.base.arguments import show_apart, show_value
from voxshell.base.calls import explain_calls
from voxshell.base.near_names import know_near_names, suggest_on_set
from voxshell.base.notebook import make_table
from voxshell.base.poses import invert
from voxshell.errors import SettingsError
from voxshell.robots.kinematics import find_child, find_twists
from voxshell.robots.link import Link, find_twist
from voxshell.robots.named_parts import NamedParts
from voxshell.robots.starts import (
    HELD_WITHIN,
    as_positions,
    clamp,
    complete_positions,
    complete_velocities,
    follow,
    refuse_beyond,
)
from voxshell.simulation.joint_kinds import HingeJoint

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from voxshell.robots.description import JointDescription
    from voxshell.simulation.body import Body
    from voxshell.simulation.joints import Joint
    from voxshell.simulation.world import World


@explain_calls
@know_near_names
@suggest_on_set
class Robot:
    """A robot in a world; made by :func:`load_urdf` or :func:`load_mjcf`.

    Attributes:
        name: As in the file.
        links: All links, by name. A KeyError states which names there are.
        joints: The joints that move along or about an axis, by name.
        ball_joints: The joints of type "spherical" or "ball", by name; they have no motor.
        bodies: The bodies of the links.
    """

    __slots__ = (
        "_described",
        "_world",
        "ball_joints",
        "bodies",
        "joints",
        "links",
        "name",
    )

    def __init__(
        self,
        world: World,
        name: str,
        links: dict[str, Link],
        joints: dict[str, Joint],
        ball_joints: dict[str, Joint],
        described: Iterable[JointDescription],
    ) -> None:
        self._world = world
        self._described = {
            joint.name: joint for joint in described
        }  # each before those of its child
        self.name: str = name
        owner = f"robot {name!r}"
        self.links: dict[str, Link] = NamedParts(links, owner, "link")
        self.joints: dict[str, Joint] = NamedParts(joints, owner, "moving joint")
        self.ball_joints: dict[str, Joint] = NamedParts(ball_joints, owner, "ball joint")
        self.bodies: list[Body] = []
        for link in links.values():
            if link.body is not None and link.body not in self.bodies:
                self.bodies.append(link.body)

    @property
    def colors(self) -> dict[Body, tuple[int, int, int]]:
        """Red, green and blue, 0 to 255, of the bodies whose links have a color in the file.

        A body of several links has the color of the one nearest to the root. Pass this to
        :meth:`Recorder.recording` and :meth:`Recorder.save_html`.
        """
        colors: dict[Body, tuple[int, int, int]] = {}
        for link in self.links.values():
            if link.body is not None and link.color is not None:
                colors.setdefault(link.body, link.color)
        return colors

    @property
    def positions(self) -> Mapping[str, float]:
        """Present positions of all moving joints, by name: radians or meters; read-only.

        :meth:`set_targets` drives joints to positions, and :meth:`set_positions` puts them there.
        """
        return MappingProxyType({name: joint.position for name, joint in self.joints.items()})

    @property
    def velocities(self) -> Mapping[str, float]:
        """Present velocities of all moving joints, by name: rad/s or m/s; read-only.

        :meth:`set_target_velocities` drives joints at velocities, and :meth:`set_velocities` gives them
        velocities at once.
        """
        return MappingProxyType({name: joint.velocity for name, joint in self.joints.items()})

    def set_positions(self, positions: Mapping[str, float]) -> None:
        """Put joints at positions at once and at rest, as for a new episode; nothing is hit.

        Other joints keep their positions, except that joints which mimic one of these are put where it
        puts them. The links that joints connect to these come to rest, and the root keeps its pose.
        Motors keep their targets, so set those, too.

        Args:
            positions: Radians or meters, by the names of joints.

        Raises:
            InputTypeError: ``positions`` does not map names to numbers.
            SettingsError: There is no such joint, or the position is beyond its limits.

        Example:
            >>> import pathlib, tempfile
            >>> import voxshell as vx
            >>> text = '''
            ... <robot name="pendulum">
            ...   <link name="hook"/>
            ...   <link name="bob"><inertial>
            ...     <origin xyz="0 0 -0.5"/><mass value="1"/>
            ...     <inertia ixx="0.004" iyy="0.004" izz="0.004" ixy="0" ixz="0" iyz="0"/>
            ...   </inertial></link>
            ...   <joint name="pivot" type="continuous">
            ...     <parent link="hook"/><child link="bob"/><axis xyz="0 1 0"/>
            ...   </joint>
            ... </robot>'''
            >>> world = vx.World()
            >>> with tempfile.TemporaryDirectory() as folder:
            ...     path = pathlib.Path(folder, "pendulum.urdf")
            ...     _ = path.write_text(text)
            ...     robot = vx.load_urdf(world, path)
            >>> robot.set_positions({"pivot": 0.5})
            >>> round(robot.positions["pivot"], 6), robot.velocities["pivot"]
            (0.5, 0.0)
        """
        given = as_positions(positions)
        described = self._described.values()
        found = complete_positions(described, given, f"joints of robot {self.name!r}")
        before = {name: link.pose for name, link in self.links.items()}
        after = dict(before)
        tops = {name: name for name in self.links}  # of the tree of each link
        for joint in described:
            if joint.type == "floating":
                continue
            tops[joint.child] = tops[joint.parent]
            if joint.name in found:
                parent_from_child = find_child(joint, found[joint.name])
            else:
                parent_from_child = invert(before[joint.parent]) @ before[joint.child]
            after[joint.child] = after[joint.parent] @ parent_from_child
        moved = {tops[self._described[name].child] for name in found}
        placed: set[Body] = set()
        for name, link in self.links.items():
            if link.body is None or link.body in placed or link.body.motion == "static":
                continue
            placed.add(link.body)
            if tops[name] in moved:
                link.body.place(after[name] @ invert(link.body_from_link))
        for name, position in found.items():
            if isinstance(self.joints[name].kind, HingeJoint):
                self.joints[name]._count_turns_from(position)

    def set_velocities(self, velocities: Mapping[str, float]) -> None:
        """Give joints velocities at once, as for a new episode that begins in motion.

        Other joints keep their velocities, except that joints which mimic one of these move along with
        it. The root keeps its own motion, so a root that is not fixed needs no velocity here. Motors
        keep their targets: without a motor or with one that has the same target velocity, a joint moves on.
        Call :meth:`set_positions` first, because it brings the robot to rest.

        Args:
            velocities: Rad/s or m/s, by the names of joints.

        Raises:
            InputTypeError: ``velocities`` does not map names to numbers.
            SettingsError: There is no such joint.

        Example:
            >>> import pathlib, tempfile
            >>> import voxshell as vx
            >>> text = '''
            ... <robot name="mast">
            ...   <link name="foot"/>
            ...   <link name="arm"><inertial><origin xyz="0.5 0 0"/><mass value="1"/>
            ...     <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
            ...   <joint name="turn" type="continuous">
            ...     <parent link="foot"/><child link="arm"/><axis xyz="0 0 1"/>
            ...   </joint>
            ... </robot>'''
            >>> with tempfile.TemporaryDirectory() as folder:
            ...     path = pathlib.Path(folder, "mast.urdf")
            ...     _ = path.write_text(text)
            ...     robot = vx.load_urdf(vx.World(), path)
            >>> robot.set_positions({"turn": 0.0})
            >>> robot.set_velocities({"turn": 2.0})
            >>> robot.velocities["turn"], robot.links["arm"].body.linear_velocity.round(9) + 0.0
            (2.0, array([0., 1., 0.]))
        """
        owner = f"joints of robot {self.name!r}"
        described = self._described.values()
        given = as_positions(velocities, "velocities")
        found = complete_velocities(described, given, self.positions, owner)
        poses = {name: link.pose for name, link in self.links.items()}
        twists = {name: find_twist(link) for name, link in self.links.items()}
        moved: set[Body] = set()
        for name, twist in find_twists(described, found, poses, twists).items():
            body = self.links[name].body
            if body is None or body in moved or body.motion != "dynamic":
                continue
            moved.add(body)
            body.angular_velocity = twist.angular
            body.linear_velocity = twist.linear_at(body.center_of_mass)

    def set_targets(
        self,
        positions: Mapping[str, float],
        *,
        max_force: float | None = None,
        max_speed: float | None = None,
        velocities: Mapping[str, float] | None = None,
    ) -> None:
        """Drive joints to positions and hold them there; other joints keep their targets.

        To follow a motion without lag, set the present positions of the motion and its velocities
        before each step; see :meth:`Joint.set_target_position`.

        Any positions that the robot had are valid, so ``robot.set_targets(robot.positions)`` holds it
        where it is: a joint that was pressed against its limit, and reads up to 0.001 more, is driven to
        the limit. A joint that mimics another may be named if the position is that which it has, or is to
        have, by the other one. After an exception, no target has changed.

        Args:
            positions: Radians or meters, by the names of joints.
            max_force: Newton meters or newtons; by default each joint's effort in the file.
            max_speed: Rad/s or m/s; by default each joint's velocity in the file, or no limit
                without one.
            velocities: Velocities of the targets, rad/s or m/s, by the names of joints that
                ``positions`` names, too; 0 for the others. Joints that mimic others need none.

        Raises:
            InputTypeError: ``positions`` or ``velocities`` does not map names to numbers.
            SettingsError: There is no such joint, the position is beyond its limits, it mimics another
                joint and would have another position, or neither the file nor ``max_force`` states its
                effort. Or ``velocities`` names a joint without a position.

        Example:
            >>> import pathlib, tempfile
            >>> import voxshell as vx
            >>> text = '''
            ... <robot name="mast">
            ...   <link name="foot"/>
            ...   <link name="arm">
            ...     <inertial>
            ...       <mass value="1"/>
            ...       <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>
            ...     </inertial>
            ...   </link>
            ...   <joint name="turn" type="continuous">
            ...     <parent link="foot"/><child link="arm"/><axis xyz="0 0 1"/>
            ...   </joint>
            ... </robot>'''
            >>> world = vx.World()
            >>> with tempfile.TemporaryDirectory() as folder:
            ...     path = pathlib.Path(folder, "mast.urdf")
            ...     _ = path.write_text(text)
            ...     robot = vx.load_urdf(world, path)
            >>> robot.set_targets({"turn": 0.5}, max_force=50.0)
            >>> world.step(200)
            >>> round(robot.joints["turn"].position, 3)
            0.5
        """
        targets = as_positions(positions)
        speeds = {} if velocities is None else as_positions(velocities, "velocities")
        for name in speeds:
            if name not in targets:
                raise SettingsError(
                    f"velocities names {show_value(name)}, but positions does not: pass both, or call "
                    "set_target_velocities()"
                )
        drives: list[Callable[[], None]] = []
        for name, target in targets.items():
            joint = self._find(name)
            described = self._described[name]
            if described.mimic is not None:
                self._check_follower(described, targets)
                continue
            held = clamp(target, described.limits)
            if not (_is_held(target, held) or _is_held(target, joint.position)):
                raise refuse_beyond(described, target)
            motor = joint._make_position_motor(
                held,
                max_force=self._force(name, max_force),
                max_speed=self._speed(name, max_speed),
                velocity=speeds.get(name, 0.0),
            )
            drives.append(partial(joint._drive, motor))
        for drive in drives:
            drive()

    def set_target_velocities(
        self, velocities: Mapping[str, float], *, max_force: float | None = None
    ) -> None:
        """Drive joints at velocities; other joints keep their targets.

        After an exception, no target has changed.

        Args:
            velocities: Rad/s or m/s, by the names of joints.
            max_force: Newton meters or newtons; by default each joint's effort in the file.

        Raises:
            InputTypeError: ``velocities`` does not map names to numbers.
            SettingsError: There is no such joint, it mimics another, or neither the file nor
                ``max_force`` states its effort.
        """
        drives: list[Callable[[], None]] = []
        for name, velocity in as_positions(velocities, "velocities").items():
            joint = self._find(name)
            if self._described[name].mimic is not None:
                raise SettingsError(f"joint {name!r} mimics another joint: drive that one")
            force = self._force(name, max_force)
            motor = joint._make_velocity_motor(velocity, max_force=force)
            drives.append(partial(joint._drive, motor))
        for drive in drives:
            drive()

    def release(self) -> None:
        """Turn off all motors, except those of joints that mimic others."""
        for name, joint in self.joints.items():
            if self._described[name].mimic is None:
                joint.release()

    def remove(self) -> None:
        """Remove the robot from its world."""
        for part in (*self.joints.values(), *self.ball_joints.values(), *self.bodies):
            if not part.removed:
                self._world.remove(part)

    def _find(self, name: str) -> Joint:
        if name not in self.joints:
            raise SettingsError(
                f"robot {self.name!r} has no moving joint {name!r}; it has "
                f"{', '.join(map(repr, self.joints)) or 'none'}"
            )
        return self.joints[name]

    def _check_follower(self, joint: JointDescription, targets: Mapping[str, float]) -> None:
        """Refuse a target of a joint that mimics another, unless it will be or is there anyway."""
        assert joint.mimic is not None
        target, leader = targets[joint.name], joint.mimic[0]
        if _is_held(target, self.joints[joint.name].position):
            return
        if leader not in targets:
            raise SettingsError(
                f"joint {joint.name!r} mimics another joint, {leader!r}: drive that one"
            )
        expected = follow(joint, targets)
        if not _is_held(target, expected):
            given, other = show_apart(target, expected)
            raise SettingsError(
                f"joint {joint.name!r} mimics another joint, {leader!r}, whose target puts it at {other}, not "
                f"at {given}: leave it out"
            )

    def _force(self, name: str, given: float | None) -> float:
        described = self._described[name]
        force = described.effort if given is None else given
        if force is None:
            raise SettingsError(
                f"the file {described.no_effort} for joint {name!r}; pass max_force"
            )
        return force

    def _speed(self, name: str, given: float | None) -> float:
        speed = self._described[name].velocity if given is None else given
        return math.inf if speed is None else speed

    def _repr_html_(self) -> str:
        """Return a table of the joints that move, for notebooks."""
        facts = {"links": f"{len(self.links)}"}
        for name, joint in self.joints.items():
            unit = "rad" if isinstance(joint.kind, HingeJoint) else "m"
            facts[f"joint {name!r}"] = (
                "removed" if joint.removed else f"{joint.position:.4g} {unit}"
            )
        return make_table(f"Robot {self.name!r}", facts)

    def __repr__(self) -> str:
        links, moving = len(self.links), len(self.joints)
        joints = "1 joint that moves" if moving == 1 else f"{moving} joints that move"
        return f"Robot({self.name!r}, {links} link{'' if links == 1 else 's'}, {joints})"


def _is_held(position: float, other: float) -> bool:
    """Return whether two positions are the same as exactly as a simulation holds joints."""
    return abs(position - other) <= HELD_WITHIN
