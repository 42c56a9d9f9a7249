"""Positions and velocities that joints are given, by a loader or by a user of a robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from voxshell.base.arguments import as_real, show_apart, show_value
from voxshell.errors import InputTypeError, SettingsError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from voxshell.robots.description import JointDescription, RobotDescription

_UNITS = {"revolute": "rad", "continuous": "rad", "prismatic": "m"}
"""Units of the positions of joints that turn or slide, by type."""

HELD_WITHIN = 1e-3
"""How exactly a simulation holds a joint, radians or meters. A joint that is pressed against its limit
reads a little more, and one that mimics another lags behind: the positions that a robot had are valid
positions of a robot."""


def as_positions(positions: Mapping[str, float], name: str = "positions") -> dict[str, float]:
    """Return an argument that maps the names of joints to finite numbers.

    Raises:
        InputTypeError: It does not map names to numbers.
        SettingsError: A number is not finite.
    """
    if not isinstance(positions, Mapping):
        raise InputTypeError(
            f"{name} must map the names of joints to numbers, as in {{'elbow': 0.5}}, not "
            f"{type(positions).__name__}"
        )
    return {joint: as_real(it, f"{name}[{show_value(joint)}]") for joint, it in positions.items()}


def as_starts(positions: Mapping[str, float] | None) -> dict[str, float]:
    """Return a loader's argument ``positions`` as finite numbers by name.

    Raises:
        InputTypeError: It does not map names to numbers.
        SettingsError: A position is not finite.
    """
    return {} if positions is None else as_positions(positions)


def begin_at(robot: RobotDescription, starts: Mapping[str, float]) -> None:
    """Let joints begin at positions, and let those that mimic them begin accordingly.

    A joint without a position begins where the file has it, or at the nearest limit if that is beyond its
    limits; then it is noted in ``robot.moved_to_limits``.

    Args:
        robot: The robot, whose joints are replaced.
        starts: Radians or meters, by the names of joints.

    Raises:
        SettingsError: The robot has no such joint, or the position is beyond the joint's limits.
    """
    given = dict(starts)
    for joint in robot.joints:
        nearest = clamp(joint.start, joint.limits)
        if nearest != joint.start and joint.mimic is None and joint.name not in starts:
            given[joint.name] = robot.moved_to_limits[joint.name] = nearest
    found = complete_positions(robot.joints, given, f"joints of {robot.path}")
    for index, joint in enumerate(robot.joints):
        start = found.get(joint.name, clamp(joint.start, joint.limits))
        robot.joints[index] = replace(joint, start=start)


def complete_positions(
    joints: Iterable[JointDescription], positions: Mapping[str, float], owner: str
) -> dict[str, float]:
    """Return positions, and those of the joints that mimic these, by name.

    Args:
        joints: All joints.
        positions: Radians or meters, by the names of joints.
        owner: What the joints are of, for error messages: "joints of arm.urdf".

    Raises:
        SettingsError: There is no such joint, or the position is beyond the joint's limits.
    """
    moving = _find_moving(joints, positions, "positions", owner)
    for name, position in positions.items():
        _check_limits(moving[name], position)
    return _complete(moving, positions, follow)


def complete_velocities(
    joints: Iterable[JointDescription],
    velocities: Mapping[str, float],
    positions: Mapping[str, float],
    owner: str,
) -> dict[str, float]:
    """Return velocities, and those of the joints that mimic these, by name.

    Args:
        joints: All joints.
        velocities: Rad/s or m/s, by the names of joints.
        positions: Present positions of all joints that turn or slide, radians or meters. A joint that
            mimics another one from beyond its own limits stays there.
        owner: What the joints are of, for error messages: "joints of arm.urdf".

    Raises:
        SettingsError: There is no such joint.
    """

    def follow_velocity(joint: JointDescription, found: Mapping[str, float]) -> float:
        assert joint.mimic is not None
        leader, multiplier, offset = joint.mimic
        wanted = multiplier * positions[leader] + offset
        is_free = abs(wanted - clamp(wanted, joint.limits)) <= HELD_WITHIN
        return multiplier * found[leader] if is_free else 0.0

    moving = _find_moving(joints, velocities, "velocities", owner)
    return _complete(moving, velocities, follow_velocity)


def _find_moving(
    joints: Iterable[JointDescription], given: Iterable[str], what: str, owner: str
) -> dict[str, JointDescription]:
    """Return the joints that turn or slide, by name; refuse the names of others.

    Raises:
        SettingsError: There is no such joint.
    """
    moving = {joint.name: joint for joint in joints if joint.type in _UNITS}
    unknown = [name for name in given if name not in moving]
    if unknown:
        raise SettingsError(
            f"{what} names {', '.join(map(show_value, unknown))}, but the {owner} that turn "
            f"or slide are {', '.join(map(show_value, moving))}"
            if moving
            else f"{what} names {', '.join(map(show_value, unknown))}, but none of the {owner} turns or slides"
        )
    return moving


def _complete(
    moving: Mapping[str, JointDescription],
    given: Mapping[str, float],
    find: Callable[[JointDescription, Mapping[str, float]], float],
) -> dict[str, float]:
    """Return what is given, and what is found for the joints that mimic these, by name."""
    found = dict(given)
    for joint in moving.values():
        followers, leader = [], joint
        while leader.name not in found and leader.mimic is not None:
            followers.append(leader)
            leader = moving[leader.mimic[0]]
        if leader.name in found:
            for follower in reversed(followers):
                found[follower.name] = find(follower, found)
    return found


def follow(joint: JointDescription, found: Mapping[str, float]) -> float:
    """Return where a joint is that mimics another, as near as its limits allow."""
    assert joint.mimic is not None
    leader, multiplier, offset = joint.mimic
    return clamp(multiplier * found[leader] + offset, joint.limits)


def clamp(position: float, limits: tuple[float, float] | None) -> float:
    """Return the nearest position within limits."""
    return position if limits is None else min(max(position, limits[0]), limits[1])


def refuse_beyond(joint: JointDescription, position: float, where: str = "") -> SettingsError:
    """Return the error about a position beyond a joint's limits."""
    assert joint.limits is not None
    unit = _UNITS[joint.type]
    given, lower, upper = show_apart(position, *joint.limits)
    return SettingsError(
        f"positions[{show_value(joint.name)}] must be within the joint's limits, {lower} to {upper} "
        f"{unit}{where}, not {given} {unit}"
    )


def _check_limits(joint: JointDescription, position: float) -> None:
    if abs(position - clamp(position, joint.limits)) > HELD_WITHIN:
        raise refuse_beyond(joint, position, f" ({joint.where})")
