"""The names of MJCF's elements and attributes; a model with others is refused, as MuJoCo refuses it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING

from voxshell.base.near_names import find_closest

if TYPE_CHECKING:
    from voxshell.robots.xml_elements import Element

_LONGEST = 60
"""Letters of a wrong name that are shown."""

_REPLICATE = {"count", "offset", "sep"}
"""Attributes of ``<replicate>`` beside those of a body. MuJoCo replaces the element before it looks at names."""


@dataclass(frozen=True, eq=False)
class Names:
    """The contents that an element may have.

    Attributes:
        attributes: Their names.
        children: The elements that may lie in it, by name.
    """

    attributes: set[str]
    children: dict[str, Names] = field(default_factory=dict)


@cache
def read_names() -> Names:
    """Return the contents of the root, with everything below it."""
    levels: list[Names] = []
    for line in files("voxshell.robots.mjcf").joinpath("names.txt").read_text("utf-8").splitlines():
        if line.startswith("#"):
            continue
        tag, _, attributes = line.strip().partition(":")
        made = Names(set(attributes.split()))
        del levels[(len(line) - len(line.lstrip())) // 2 :]
        if levels:
            levels[-1].children[tag] = made
        levels.append(made)
    root = levels[0]
    root.children["default"].children["default"] = root.children["default"]
    # A body's names also hold for what takes the place of one, or of several.
    body = root.children.pop("body")
    root.children["worldbody"] = body
    body.children["body"] = body.children["frame"] = body
    body.children["replicate"] = Names(body.attributes | _REPLICATE, body.children)
    return root


def check_names(root: Element) -> None:
    """Refuse elements and attributes that MJCF does not allow at their place.

    Args:
        root: Of a model, with what it includes.

    Raises:
        RobotError: There is one; the message says what name is closest to it.
    """
    _check(root, read_names())


def _check(element: Element, names: Names) -> None:
    for attribute in element.attributes:
        if attribute not in names.attributes:
            known = find_closest(attribute, names.attributes)
            element.refuse(
                f"has an unknown attribute {attribute[:_LONGEST]!r} in <{element.tag}>; "
                + (f"did you mean {known!r}?" if known else "correct or remove it")
            )
    for child in element.children:
        inner = names.children.get(child.tag)
        if inner is None:
            known = find_closest(child.tag, names.children)
            child.refuse(
                f"has an unknown element <{child.tag[:_LONGEST]}> in <{element.tag}>; "
                + (f"did you mean <{known}>?" if known else "correct or remove it")
            )
        _check(child, inner)
