"""The bodies of a world as a tuple that says how to find one by its name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from voxshell.errors import InputTypeError

if TYPE_CHECKING:
    from voxshell.simulation.body import Body


class BodyTuple(tuple["Body", ...]):
    """A tuple of bodies; a name as an index raises an error with a remedy."""

    __slots__ = ()

    def __getitem__(self, index: Any) -> Any:
        """Return a body or a part of the tuple."""
        if isinstance(index, str):
            raise InputTypeError(
                f"world.bodies is a tuple, whose indices are integers; by name: {{body.name: body for body in "
                f"world.bodies}}[{index!r}]"
            )
        return super().__getitem__(index)
