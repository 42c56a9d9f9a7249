"""Bodies that are dragged by a mouse: a spring from the point that was grabbed to the pointer."""

from __future__ import annotations

import math
import threading
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell.errors import SettingsError

if TYPE_CHECKING:
    from collections.abc import Hashable

    from numpy.typing import NDArray

    from voxshell.simulation.body import Body

_SAG = 0.02
"""How far a body that hangs on the spring sinks in gravity, in diameters. Less makes the spring stiffer."""

_MOST_TURN_A_STEP = 0.2
"""Radians of the spring's oscillation in a step. Damping that is applied once a step diverges at 1."""

_CALMING = 2.0
"""1/s: how fast the rotation of a held body decays. Without it, the body would swing forever."""

_WITHOUT_GRAVITY = 9.81
"""m/s2, in place of gravity in worlds that have less."""


@dataclass(frozen=True, eq=False)
class Pull:
    """A critically damped spring between a point of a body and a target.

    Args:
        body: A dynamic body.
        point_body: (3,) meters, body frame: the point that was grabbed.
        target_world: (3,) meters, world frame: where the pointer is.
        frequency: rad/s of the spring.
        reach: Meters beyond which the force no longer grows.
    """

    body: Body
    point_body: NDArray[np.float64]
    target_world: NDArray[np.float64]
    frequency: float
    reach: float

    def compute_torque(self) -> NDArray[np.float64]:
        """The torque that slows the rotation of the body, (3,) N m, world frame."""
        turn = self.body.pose[:3, :3]
        spin = self.body.angular_velocity
        return -_CALMING * (turn @ (self.body._inertia @ (turn.T @ spin)))

    def compute_force(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The force on the body as it stands now.

        With the effective mass m of the body at the point, the stretch x towards the target and the velocity v of the
        point, the force is m (w^2 x - 2 w v), w being the frequency. The length of x counts up to the reach.

        Returns:
            (3,) newtons, world frame, and (3,) meters, world frame: the point that it acts on.
        """
        pose = self.body.pose
        point = pose[:3, :3] @ self.point_body + pose[:3, 3]
        stretch = self.target_world - point
        length = float(np.linalg.norm(stretch))
        if length > self.reach:
            stretch = stretch * (self.reach / length)
        mass = effective_mass(self.body, self.point_body)
        velocity = self.body.velocity_at(point)
        return mass * self.frequency * (self.frequency * stretch - 2.0 * velocity), point


class Pulls:
    """The pulls of a world, one for each hand that drags; may be used by several threads.

    Args:
        gravity: (3,) m/s2, world frame.
        time_step: Seconds.
    """

    def __init__(self, gravity: NDArray[np.float64], time_step: float) -> None:
        self._gravity = max(float(np.linalg.norm(gravity)), _WITHOUT_GRAVITY)
        self._time_step = time_step
        self._lock = threading.Lock()
        self._held: dict[Hashable, Pull] = {}

    def __len__(self) -> int:
        return len(self._held)

    def grab(
        self, hand: Hashable, body: Body, point_body: NDArray[np.float64], diameter: float
    ) -> None:
        """Takes hold of a body.

        Args:
            hand: Who drags; one hand holds one body.
            body: A dynamic body.
            point_body: (3,) meters, body frame.
            diameter: Of the body, meters.
        """
        pose = body.pose
        pull = Pull(
            body,
            np.array(point_body, np.float64),
            pose[:3, :3] @ point_body + pose[:3, 3],
            min(math.sqrt(self._gravity / (_SAG * diameter)), _MOST_TURN_A_STEP / self._time_step),
            diameter,
        )
        with self._lock:
            self._held[hand] = pull

    def move(self, hand: Hashable, target_world: NDArray[np.float64]) -> None:
        """Moves the target of a hand, (3,) meters, world frame; a hand that holds nothing is left alone."""
        with self._lock:
            pull = self._held.get(hand)
            if pull is not None:
                target = np.array(target_world, np.float64)
                self._held[hand] = Pull(
                    pull.body, pull.point_body, target, pull.frequency, pull.reach
                )

    def release(self, hand: Hashable) -> None:
        """Lets go of what a hand holds, if anything."""
        with self._lock:
            self._held.pop(hand, None)

    def release_all(self) -> None:
        """Lets go of everything."""
        with self._lock:
            self._held.clear()

    def apply(self) -> None:
        """Pulls during the next step; the thread that makes the step calls it."""
        for hand, pull in self._list():
            try:
                force, point = pull.compute_force()
                pull.body.apply_force(force, at=point)
                pull.body.apply_torque(pull.compute_torque())
            except SettingsError:  # the body has been removed
                self.release(hand)

    def find_lines(self) -> NDArray[np.float64]:
        """Where each spring begins and ends, (k, 2, 3) meters, world frame."""
        lines = []
        for hand, pull in self._list():
            try:
                pose = pull.body.pose
            except SettingsError:
                self.release(hand)
                continue
            point = pose[:3, :3] @ pull.point_body + pose[:3, 3]
            lines.append((point, pull.target_world))
        return np.array(lines).reshape(-1, 2, 3)

    def _list(self) -> list[tuple[Hashable, Pull]]:
        with self._lock:
            return list(self._held.items())


def effective_mass(body: Body, point_body: NDArray[np.float64]) -> float:
    """The mass that a push at a point of a body meets, kilograms, averaged over all directions.

    A push at the center of mass meets the whole mass; elsewhere the body also turns, and resists less.

    Args:
        body: A dynamic body.
        point_body: (3,) meters, body frame.

    Example:
        >>> import numpy as np
        >>> import voxshell as vx
        >>> ball = vx.World().add(vx.Sphere(0.1), mass=2.0)
        >>> round(effective_mass(ball, np.zeros(3)), 6), round(effective_mass(ball, np.array((0.1, 0, 0))), 6)
        (2.0, 0.75)
    """
    lever = point_body - body._center
    skew = np.array(
        [
            [0.0, -lever[2], lever[1]],
            [lever[2], 0.0, -lever[0]],
            [-lever[1], lever[0], 0.0],
        ]
    )
    yielding = 3.0 / body.mass + np.trace(skew @ np.linalg.solve(body._inertia, skew.T))
    return 3.0 / float(yielding)
