"""Lines of keys in a TOML text, which no maintained parser for Python reports."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from voxshell.base.settings import TOML_TOKEN, parse_checked_toml

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence


_KEY = re.compile(r"""(?:"(?:\\.|[^"\\\n])*"|'[^'\n]*'|[^"'=\n])+=[ \t]*""")
"""Matches the key of a statement, and the equals sign."""


def find_line(text: str, keys: Sequence[str]) -> int:
    r"""Return the line, from 1, at which a key or its table begins.

    The TOML parser itself reads the statements one by one until the key is found, so this takes at
    most as long as reading the text twice.

    Args:
        text: TOML that :func:`voxshell.base.settings.parse_toml` has accepted.
        keys: The names of the tables around the key, and the key's own name. If the key is missing,
            the line is that of the innermost of these tables.

    Example:
        >>> find_line("# A scene\n[ball]\nmass = 1\n", ["ball", "mass"])
        3
        >>> find_line("# A scene\n[ball]\nmass = 1\n", ["ball", "radius"])
        2
    """
    found, depth = 1, 0
    in_table = True  # before the first header, statements belong to the root table
    table = 0
    for line, statement in _split(text):
        if statement.lstrip().startswith("["):
            header = parse_checked_toml(statement)
            reached = table = _count_found(header, keys)
            in_table = reached == _count_levels(header)
        elif in_table:
            reached = table + _count_in_statement(statement, keys[table:])
        else:
            continue
        if reached > depth:
            found, depth = line, reached
        if depth == len(keys):
            break
    return found


def _split(text: str) -> Iterator[tuple[int, str]]:
    """Yield the line and text of each header and of each key with its value."""
    open_brackets = begin = 0
    line = first = 1
    for token in TOML_TOKEN.finditer(text + "\n"):
        word = token[0]
        line += word.count("\n")
        if word in "[{":
            open_brackets += 1
        elif word in "]}":
            open_brackets -= 1
        elif word == "\n" and open_brackets == 0:
            statement = text[begin : token.end()]
            if statement.strip() and not statement.lstrip().startswith("#"):
                yield first, statement
            begin, first = token.end(), line


def _count_in_statement(statement: str, keys: Sequence[str]) -> int:
    """Count the keys that a statement contains; of its value, only a table is parsed."""
    key = _KEY.match(statement)
    assert key is not None
    found = _count_found(parse_checked_toml(f"{key[0]}0"), keys)
    if found > 0 and statement.startswith("{", key.end()):
        return _count_found(parse_checked_toml(statement), keys)
    return found


def _count_found(tables: Any, keys: Sequence[str]) -> int:
    count = 0
    for key in keys:
        if not isinstance(tables, dict) or key not in tables:
            break
        tables = tables[key]
        count += 1
    return count


def _count_levels(tables: Any) -> int:
    """Count the names in a header; each is the only one in its table."""
    count = 0
    while isinstance(tables, dict) and tables:
        tables = next(iter(tables.values()))
        count += 1
    return count
