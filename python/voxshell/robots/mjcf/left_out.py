"""Contents of a model that are not simulated."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from voxshell.robots.description import shorten_names

if TYPE_CHECKING:
    from collections.abc import Iterable

    from voxshell.robots.xml_elements import Element

_SECTIONS = ("actuator", "tendon", "equality", "deformable")
_FLUID = ("density", "viscosity", "wind")


class LeftOut:
    """Collects what is not simulated, by kind and name."""

    def __init__(self) -> None:
        self._noted: dict[str, list[str]] = {}
        self._counts: dict[str, Counter[str]] = {}

    def note(self, kind: str, name: str) -> None:
        """Record something."""
        self._noted.setdefault(kind, []).append(name)

    def note_sections(self, root: Element) -> None:
        """Note whole sections of a model."""
        for name in _SECTIONS:
            kinds = Counter(child.tag for section in root.all(name) for child in section.children)
            if kinds:
                self._counts.setdefault(name, Counter()).update(kinds)

    def note_option(self, root: Element, gravity: Iterable[float]) -> None:
        """Note what ``<option>`` says about air, and a gravity that differs from the world's.

        Raises:
            RobotError: An option is not a number.
        """
        for option in root.all("option"):
            for name in _FLUID:
                if any(option.numbers(name, (1, 3)) or ()):
                    self.note("<option>", name)
            wanted = option.numbers("gravity", (3,))
            if wanted is not None and any(
                abs(a - b) > 1e-6 for a, b in zip(wanted, gravity, strict=True)
            ):
                self.note("<option>", f"gravity {wanted}; pass it to the World")

    def list(self) -> list[str]:
        """Return a phrase for each kind."""
        return [
            *(
                f"<{name}> ({', '.join(f'{count} {kind[:60]}' for kind, count in kinds.most_common(10))})"
                for name, kinds in self._counts.items()
            ),
            *(f"{kind} ({shorten_names(names)})" for kind, names in self._noted.items()),
        ]
