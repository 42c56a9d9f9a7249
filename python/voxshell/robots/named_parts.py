"""Parts of a robot by name."""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn, TypeVar

from voxshell.base.near_names import find_closest
from voxshell.base.settings import list_names

if TYPE_CHECKING:
    from collections.abc import Mapping

Part = TypeVar("Part")


class NamedParts(dict[str, Part]):
    """A dict whose KeyError states which names there are.

    Example:
        >>> NamedParts({"arm": 1, "hand": 2}, "robot 'r'", "link")["amr"]
        Traceback (most recent call last):
        KeyError: "robot 'r' has no link 'amr': did you mean 'arm'? It has 'arm', 'hand'"
    """

    __slots__ = ("_kind", "_owner")

    def __init__(self, parts: Mapping[str, Part], owner: str, kind: str) -> None:
        super().__init__(parts)
        self._owner, self._kind = owner, kind

    def __missing__(self, name: str) -> NoReturn:
        closest = find_closest(name, self) if isinstance(name, str) else None
        hint = f": did you mean {closest!r}? It" if closest else "; it"
        known = list_names(map(repr, self)) or "none"
        raise KeyError(f"{self._owner} has no {self._kind} {name!r}{hint} has {known}")
