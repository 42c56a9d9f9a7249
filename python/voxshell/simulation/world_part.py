"""The base of bodies and joints, which belong to a world until they are removed."""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn

from voxshell.base.arguments import as_text
from voxshell.errors import InputTypeError, SettingsError

if TYPE_CHECKING:
    from voxshell import _bullet


class WorldPart:
    """A body or a joint of a :class:`World`."""

    __slots__ = ("_name", "_world")

    def __init__(self, simulation: _bullet.Simulation, name: str) -> None:
        self._world: _bullet.Simulation | None = simulation
        self._name = as_text(name, "name")

    @property
    def name(self) -> str:
        """A name for people; settable.

        Raises:
            InputTypeError: The new name is not a string.
        """
        return self._name

    @name.setter
    def name(self, value: str) -> None:
        self._name = as_text(value, "name")

    @property
    def removed(self) -> bool:
        """True after it was removed from its world."""
        return self._world is None

    def __reduce__(self) -> NoReturn:
        raise InputTypeError(
            f"{self._title} cannot be copied or pickled, because it belongs to a world: add another one, or "
            "pass its numbers"
        )

    @property
    def _simulation(self) -> _bullet.Simulation:
        if self._world is None:
            raise SettingsError(f"{self._title} has been removed from its world")
        return self._world

    @property
    def _title(self) -> str:
        return f"{type(self).__name__.lower()} {self.name!r}"


def check_own(part: WorldPart, simulation: _bullet.Simulation) -> None:
    """Refuse a body or joint of another world, or one that was removed."""
    if part._simulation is not simulation:
        raise SettingsError(f"{part._title} belongs to another world; pass one of this world")


def refuse_added(body: WorldPart, simulation: _bullet.Simulation) -> NoReturn:
    """Refuse a body where a shape is needed.

    Raises:
        InputTypeError: Always; the message says which world has the body.
    """
    if body.removed:
        state = "has been removed from its world"
    elif body._world is simulation:
        state = "is in this world already"
    else:
        state = "belongs to another world"
    raise InputTypeError(
        f"{body._title} {state}; to add another body like it, pass its shape: add(body.shape, mass=..., pose=...)"
    )
