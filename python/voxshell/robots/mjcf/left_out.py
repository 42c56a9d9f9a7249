"""Contents of a model that are not simulated."""

from __future__ import annotations

import math
import os
from collections import Counter
from typing import TYPE_CHECKING

from voxshell.robots.description import shorten_names

if TYPE_CHECKING:
    from collections.abc import Iterable

    from voxshell.robots.xml_elements import Element

_SECTIONS = ("actuator", "tendon", "equality", "deformable")
_FLUID = ("density", "viscosity", "wind")
_FLAGS = ("gravity", "constraint", "limit", "frictionloss", "damper", "passive")
"""Flags that disable what a world simulates. ``contact`` is obeyed, so it is not among them."""


def is_disabled(flag: Element, name: str) -> bool:
    """Return the value of a ``<flag>``.

    Raises:
        RobotError: It is no word that it may be.
    """
    return flag.word(name, ("enable", "disable"), "enable") == "disable"


def _describe(name: str, flag: Element) -> str:
    return f'{name}="disable" at {os.path.basename(flag.where)}'


class LeftOut:
    """Collects what is not simulated, by kind and name."""

    def __init__(self) -> None:
        self._noted: dict[str, list[str]] = {}
        self._counts: dict[str, Counter[str]] = {}

    def note(self, kind: str, name: str) -> None:
        """Record something."""
        self._noted.setdefault(kind, []).append(name)

    def note_once(self, kind: str, name: str) -> None:
        """Store a remark, unless it has been stored."""
        if name not in self._noted.get(kind, ()):
            self.note(kind, name)

    def note_sections(self, root: Element) -> None:
        """Note whole sections of a model."""
        for name in _SECTIONS:
            kinds = Counter(child.tag for section in root.all(name) for child in section.children)
            if kinds:
                self._counts.setdefault(name, Counter()).update(kinds)

    def note_option(self, root: Element, gravity: Iterable[float], time_step: float) -> None:
        """Note what ``<option>`` says about air, and a gravity or time step that differs from the world's.

        Raises:
            RobotError: An option is no number, or a flag is no word that it may be.
        """
        flags = [flag for option in root.all("option") for flag in option.all("flag")]
        disabled = {name: flag for flag in flags for name in _FLAGS if is_disabled(flag, name)}
        weightless = disabled.pop("gravity", None)
        if weightless is not None and any(gravity):
            self.note(
                "<flag>", f"{_describe('gravity', weightless)}; give gravity=(0, 0, 0) to the World"
            )
        for name, flag in disabled.items():
            self.note("<flag>", _describe(name, flag))
        for option in root.all("option"):
            for name in _FLUID:
                if any(option.numbers(name, (1, 3)) or ()):
                    self.note("<option>", name)
            wanted = option.numbers("gravity", (3,))
            if (
                wanted is not None
                and weightless is None
                and any(abs(a - b) > 1e-6 for a, b in zip(wanted, gravity, strict=True))
            ):
                self.note("<option>", f"gravity {wanted}; pass it to the World")
            seconds = option.number("timestep")
            if seconds is not None and not math.isclose(seconds, time_step, rel_tol=1e-6):
                self.note(
                    "<option>", f"timestep {seconds:g}; give time_step={seconds:g} to the World"
                )

    def list(self) -> list[str]:
        """Return a phrase for each kind."""
        return [
            *(
                f"<{name}> ({', '.join(f'{count} {kind[:60]}' for kind, count in kinds.most_common(10))})"
                for name, kinds in self._counts.items()
            ),
            *(f"{kind} ({shorten_names(names)})" for kind, names in self._noted.items()),
        ]
