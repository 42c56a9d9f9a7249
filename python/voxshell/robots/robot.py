"""Robots: bodies and joints of a world by their names in a file."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from voxshell.base.calls import explain_calls
from voxshell.errors import InputTypeError, SettingsError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from voxshell.simulation.body import Body
    from voxshell.simulation.joints import Joint
    from voxshell.simulation.world import World


class RobotWarning(UserWarning):
    """A robot's file lacks what a simulation needs, or contains what is not simulated.

    The message says what was used instead, or lists what is not simulated.
    """


@dataclass(frozen=True, eq=False)
class Link:
    """A link of a robot. Links that fixed joints hold together are one body.

    Attributes:
        name: As in the file.
        body: The body that it is part of; None if it is fixed to the world and has no surface.
        body_from_link: (4, 4) float64; without a body, ``world_from_link``.
        color: Red, green and blue, 0 to 255, of its first visual; None if the file states none.
    """

    name: str
    body: Body | None
    body_from_link: NDArray[np.float64]
    color: tuple[int, int, int] | None

    @property
    def pose(self) -> NDArray[np.float64]:
        """``world_from_link``, (4, 4) float64."""
        return self.body_from_link if self.body is None else self.body.pose @ self.body_from_link


@dataclass(frozen=True)
class Strength:
    """Effort and velocity limits of a joint's motor from the file; None if it states none."""

    effort: float | None
    velocity: float | None


@explain_calls
class Robot:
    """A robot in a world; made by :func:`load_urdf` or :func:`load_mjcf`.

    Attributes:
        name: As in the file.
        links: All links, by name.
        joints: The joints that move along or about an axis, by name.
        ball_joints: The joints of type "spherical" or "ball", by name; they have no motor.
        bodies: The bodies of the links.
    """

    __slots__ = (
        "_mimics",
        "_strengths",
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
        strengths: dict[str, Strength],
        mimics: frozenset[str],
    ) -> None:
        self._world = world
        self._strengths = strengths
        self._mimics = mimics
        self.name: str = name
        self.links: dict[str, Link] = links
        self.joints: dict[str, Joint] = joints
        self.ball_joints: dict[str, Joint] = ball_joints
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
    def positions(self) -> dict[str, float]:
        """Positions of all moving joints, by name: radians or meters."""
        return {name: joint.position for name, joint in self.joints.items()}

    @property
    def velocities(self) -> dict[str, float]:
        """Velocities of all moving joints, by name: rad/s or m/s."""
        return {name: joint.velocity for name, joint in self.joints.items()}

    def set_targets(
        self,
        positions: Mapping[str, float],
        *,
        max_force: float | None = None,
        max_speed: float | None = None,
    ) -> None:
        """Drive joints to positions and hold them there; other joints keep their targets.

        Args:
            positions: Radians or meters, by the names of joints.
            max_force: Newton meters or newtons; by default each joint's effort in the file.
            max_speed: Rad/s or m/s; by default each joint's velocity in the file, or no limit
                without one.

        Raises:
            InputTypeError: ``positions`` does not map names to numbers.
            SettingsError: There is no such joint, it mimics another, the position is beyond its
                limits, or neither the file nor ``max_force`` states its effort.

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
        check_names(positions, "positions")
        for name, position in positions.items():
            joint = self._driven(name)
            joint.set_target_position(
                position,
                max_force=self._force(name, max_force),
                max_speed=self._speed(name, max_speed),
            )

    def set_target_velocities(
        self, velocities: Mapping[str, float], *, max_force: float | None = None
    ) -> None:
        """Drive joints at velocities; other joints keep their targets.

        Args:
            velocities: Rad/s or m/s, by the names of joints.
            max_force: Newton meters or newtons; by default each joint's effort in the file.

        Raises:
            InputTypeError: ``velocities`` does not map names to numbers.
            SettingsError: As for :meth:`set_targets`.
        """
        check_names(velocities, "velocities")
        for name, velocity in velocities.items():
            self._driven(name).set_target_velocity(velocity, max_force=self._force(name, max_force))

    def release(self) -> None:
        """Turn off all motors, except those of joints that mimic others."""
        for name, joint in self.joints.items():
            if name not in self._mimics:
                joint.release()

    def remove(self) -> None:
        """Remove the robot from its world."""
        for part in (*self.joints.values(), *self.ball_joints.values(), *self.bodies):
            if not part.removed:
                self._world.remove(part)

    def _driven(self, name: str) -> Joint:
        if name not in self.joints:
            raise SettingsError(
                f"robot {self.name!r} has no moving joint {name!r}; it has "
                f"{', '.join(map(repr, self.joints)) or 'none'}"
            )
        if name in self._mimics:
            raise SettingsError(f"joint {name!r} mimics another joint: drive that one")
        return self.joints[name]

    def _force(self, name: str, given: float | None) -> float:
        force = self._strengths[name].effort if given is None else given
        if force is None:
            raise SettingsError(f"the file states no effort for joint {name!r}; pass max_force")
        return force

    def _speed(self, name: str, given: float | None) -> float:
        speed = self._strengths[name].velocity if given is None else given
        return math.inf if speed is None else speed

    def __repr__(self) -> str:
        links, moving = len(self.links), len(self.joints)
        joints = "1 joint that moves" if moving == 1 else f"{moving} joints that move"
        return f"Robot({self.name!r}, {links} link{'' if links == 1 else 's'}, {joints})"


def check_names(targets: Mapping[str, float], name: str) -> None:
    """Refuse an argument that does not map the names of joints to numbers.

    Raises:
        InputTypeError: It does not.
    """
    if not isinstance(targets, Mapping):
        raise InputTypeError(
            f"{name} must map the names of joints to numbers, as in {{'elbow': 0.5}}, not "
            f"{type(targets).__name__}"
        )
