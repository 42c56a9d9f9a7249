"""What Bullet cannot move: refused where it is known before a step, and told of after one."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from voxshell import _bullet
from voxshell.errors import SettingsError, SimulationError
from voxshell.model.accuracy import AccuracyWarning

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike

    from voxshell.simulation.body import Body

_LEAST_MASS = 1e-100  # kg; the inverse of a far smaller one is not finite


def check_mass(kilograms: float, label: str) -> None:
    """Refuses masses under which bodies pass through others or become NaN.

    Raises:
        SettingsError: It is one of them.
    """
    if kilograms > _bullet.most_mass:
        raise SettingsError(
            f"mass of {label} is {kilograms:g} kg, and Bullet lets what is above "
            f"{_bullet.most_mass:g} kg through all others; give less, or 0 for a body that nothing moves"
        )
    if 0.0 < kilograms < _LEAST_MASS:
        raise SettingsError(
            f"mass of {label} is {kilograms:g} kg; give at least {_LEAST_MASS:g} kg, or 0 for a body that "
            "nothing moves"
        )


def check_extent(low_and_high: ArrayLike, label: str) -> None:
    """Refuses moving bodies that are too large.

    Args:
        low_and_high: Corners of the body's box, (2, 3), metres.
        label: What errors call the body.

    Raises:
        SettingsError: Bullet would leave it where it is.
    """
    extent = float(np.linalg.norm(np.ptp(low_and_high, axis=0)))
    if extent > _bullet.most_extent:
        raise SettingsError(
            f"{label} has a box with a diagonal of {extent:g} m, and Bullet moves none of more than "
            f"{_bullet.most_extent:g} m; scale the scene down, or pass motion='static'"
        )


def check_fall(gravity: ArrayLike, time_step: float) -> None:
    """Refuses gravity that moves bodies too far in their first step.

    Raises:
        SettingsError: Bullet would leave them where they are.
    """
    way = float(np.linalg.norm(gravity)) * time_step * time_step  # ** raises OverflowError
    if not way <= _bullet.most_way:
        raise SettingsError(
            f"gravity moves bodies by {way:.3g} m in the first step of {time_step:g} s, and at most "
            f"{_bullet.most_way:g} m can be followed; use a shorter time_step, or less gravity"
        )


def check_motions(simulation: _bullet.Simulation, bodies: Iterable[Body], advice: str) -> None:
    """After a step: warns of bodies that move or turn too far, once a body.

    Args:
        simulation: That made the step.
        bodies: Of the simulation.
        advice: What else to do about motions that are not finite, or nothing.

    Raises:
        SimulationError: A pose or velocity is not finite.
    """
    lost = simulation.find_lost_body()
    spins, ways = simulation.take_fast_spins(), simulation.take_long_ways()
    if lost is None and not spins and not ways:
        return
    names = {body.number: body.name for body in bodies}
    if lost is not None:
        raise SimulationError(
            f"the simulation has diverged: the pose or velocity of {names[lost]!r} is no longer finite; "
            f"lower forces and velocities, or use a shorter time_step{advice}"
        )
    for number, turn in spins:
        warnings.warn(
            f"{names[number]!r} turns by {turn:.3g} rad a step; contacts are looked for as if "
            f"bodies turned by at most an eighth of a turn, {_bullet.most_turn:.3f} rad, and may "
            "be missed: use a shorter time_step",
            AccuracyWarning,
            stacklevel=3,
        )
    for number, way in ways:
        warnings.warn(
            f"{names[number]!r} moves by {way:.3g} m a step, more than {_bullet.most_way:g} m; Bullet "
            "leaves what moves by 1e+06 m where it is: use a shorter time_step, or lower velocities",
            AccuracyWarning,
            stacklevel=3,
        )
