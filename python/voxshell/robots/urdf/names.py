"""The names of URDF's elements: others are doubted, because a misspelt one would be missing."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from voxshell.base.near_names import find_closest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from voxshell.robots.xml_elements import Element


class _Names(NamedTuple):
    """The elements that an element may have."""

    own: tuple[str, ...]  # of URDF
    extensions: tuple[str, ...]  # of other programs, which are not read


_NAMES = {
    "robot": _Names(
        ("link", "joint", "material"),
        ("gazebo", "group", "mujoco", "ros2_control", "sensor", "transmission", "verbose"),
    ),
    "link": _Names(
        ("inertial", "visual", "collision", "contact"),
        ("audio_source", "gazebo", "mujoco", "self_collision_checking", "sensor", "verbose"),
    ),
    "joint": _Names(
        ("parent", "child", "origin", "axis", "limit", "dynamics", "mimic"),
        ("calibration", "gazebo", "joint_properties", "mujoco", "safety_controller", "verbose"),
    ),
    "inertial": _Names(("mass", "inertia", "origin"), ("verbose",)),
    "collision": _Names(
        ("geometry", "origin"),
        ("contact_coefficients", "gazebo", "material", "surface", "verbose"),
    ),
}
"""By the name of the element that they lie in. Names with a prefix, as drake:joint, are extensions everywhere."""

_MOST_LETTERS = 60
"""Letters of a name that are shown."""


def refuse_macros(root: Element) -> None:
    """Refuse a file with elements of xacro.

    Raises:
        RobotError: There is one.
    """
    for child in root.children:
        if child.tag.startswith("xacro:"):
            child.refuse(
                f"has <{child.tag[:_MOST_LETTERS]}>: it is a xacro file that is not expanded; run "
                f"xacro {child.path} > robot.urdf, and load the result"
            )
        refuse_macros(child)


def find_unknown(root: Element) -> dict[str, list[str]]:
    """Return elements of a robot and its links and joints that URDF does not have.

    Returns:
        The places, "link 'arm' in line 7", by what is there: "<colision>, did you mean <collision>?".
    """
    found: dict[str, list[str]] = {}
    for child, names in _list_children(root):
        if child.tag in names.own + names.extensions or ":" in child.tag:
            continue
        meant = find_closest(child.tag, names.own)
        what = f"<{child.tag[:_MOST_LETTERS]}>" + (f", did you mean <{meant}>?" if meant else "")
        found.setdefault(what, []).append(f"{child.owner} in line {child.line}")
    return found


def _list_children(element: Element) -> Iterator[tuple[Element, _Names]]:
    """Yield all elements that lie in an element whose contents are known, and what may lie there."""
    names = _NAMES[element.tag]
    for child in element.children:
        yield child, names
        if child.tag in _NAMES and child.tag in names.own:
            yield from _list_children(child)
