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
            count = sum(body.name == index for body in self)
            if count > 1:
                how = f"{count} bodies have this name: [body for body in world.bodies if body.name == {index!r}]"
            else:
                how = f"by name: {{body.name: body for body in world.bodies}}[{index!r}]"
            raise InputTypeError(f"world.bodies is a tuple, whose indices are integers; {how}")
        return super().__getitem__(index)
