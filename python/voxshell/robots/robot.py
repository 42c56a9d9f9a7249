"""Robots: bodies and joints of a world by the names that their file gives them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from voxshell.errors import SettingsError

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np
    from numpy.typing import NDArray

    from voxshell.simulation.body import Body
    from voxshell.simulation.joints import Joint
    from voxshell.simulation.world import World


class RobotWarning(UserWarning):
    """A robot's file leaves out what a simulation needs, or holds what is not simulated.

    The message says what was taken instead, or lists what is left out.
    """


@dataclass(frozen=True, eq=False)
class Link:
    """A link of a robot. Links that fixed joints hold together are one body.

    Attributes:
        name: As in the file.
        body: What it is part of; None for links that are fixed to the world and have no surface.
        body_from_link: (4, 4) float64; without a body, ``world_from_link``.
        color: Red, green and blue, 0 to 255, of its first visual; None where the file gives none.
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
    """What the motor of a joint can do at most, as the file says; None where it does not."""

    effort: float | None
    velocity: float | None


class Robot:
    """A robot in a world; made by :func:`load_urdf` or :func:`load_mjcf`.

    Attributes:
        name: As in the file.
        links: All links, by name.
        joints: The joints that move along or about an axis, by name.
        ball_joints: The joints of type "spherical" or "ball", by name; they have no motor.
        bodies: What the links are made of.
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

        A body of several links has the color of the one nearest to the root. For
        :meth:`Recorder.recording` and :meth:`Recorder.save_html`.
        """
        colors: dict[Body, tuple[int, int, int]] = {}
        for link in self.links.values():
            if link.body is not None and link.color is not None:
                colors.setdefault(link.body, link.color)
        return colors

    @property
    def positions(self) -> dict[str, float]:
        """Of all joints that move, by name: radians or metres."""
        return {name: joint.position for name, joint in self.joints.items()}

    @property
    def velocities(self) -> dict[str, float]:
        """Of all joints that move, by name: rad/s or m/s."""
        return {name: joint.velocity for name, joint in self.joints.items()}

    def set_targets(
        self,
        positions: Mapping[str, float],
        *,
        max_force: float | None = None,
        max_speed: float | None = None,
    ) -> None:
        """Drives joints to positions and holds them there; others stay as they are driven.

        Args:
            positions: By the names of joints: radians or metres.
            max_force: Newton metres or newtons; by default the file's effort of each joint.
            max_speed: Rad/s or m/s; by default the file's velocity, without which there is no limit.

        Raises:
            SettingsError: There is no such joint, it mimics another, the position is beyond its limits, or
                neither the file nor the call says how strong it is.
        """
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
        """Drives joints at velocities; others stay as they are driven.

        Args:
            velocities: By the names of joints: rad/s or m/s.
            max_force: Newton metres or newtons; by default the file's effort of each joint.

        Raises:
            SettingsError: As for :meth:`set_targets`.
        """
        for name, velocity in velocities.items():
            self._driven(name).set_target_velocity(velocity, max_force=self._force(name, max_force))

    def release(self) -> None:
        """Turns the motors off, but for those of joints that mimic others."""
        for name, joint in self.joints.items():
            if name not in self._mimics:
                joint.release()

    def remove(self) -> None:
        """Takes the robot out of its world."""
        for part in (*self.joints.values(), *self.ball_joints.values(), *self.bodies):
            if not part.removed:
                self._world.remove(part)

    def _driven(self, name: str) -> Joint:
        if name not in self.joints:
            raise SettingsError(
                f"robot {self.name!r} has no joint {name!r} that moves; it has "
                f"{', '.join(map(repr, self.joints)) or 'none'}"
            )
        if name in self._mimics:
            raise SettingsError(f"joint {name!r} mimics another: drive that")
        return self.joints[name]

    def _force(self, name: str, given: float | None) -> float:
        force = self._strengths[name].effort if given is None else given
        if force is None:
            raise SettingsError(
                f"the file does not say how strong joint {name!r} is; pass max_force"
            )
        return force

    def _speed(self, name: str, given: float | None) -> float:
        speed = self._strengths[name].velocity if given is None else given
        return math.inf if speed is None else speed

    def __repr__(self) -> str:
        links, moving = len(self.links), len(self.joints)
        joints = "1 joint that moves" if moving == 1 else f"{moving} joints that move"
        return f"Robot({self.name!r}, {links} link{'' if links == 1 else 's'}, {joints})"
