"""Positions that joints begin at."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from voxshell.base.arguments import as_real, show_value
from voxshell.errors import SettingsError
from voxshell.robots.robot import check_names

if TYPE_CHECKING:
    from collections.abc import Mapping

    from voxshell.robots.description import JointDescription, RobotDescription

_UNITS = {"revolute": "rad", "continuous": "rad", "prismatic": "m"}
"""Units of the positions of joints that turn or slide, by type."""

_BEYOND_LIMITS = 1e-3
"""How far beyond a limit a joint may begin, radians or meters: a joint that a simulation has pressed
against its limit reads a little more, and a robot may begin as another one ended."""


def as_starts(positions: Mapping[str, float] | None) -> dict[str, float]:
    """Return a loader's argument ``positions`` as finite numbers by name.

    Raises:
        InputTypeError: It does not map names to numbers.
        SettingsError: A position is not a finite number.
    """
    if positions is None:
        return {}
    check_names(positions, "positions")
    return {name: as_real(it, f"positions[{show_value(name)}]") for name, it in positions.items()}


def begin_at(robot: RobotDescription, starts: Mapping[str, float]) -> None:
    """Let joints begin at positions, and let those that mimic them begin accordingly.

    Args:
        robot: The robot, whose joints are replaced.
        starts: Radians or meters, by the names of joints.

    Raises:
        SettingsError: The robot has no such joint, or the position is beyond the joint's limits.
    """
    joints = {joint.name: joint for joint in robot.joints if joint.type in _UNITS}
    unknown = [name for name in starts if name not in joints]
    if unknown:
        raise SettingsError(
            f"positions names {', '.join(map(show_value, unknown))}, but joints of {robot.path} that turn "
            f"or slide are {', '.join(map(show_value, joints)) or 'none'}"
        )
    for name, start in starts.items():
        _check_limits(joints[name], start)
    found = dict(starts)
    for index, joint in enumerate(robot.joints):
        followers, leader = [], joint
        while leader.name not in found and leader.mimic is not None:
            followers.append(leader)
            leader = joints[leader.mimic[0]]
        if leader.name not in found:
            continue
        for follower in reversed(followers):
            found[follower.name] = _follow(follower, found)
        robot.joints[index] = replace(joint, start=found[joint.name])


def _follow(joint: JointDescription, found: Mapping[str, float]) -> float:
    """Return where a joint begins that mimics another, as near as its limits allow."""
    assert joint.mimic is not None
    leader, multiplier, offset = joint.mimic
    wanted = multiplier * found[leader] + offset
    return wanted if joint.limits is None else min(max(wanted, joint.limits[0]), joint.limits[1])


def _check_limits(joint: JointDescription, start: float) -> None:
    if joint.limits is None:
        return
    lower, upper = joint.limits
    if not lower - _BEYOND_LIMITS <= start <= upper + _BEYOND_LIMITS:
        unit = _UNITS[joint.type]
        raise SettingsError(
            f"positions[{show_value(joint.name)}] must be within the joint's limits, {lower:g} to {upper:g} "
            f"{unit} ({joint.where}), not {start:g} {unit}"
        )
