"""Dragging bodies with the mouse: a spring pulls the grabbed point to the pointer."""

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
"""Sag of a body that hangs on the spring, in diameters. A smaller sag makes the spring stiffer."""

_MOST_TURN_A_STEP = 0.2
"""Phase of the spring's oscillation per step, radians. With damping once per step, 1 diverges."""

_CALMING = 2.0
"""Decay rate of a held body's rotation, 1/s. Without it, the body would swing forever."""

_WITHOUT_GRAVITY = 9.81
"""Smallest acceleration for the choice of stiffness, m/s2; worlds may have less gravity."""


@dataclass(frozen=True, eq=False)
class Pull:
    """A critically damped spring between a point of a body and a target.

    Args:
        body: A dynamic body.
        point_body: (3,) meters, body frame: the grabbed point.
        target_world: (3,) meters, world frame: the pointer.
        frequency: Angular frequency of the spring, rad/s.
        reach: Stretch beyond which the force does not grow, meters.
    """

    body: Body
    point_body: NDArray[np.float64]
    target_world: NDArray[np.float64]
    frequency: float
    reach: float

    def compute_torque(self) -> NDArray[np.float64]:
        """Return the torque that slows the rotation of the body, (3,) N m, world frame."""
        turn = self.body.pose[:3, :3]
        spin = self.body.angular_velocity
        return -_CALMING * (turn @ (self.body._inertia @ (turn.T @ spin)))

    def compute_force(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the force on the body in its present state.

        The force is m (w^2 x - 2 w v). Here m is the effective mass of the body at the point, x the
        stretch toward the target, v the velocity of the point and w the frequency. The length of x
        is limited to the reach.

        Returns:
            The force, (3,) newtons, and the point where it acts, (3,) meters; world frame.
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
    """All pulls of a world, one for each hand that drags; threads may share it.

    Args:
        time_step: Seconds.
    """

    def __init__(self, time_step: float) -> None:
        self._time_step = time_step
        self._lock = threading.Lock()
        self._held: dict[Hashable, Pull] = {}

    def __len__(self) -> int:
        return len(self._held)

    def grab(
        self, hand: Hashable, body: Body, point_body: NDArray[np.float64], diameter: float
    ) -> None:
        """Grab a body.

        Args:
            hand: Identifies who drags; one hand holds one body.
            body: A dynamic body.
            point_body: (3,) meters, body frame.
            diameter: The body's diameter, meters.
        """
        pose = body.pose
        gravity = max(float(np.linalg.norm(body._simulation.gravity())), _WITHOUT_GRAVITY)
        pull = Pull(
            body,
            np.array(point_body, np.float64),
            pose[:3, :3] @ point_body + pose[:3, 3],
            min(math.sqrt(gravity / (_SAG * diameter)), _MOST_TURN_A_STEP / self._time_step),
            diameter,
        )
        with self._lock:
            self._held[hand] = pull

    def move(self, hand: Hashable, target_world: NDArray[np.float64]) -> None:
        """Move the target of a hand, (3,) meters, world frame; ignore a hand that holds nothing."""
        with self._lock:
            pull = self._held.get(hand)
            if pull is not None:
                target = np.array(target_world, np.float64)
                self._held[hand] = Pull(
                    pull.body, pull.point_body, target, pull.frequency, pull.reach
                )

    def release(self, hand: Hashable) -> None:
        """Release the body that a hand holds, if any."""
        with self._lock:
            self._held.pop(hand, None)

    def release_all(self) -> None:
        """Release all bodies."""
        with self._lock:
            self._held.clear()

    def apply(self) -> None:
        """Apply all forces for the next step; the thread that makes the step calls this."""
        for hand, pull in self._list():
            try:
                force, point = pull.compute_force()
                pull.body.apply_force(force, at=point)
                pull.body.apply_torque(pull.compute_torque())
            except SettingsError:  # the body was removed
                self.release(hand)

    def find_lines(self) -> NDArray[np.float64]:
        """Return both ends of each spring, (k, 2, 3) meters, world frame."""
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
    """Return the effective mass at a point of a body, kilograms, averaged over all directions.

    At the center of mass, this is the mass. Elsewhere the body also turns, and resists less.

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
