"""Conversion of joints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell.robots.description import JointDescription, JointType
from voxshell.robots.mjcf.actuators import read_range
from voxshell.robots.mjcf.compiler import normalize

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.robots.mjcf.compiler import Compiler
    from voxshell.robots.mjcf.left_out import LeftOut
    from voxshell.robots.xml_elements import Element

_TYPES: dict[str, JointType] = {
    "free": "floating",
    "ball": "spherical",
    "slide": "prismatic",
    "hinge": "revolute",
}
_SWITCH = ("false", "true", "auto")
_POLYNOMIAL = range(1, 10)
"""Numbers in a stiffness or damping; those after the first are of higher order."""


@dataclass(frozen=True, eq=False)
class JointPlace:
    """The place of a joint: the links that it joins, as in the file."""

    name: str
    parent: str
    child: str
    parent_from_child: NDArray[np.float64]


def type_of(element: Element) -> JointType:
    """Return the type of a ``<joint>`` or ``<freejoint>``.

    Raises:
        RobotError: It is not one of MuJoCo's types.
    """
    if element.tag == "freejoint":
        return "floating"
    return _TYPES[element.word("type", tuple(_TYPES), "hinge")]


def is_aligned(
    joints: list[tuple[Element, NDArray[np.float64]]], holds_bodies: bool, compiler: Compiler
) -> bool:
    """Return whether a body with these joints gets the frame of its inertia, as free bodies may.

    Raises:
        RobotError: A joint is of none of MuJoCo's types, or its ``align`` is no word that it may be.
    """
    if len(joints) != 1 or holds_bodies or type_of(joints[0][0]) != "floating":
        return False
    wish = joints[0][0].word("align", _SWITCH, "auto")
    return compiler.aligns_free if wish == "auto" else wish == "true"


def read_joint(
    element: Element,
    frame: NDArray[np.float64],
    place: JointPlace,
    compiler: Compiler,
    left_out: LeftOut,
) -> JointDescription:
    """Read a joint.

    Args:
        element: The element with the attributes of its class.
        frame: ``body_from_frame`` of the frame that contains it.
        place: The links that it joins.
        compiler: The model's settings.
        left_out: Receives what is not simulated.

    Raises:
        RobotError: A number is invalid.
    """
    kind = type_of(element)
    unit = compiler.unit if kind == "revolute" else 1.0
    child_from_joint = np.eye(4)
    child_from_joint[:3, 3] = (
        frame[:3, :3] @ (element.numbers("pos", (3,)) or [0.0] * 3) + frame[:3, 3]
    )
    axis = normalize(element, "axis", element.numbers("axis", (3,)) or [0.0, 0.0, 1.0])
    x, y, z = (frame[:3, :3] @ axis).tolist()
    limits = None if kind == "floating" else _read_limits(element, compiler)
    losses = _read_losses(element)
    damping, friction, armature = losses
    _note_left_out(element, kind, place.name, limits, losses, left_out)
    has_axis = kind in ("revolute", "prismatic")
    # In radians even where the file has degrees: newton meters per radian.
    stiffness = _read_first(element, "stiffness") if has_axis else 0.0
    if limits is not None and has_axis:
        limits = limits[0] * unit, limits[1] * unit
    position = (element.number("ref") or 0.0) * unit if has_axis else 0.0
    force = read_range(element, "actuatorfrcrange", "actuatorfrclimited", compiler) or (0.0,)
    return JointDescription(
        place.name,
        element.where,
        "continuous" if kind == "revolute" and limits is None else kind,
        place.parent,
        place.child,
        place.parent_from_child,
        child_from_joint,
        position,
        position,
        (x, y, z),
        limits if has_axis else None,
        max(map(abs, force)) or None,
        None,
        friction,
        damping,
        None,
        stiffness=max(stiffness, 0.0),
        spring_position=(element.number("springref") or 0.0) * unit,
        armature=armature if has_axis else 0.0,
    )


def _read_losses(element: Element) -> tuple[float, float, float]:
    """Return damping, frictionloss and armature.

    Raises:
        RobotError: One is below 0, with which the joint would gain energy.
    """
    losses = {
        "damping": _read_first(element, "damping"),
        "frictionloss": element.number("frictionloss") or 0.0,
        "armature": _read_first(element, "armature"),
    }
    for loss, value in losses.items():
        if value < 0.0:
            element.refuse(
                f"has a {loss} of {value:g}, below 0, with which it would gain energy; correct its "
                "sign, or set it to 0"
            )
    return losses["damping"], losses["frictionloss"], losses["armature"]


def _read_first(element: Element, attribute: str) -> float:
    return (element.numbers(attribute, _POLYNOMIAL) or [0.0])[0]


def _read_limits(element: Element, compiler: Compiler) -> tuple[float, float] | None:
    """Return the limits in the file's units; None without limits."""
    lower, upper = element.numbers("range", (2,)) or (0.0, 0.0)
    limited = element.word("limited", _SWITCH, "auto")
    if limited == "false" or (
        limited == "auto" and not (compiler.limits_by_range and lower < upper)
    ):
        return None
    if lower > upper or (lower == upper == 0.0):
        element.refuse(f'has <joint range="{lower:g} {upper:g}">; put the lower limit first')
    return lower, upper


def _note_left_out(
    element: Element,
    kind: JointType,
    name: str,
    limits: tuple[float, float] | None,
    losses: tuple[float, float, float],
    left_out: LeftOut,
) -> None:
    if "springdamper" in element.attributes:
        left_out.note("joint springdamper", name)
    stiffness = element.numbers("stiffness", _POLYNOMIAL) or [0.0]
    if kind not in ("floating", "spherical"):
        if stiffness[0] < 0.0 or any(stiffness[1:]):
            left_out.note("joint stiffness below 0 or of a higher order", name)
    elif element.tag != "freejoint":
        if limits is not None and kind == "spherical":
            left_out.note("limits of ball joints", name)
        if any(losses) or any(stiffness):
            left_out.note(
                "damping, frictionloss, stiffness or armature of ball and free joints", name
            )
