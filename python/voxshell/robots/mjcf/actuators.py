"""The efforts of joints, from the limits of their actuators; the actuators themselves are not simulated."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from voxshell.robots.mjcf.defaults import MAIN

if TYPE_CHECKING:
    from voxshell.robots.description import JointDescription
    from voxshell.robots.mjcf.compiler import Compiler
    from voxshell.robots.mjcf.parts import Part
    from voxshell.robots.xml_elements import Element

_SWITCH = ("false", "true", "auto")
_OTHERWISE = ("kp", "kv", "dyntype", "biastype", "gaintype")
"""Attributes of a general actuator, or of its class, with which its force is not its control times its gain."""


class Actuators:
    """Collects the limits of a model's actuators, by the joints that they drive."""

    def __init__(self) -> None:
        self._limits: dict[str, list[float | None]] = {}

    def read(self, part: Part) -> None:
        """Read the actuators of a model, or of one attached to it.

        Raises:
            RobotError: An attribute is invalid, or an actuator has an unknown class.
        """
        for section in part.file.sections("actuator"):
            for element in section.children:
                own = element.attributes
                joint = own.get("joint", own.get("jointinparent"))
                if joint is not None:
                    limit = _find_limit(part.defaults.complete(element, MAIN), part.compiler)
                    self._limits.setdefault(part.prefix + joint, []).append(limit)

    def limit(self, joint: JointDescription) -> JointDescription:
        """Return a joint with the effort of its actuator, or with the reason why it has none."""
        match self._limits.get(joint.name, []):
            case []:
                return joint
            case [None]:
                reason = "has an actuator whose largest force it does not state"
            case [float() as limit]:
                return replace(joint, effort=min(limit, joint.effort or math.inf))
            case several:
                reason = f"has {len(several)} actuators, whose forces are not added up,"
        return replace(joint, no_effort=reason)


def read_range(
    element: Element, attribute: str, switch: str, compiler: Compiler
) -> tuple[float, float] | None:
    """Return a range that limits, or None if the element is not limited.

    Args:
        element: The element with the attributes of its class.
        attribute: The attribute with the range.
        switch: The attribute that says whether the range limits.
        compiler: The model's settings.

    Raises:
        RobotError: An attribute is invalid.
    """
    lower, upper = element.numbers(attribute, (2,)) or (0.0, 0.0)
    wish = element.word(switch, _SWITCH, "auto")
    by_range = compiler.limits_by_range and lower < upper
    return (lower, upper) if wish == "true" or (wish == "auto" and by_range) else None


def _find_limit(element: Element, compiler: Compiler) -> float | None:
    """Return the largest force or torque on the joint, newtons or newton meters; None if it is not told."""
    limits = []
    forces = read_range(element, "forcerange", "forcelimited", compiler)
    if forces is not None:
        limits.append(max(map(abs, forces)))
    is_general = element.tag == "general" and element.attributes.keys().isdisjoint(_OTHERWISE)
    if element.tag == "motor" or is_general:
        controls = read_range(element, "ctrlrange", "ctrllimited", compiler)
        gain = (element.numbers("gainprm", range(1, 20)) or [1.0])[0] if is_general else 1.0
        if controls is not None:
            limits.append(max(map(abs, controls)) * abs(gain))
    gear = (element.numbers("gear", range(1, 7)) or [1.0])[0]
    return min(limits, default=0.0) * abs(gear) or None
