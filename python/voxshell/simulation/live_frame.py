"""The state of a world between two steps, as a live view shows it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell.errors import SettingsError
from voxshell.simulation.tables import as_contacts, compute_forces

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from voxshell import _bullet
    from voxshell.simulation.body import Body


@dataclass(frozen=True, eq=False)
class LiveFrame:
    """Bodies, contacts and energies of a world between two steps.

    Args:
        time: Simulated seconds.
        bodies: The bodies in the order of the arrays.
        poses: (n, 4, 4) ``world_from_body``, meters.
        points: (k, 3) meters, world frame: contact points on body b.
        normals: (k, 3) unit, world frame, toward body a.
        depths: (k,) meters, positive where bodies overlap.
        forces: (k, 3) newtons, world frame: normal force of each contact in the last step, on body
            a, or on body b if a is not dynamic.
        kinetic: Kinetic energy of all dynamic bodies, joules.
        potential: Their potential energy in gravity, joules; 0 at the world's origin.
    """

    time: float
    bodies: tuple[Body, ...]
    poses: NDArray[np.float64]
    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    depths: NDArray[np.float64]
    forces: NDArray[np.float64]
    kinetic: float
    potential: float


def take_frame(
    simulation: _bullet.Simulation,
    bodies: Sequence[Body],
    gravity: NDArray[np.float64],
    time_step: float,
) -> LiveFrame | None:
    """Read the state of a world; return None if another thread is removing a body.

    Args:
        simulation: The world's simulation.
        bodies: The world's bodies.
        gravity: (3,) m/s2, world frame.
        time_step: Seconds.
    """
    present = tuple(body for body in bodies if not body.removed)
    try:
        poses = np.array([simulation.pose(body.number) for body in present]).reshape(-1, 4, 4)
        kinetic, potential = _compute_energies(present, poses, gravity)
    except SettingsError:
        return None
    contacts = as_contacts(simulation.contacts())
    dynamic = [body.number for body in present if body.motion == "dynamic"]
    return LiveFrame(
        simulation.step_count() * time_step,
        present,
        poses,
        contacts["point_b"],
        contacts["normal"],
        contacts["depth"],
        compute_forces(contacts, dynamic, time_step),
        kinetic,
        potential,
    )


def _compute_energies(
    bodies: Sequence[Body], poses: NDArray[np.float64], gravity: NDArray[np.float64]
) -> tuple[float, float]:
    """Return kinetic and potential energy of the dynamic bodies, joules."""
    chosen = [index for index, body in enumerate(bodies) if body.motion == "dynamic"]
    if not chosen:
        return 0.0, 0.0
    moving = [bodies[index] for index in chosen]
    masses = np.array([body.mass for body in moving])
    turns = poses[chosen, :3, :3]
    centers = np.einsum("nij,nj->ni", turns, np.array([body._center for body in moving]))
    centers += poses[chosen, :3, 3]
    inertias = np.array([body._inertia for body in moving])
    velocities = np.array([body.linear_velocity for body in moving])
    spins = np.array([body.angular_velocity for body in moving])
    spins_body = np.einsum("nji,nj->ni", turns, spins)
    turning = np.einsum("ni,nij,nj->", spins_body, inertias, spins_body)
    kinetic = 0.5 * (masses @ (velocities**2).sum(axis=1) + turning)
    return float(kinetic), float(-masses @ (centers @ gravity))
