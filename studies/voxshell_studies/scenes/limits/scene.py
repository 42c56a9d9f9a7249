"""A scene of the study of limits, and how its worlds are made.

Meters, kilograms, seconds, radians; z is up.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from voxshell.model.shapes import Plane
from voxshell.simulation.world import World
from voxshell_studies.everyday.worlds import build_model
from voxshell_studies.scenes.everyday.forms import PLANE, matter
from voxshell_studies.scenes.everyday.scene import RATES, Form, Vector

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from voxshell.simulation.body import Body
    from voxshell.simulation.body_shapes import Shape

G = 9.81
"""Gravity, m/s2."""


@dataclass(frozen=True, eq=False)
class LimitScene:
    """A scene and the one number that it yields at each rate.

    Attributes:
        name: Unique.
        group: Row of the page of limits that the scene is about.
        measured: What the number is, in words.
        unit: Unit of the number; "" for pure numbers.
        truth: What it should be.
        run: Runs the scene at a rate, steps per second, in a placement, and returns the number.
        rates: Steps per second.
        placements: Number of placements; the first is 0.
        cost: Approximate time of a run at 200 Hz, seconds, only for progress displays.
        timed: Whether the number is a time, so that nothing else may run at the same time.
    """

    name: str
    group: str
    measured: str
    unit: str
    truth: float
    run: Callable[[float, int], float]
    rates: tuple[float, ...] = RATES
    placements: int = 1
    cost: float = 0.5
    timed: bool = False


def open_world(rate: float, gravity: Vector = (0.0, 0.0, -G)) -> World:
    """Return an empty world at its defaults."""
    return World(gravity=gravity, time_step=1.0 / rate)


def put(
    world: World,
    shape: Form | Shape,
    pose: NDArray[np.float64] | None = None,
    mass: float = 0.0,
    *,
    friction: float = 0.5,
    restitution: float = 0.0,
    velocity: Vector = (0.0, 0.0, 0.0),
    spin: Vector = (0.0, 0.0, 0.0),
    driven: bool = False,
) -> Body:
    """Add a body.

    Args:
        world: The world.
        shape: A form, which becomes a model at default settings, or a shape of Bullet's.
        pose: ``world_from_body``, (4, 4).
        mass: Kilograms; 0 for a body that does not move.
        friction: Coulomb coefficient between bodies with equal values.
        restitution: Likewise.
        velocity: Of the center of mass, m/s.
        spin: Angular velocity, rad/s.
        driven: Whether the body is kinematic.
    """
    form = shape if isinstance(shape, Form) else None
    body = world.add(
        _build_shape(shape) if isinstance(shape, Form) else shape,
        mass=mass,
        pose=np.eye(4) if pose is None else pose,
        # Bullet multiplies the coefficients of two bodies.
        friction=math.sqrt(friction),
        restitution=math.sqrt(restitution),
        motion="kinematic" if driven else None,
        inertia=matter(form, mass) if form is not None and mass > 0.0 else "solid",
    )
    if mass > 0.0 and not driven:
        body.linear_velocity = velocity
        body.angular_velocity = spin
    return body


def _build_shape(form: Form) -> Shape:
    return Plane((0.0, 0.0, 1.0), 0.0) if form is PLANE else build_model(form)


def count_steps(rate: float, seconds: float) -> int:
    """Return the number of steps of a duration, at least one.

    Example:
        >>> count_steps(30.0, 0.5), count_steps(30.0, 0.001)
        (15, 1)
    """
    return max(round(seconds * rate), 1)


def time_steps(world: World, rate: float, seconds: float) -> float:
    """Step, and return the time of the longest step but the first, milliseconds."""
    world.step()
    longest = 0.0
    for _ in range(count_steps(rate, seconds)):
        start = time.perf_counter()
        world.step()
        longest = max(longest, time.perf_counter() - start)
    return 1e3 * longest


def fallen_way(rate: float, seconds: float) -> float:
    """Return how far a free body falls from rest in Euler steps, meters.

    Example:
        >>> round(fallen_way(1000.0, 1.0), 3), round(fallen_way(30.0, 1.0), 3)
        (4.91, 5.069)
    """
    steps = count_steps(rate, seconds)
    return 0.5 * G * steps * (steps + 1) / rate**2
