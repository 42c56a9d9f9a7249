"""Default classes: default values of elements' attributes."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from voxshell.robots.mjcf.compiler import ROTATIONS

if TYPE_CHECKING:
    from voxshell.robots.xml_elements import Element

MAIN = "main"

_ACTUATORS = ("general", "motor", "position", "velocity", "intvelocity", "orientation", "pid")
_ACTUATORS += ("damper", "cylinder", "muscle", "adhesion", "dcmotor")
"""Kinds of actuators, which share their defaults: what a class has for one, it has for all."""


class Defaults:
    """The default classes of a model.

    Args:
        sections: Its ``<default>`` sections.

    Raises:
        RobotError: A class has no name.
    """

    def __init__(self, sections: list[Element]) -> None:
        self._classes: dict[str, dict[str, dict[str, str]]] = {MAIN: {}}
        for section in sections:
            self._read(section, section.attributes.get("class", MAIN), self._classes[MAIN])

    def _read(self, element: Element, name: str, above: dict[str, dict[str, str]]) -> None:
        own = {tag: dict(attributes) for tag, attributes in self._classes.get(name, above).items()}
        self._classes[name] = own
        nested: list[Element] = []
        for child in element.children:
            if child.tag == "default":
                nested.append(child)
            else:
                kind = _kind_of(child)
                own[kind] = {**own.get(kind, {}), **child.attributes}
        for child in nested:
            self._read(child, child.text("class"), own)

    def complete(self, element: Element, child_class: str) -> Element:
        """Return an element with the attributes of its class, or of the class of its body.

        A rotation of the element replaces that of the class, whatever their kinds.

        Raises:
            RobotError: There is no such class.
        """
        name = element.attributes.get("class", child_class)
        self.check(element, name)
        given = self._classes[name].get(_kind_of(element), {})
        if not element.attributes.keys().isdisjoint(ROTATIONS):
            given = {key: value for key, value in given.items() if key not in ROTATIONS}
        return replace(element, attributes={**given, **element.attributes})

    def check(self, element: Element, name: str) -> None:
        """Refuse an unknown class.

        Raises:
            RobotError: The class is unknown.
        """
        if name not in self._classes:
            element.refuse(
                f"has the default class {name[:60]!r}, but there is no such class; correct the name"
            )


def _kind_of(element: Element) -> str:
    return "actuator" if element.tag in _ACTUATORS else element.tag
