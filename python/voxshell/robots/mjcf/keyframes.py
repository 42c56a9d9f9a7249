"""Keyframes: the positions of all joints under a name."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from voxshell.base.arguments import show_value
from voxshell.base.poses import pose as make_pose
from voxshell.errors import SettingsError
from voxshell.robots.description import shorten_names
from voxshell.robots.mjcf.compiler import normalize

if TYPE_CHECKING:
    from voxshell.robots.description import JointDescription, RobotDescription
    from voxshell.robots.xml_elements import Element

_COUNTS = {"fixed": 0, "floating": 7, "spherical": 4}
"""Numbers in qpos for a joint; 1 for other types."""


def begin_at_keyframe(robot: RobotDescription, root: Element, name: str) -> None:
    """Let all joints begin where a ``<key>`` has them.

    Args:
        robot: The robot, whose joints are replaced; they are in MuJoCo's order.
        root: The model.
        name: The key's name.

    Raises:
        SettingsError: The model has no such key.
        RobotError: Its qpos is not that of these joints.
    """
    keys = [key for section in root.all("keyframe") for key in section.all("key")]
    names = [it for key in keys if (it := key.attributes.get("name")) is not None]
    if name not in names:
        raise SettingsError(
            f"keyframe is {show_value(name)}, but the keyframes of {robot.path} with a name are "
            f"{shorten_names(names) or 'none'}"
        )
    key = next(key for key in keys if key.attributes.get("name") == name)
    counts = [_COUNTS.get(joint.type, 1) for joint in robot.joints]
    positions = key.numbers("qpos", (sum(counts),))
    if positions is None:
        return  # a key without qpos has that of the model
    ends = np.cumsum(counts)
    robot.joints[:] = [
        _begin_at(joint, positions[end - count : end], key)
        for joint, count, end in zip(robot.joints, counts, ends.tolist(), strict=True)
    ]


def _begin_at(joint: JointDescription, qpos: list[float], key: Element) -> JointDescription:
    """Return a joint that begins at its numbers in qpos."""
    match joint.type:
        case "fixed":
            return joint
        case "floating":
            turned = make_pose(wxyz=normalize(key, "qpos", qpos[3:]))
            return replace(joint, parent_from_child=make_pose(qpos[:3]) @ turned)
        case "spherical":
            frame = joint.parent_from_child @ joint.child_from_joint
            turned = frame @ make_pose(wxyz=normalize(key, "qpos", qpos))
            joint_from_child = np.linalg.inv(joint.child_from_joint)
            return replace(joint, parent_from_child=turned @ joint_from_child)
        case _:
            return replace(joint, start=qpos[0])
