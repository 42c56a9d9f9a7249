"""Where in a TOML text a key stands: no maintained parser for Python tells."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from voxshell._settings import parse_toml
from voxshell.errors import SettingsError

if TYPE_CHECKING:
    from collections.abc import Sequence


def find_line(text: str, keys: Sequence[str]) -> int:
    r"""The line, from 1, at which a key or its table begins.

    The text grows line by line until it holds the key, so that the parser itself says where it is.

    Args:
        text: TOML without errors.
        keys: The names of the tables around the key, and its own. Where the text lacks it, the
            innermost of these tables that is there counts.

    Example:
        >>> find_line("# A scene\n[ball]\nmass = 1\n", ["ball", "mass"])
        3
        >>> find_line("# A scene\n[ball]\nmass = 1\n", ["ball", "radius"])
        2
    """
    lines = text.splitlines()
    found = 1
    depth = 0
    begin = 0
    for end in range(1, len(lines) + 1):
        try:
            tables = parse_toml("\n".join(lines[:end]))
        except SettingsError:
            continue  # inside a value of several lines
        reached = _count_found(tables, keys)
        if reached > depth:
            # A value of several lines begins before the line that completes it.
            new = range(begin, end)
            found = next((i for i in new if not _is_blank(lines[i])), begin) + 1
            depth = reached
        begin = end
    return found


def _count_found(tables: Any, keys: Sequence[str]) -> int:
    count = 0
    for key in keys:
        if not isinstance(tables, dict) or key not in tables:
            break
        tables = tables[key]
        count += 1
    return count


def _is_blank(line: str) -> bool:
    return not line.strip() or line.lstrip().startswith("#")
