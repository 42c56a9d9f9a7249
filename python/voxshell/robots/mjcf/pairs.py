"""The ``<pair>`` elements of a model: geoms that collide whatever their bits, and with what friction."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

from voxshell.robots.mjcf.defaults import MAIN

if TYPE_CHECKING:
    from voxshell.robots.mjcf.parts import Part
    from voxshell.robots.xml_elements import Element

_FRICTIONS = range(1, 6)
"""Numbers of a pair's friction: two of sliding, one of spinning, two of rolling."""

_FRICTION = 1.0
"""Friction along the second tangent if the file gives only the first."""


@dataclass(frozen=True, eq=False)
class Pair:
    """Two geoms that collide.

    Attributes:
        element: As in the file, with the attributes of its class.
        geoms: Their names, with the prefix of their model.
        friction: Along the two tangents; None if it is that of the geoms.
        slips: Whether the contacts have no friction.
    """

    element: Element
    geoms: tuple[str, str]
    friction: tuple[float, float] | None
    slips: bool

    @property
    def place(self) -> str:
        """For warnings: "floor and foot at model.xml:7"."""
        return f"{' and '.join(self.geoms)} at {os.path.basename(self.element.where)}"


def read_pairs(part: Part) -> list[Pair]:
    """Return the pairs of a model.

    Raises:
        RobotError: A pair lacks a name, or a number is wrong.
    """
    return [
        _read(part.defaults.complete(element, MAIN), part.prefix)
        for section in part.file.sections("contact")
        for element in section.all("pair")
    ]


def _read(element: Element, prefix: str) -> Pair:
    geoms = prefix + element.text("geom1"), prefix + element.text("geom2")
    numbers = element.numbers("friction", _FRICTIONS)
    friction = None
    if numbers is not None:
        friction = numbers[0], numbers[1] if len(numbers) > 1 else _FRICTION
    slips = element.number("condim") == 1 or friction == (0.0, 0.0)
    return Pair(element, geoms, friction, slips)
