"""Limits of Bullet: errors before a step where possible, and warnings after a step."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from voxshell import _bullet
from voxshell.base.arguments import as_vector, show_value
from voxshell.base.user_warnings import UnitWarning, warn_user
from voxshell.errors import SettingsError, SimulationError
from voxshell.model.accuracy import AccuracyWarning

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import ArrayLike

    from voxshell.simulation.body import Body

_LEAST_MASS = 1e-100  # kg; the inverse of a much smaller mass is not finite
_OF_THE_EARTH = 9.81  # m/s2
_STRONGEST = 1000.0  # m/s2; stronger gravity is nearly always in mm/s2
_LONGEST_STEP = 1.0  # seconds; a longer time step is nearly always a number of steps a second
_COARSE_STEP = 1.0 / 20.0  # seconds; in a longer one, a body falls by more than 25 mm from rest


def check_mass(kilograms: float, label: str) -> None:
    """Refuse masses with which bodies pass through others or become NaN.

    Raises:
        SettingsError: The mass is out of range.
    """
    if kilograms > _bullet.most_mass:
        raise SettingsError(
            f"mass of {label} is {kilograms:g} kg; above {_bullet.most_mass:g} kg, bodies pass "
            "through all others in Bullet; use a smaller mass, or 0 for a static body"
        )
    if 0.0 < kilograms < _LEAST_MASS:
        raise SettingsError(
            f"mass of {label} is {kilograms:g} kg; use at least {_LEAST_MASS:g} kg, or 0 for a "
            "static body"
        )


def check_extent(low_and_high: ArrayLike, label: str) -> None:
    """Refuse moving bodies that are too large.

    Args:
        low_and_high: Corners of the body's box, (2, 3), meters.
        label: The body's name in error messages.

    Raises:
        SettingsError: Bullet would not move the body.
    """
    extent = float(np.linalg.norm(np.ptp(low_and_high, axis=0)))
    if extent > _bullet.most_extent:
        raise SettingsError(
            f"{label} has a box with a diagonal of {extent:g} m; Bullet does not move bodies of more than "
            f"{_bullet.most_extent:g} m; scale the scene down, or pass motion='static'"
        )


def as_gravity(gravity: ArrayLike) -> tuple[float, float, float]:
    """Return a gravity as three numbers, m/s2.

    Raises:
        SettingsError: It is not three finite numbers.
    """
    return as_vector(gravity, "gravity", " in m/s2, such as (0, 0, -9.81)")


def doubt_gravity(gravity: ArrayLike) -> None:
    """Warn of a gravity that is probably in millimeters."""
    strength = float(np.linalg.norm(gravity))
    if strength > _STRONGEST:
        warn_user(
            f"gravity is {strength:g} m/s2, {strength / _OF_THE_EARTH:.0f} times that of the Earth: lengths are in "
            "meters; for the Earth's gravity, pass (0, 0, -9.81)",
            UnitWarning,
        )


def check_time_step(time_step: float, gravity: ArrayLike) -> None:
    """Refuse a time step in which gravity moves bodies too far, and warn of one above a 20th of a second.

    Raises:
        SettingsError: Bullet would not move the bodies.
    """
    way = _find_way(time_step, gravity)
    is_too_far = not way <= _bullet.most_way
    if time_step > _LONGEST_STEP:
        advice = f"use a shorter time_step: for {time_step:g} steps a second, pass time_step=1/{time_step:g}"
        if is_too_far:
            raise SettingsError(
                f"time_step is {time_step:g} s, in which gravity moves bodies by {way:.3g} m; Bullet can "
                f"follow at most {_bullet.most_way:g} m; {advice}"
            )
        warn_user(
            f"time_step is {time_step:g} s, too long for anything but free motion; {advice}",
            AccuracyWarning,
        )
    elif time_step > _COARSE_STEP and not is_too_far:
        warn_user(
            f"time_step is {time_step:g} s, only {1.0 / time_step:.3g} steps a second, too few for anything but "
            "free motion; use a shorter one, such as 1/200, the default",
            AccuracyWarning,
        )
    check_gravity(time_step, gravity)


def check_gravity(time_step: float, gravity: ArrayLike) -> None:
    """Refuse a gravity that moves bodies too far in a step.

    Raises:
        SettingsError: Bullet would not move the bodies.
    """
    way = _find_way(time_step, gravity)
    if not way <= _bullet.most_way:
        raise SettingsError(
            f"gravity moves bodies by {way:.3g} m in the first step of {time_step:g} s; Bullet can follow "
            f"at most {_bullet.most_way:g} m; use a shorter time_step or weaker gravity"
        )


def _find_way(time_step: float, gravity: ArrayLike) -> float:
    """Return how far gravity moves a body that begins at rest in a step, meters."""
    return float(np.linalg.norm(gravity)) * time_step * time_step  # ** raises OverflowError


def check_motions(simulation: _bullet.Simulation, bodies: Iterable[Body], advice: str) -> None:
    """Warn of bodies that moved or turned too far in a step, once of each; those of a step share a warning.

    Args:
        simulation: The simulation that made the step.
        bodies: Its bodies.
        advice: A further remedy for motions that are not finite, or an empty text.

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
            f"the simulation has diverged: the pose or velocity of {show_value(names[lost])} is no longer finite; "
            f"reduce forces and velocities, or use a shorter time_step{advice}"
        )
    if spins:
        warn_user(
            f"{_show_farthest(spins, names, 'turn')} rad a step; the search for contacts assumes at most "
            f"an eighth of a turn, {_bullet.most_turn:.3f} rad, so contacts may be missed: use a shorter "
            "time_step",
            AccuracyWarning,
        )
    if ways:
        warn_user(
            f"{_show_farthest(ways, names, 'move')} m a step, more than {_bullet.most_way:g} m; Bullet "
            "does not move bodies by 1e+06 m or more: use a shorter time_step, or lower velocities",
            AccuracyWarning,
        )


def _show_farthest(found: Sequence[tuple[int, float]], names: Mapping[int, str], does: str) -> str:
    """Return "'wheel' turns by 1.2", or "'wheel' and 3 others turn by up to 1.2"."""
    number, most = max(found, key=lambda each: each[1])
    name, others = show_value(names[number]), len(found) - 1
    if others == 0:
        return f"{name} {does}s by {most:.3g}"
    return f"{name} and {others} other{'s' if others > 1 else ''} {does} by up to {most:.3g}"
