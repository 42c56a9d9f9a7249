"""Settings as typed dataclasses whose fields a TOML file can override."""

from __future__ import annotations

import re
from dataclasses import MISSING, fields, is_dataclass, replace
from functools import cache
from types import UnionType
from typing import TYPE_CHECKING, Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from voxshell.base.arguments import as_choice, show_value
from voxshell.base.input_files import read_needed_file
from voxshell.errors import SettingsError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

Settings = TypeVar("Settings")


_MOST_CHARACTERS = 500_000
"""Largest length of a TOML text: some 5,000 bodies. The parser takes up to half a second for it."""

_LARGEST = 2**63
"""Range of integers in TOML's specification."""

_LONGEST_SHOWN = 80
_MOST_NAMES = 20
"""Number of names that an error message lists."""

_MOST_PARTS = 100
"""Parts of a dotted key. The parser's time grows with their square: 90 s for 100,000."""

TOML_TOKEN = re.compile(
    r'''"""(?:\\.|[^\\])*?"""(?:"{0,2})|\'{3}.*?\'{3}(?:\'{0,2})|"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\''''
    r"|#[^\n]*|[\[\]{}]|\n",
    re.DOTALL,
)
"""Matches what delimits the statements of a TOML text: strings, comments, brackets, newlines."""

_MOST_NESTED = 100
"""Depth of nested brackets. The parser's time grows with its square: 10 s for 100,000."""

_GIVEN_TWICE = "Cannot overwrite a value"
"""What Python's parser says of a key that is there twice."""

_DOTTED = re.compile(rf"(?<![\w-])(?:[\w-]+[ \t]*\.[ \t]*){{{_MOST_PARTS}}}")


def read_text(path: Path, what: str) -> str:
    """Read a text file.

    Args:
        path: The file's path.
        what: Kind of file, for error messages: "scene file".

    Raises:
        MissingFileError: The file does not exist.
        SettingsError: The file is not a regular file, is too large, or the system refuses to read
            it. The message names the file.
        UnicodeDecodeError: The text is not UTF-8.
    """
    # A character takes at most four bytes.
    data = read_needed_file(path, 4 * _MOST_CHARACTERS, what)
    text = data.decode("utf-8-sig")  # editors of Windows begin a file with a byte order mark
    return text.replace("\r\n", "\n").replace("\r", "\n")


def parse_toml(text: str) -> dict[str, Any]:
    """Parse a TOML text.

    Raises:
        SettingsError: The text is not valid TOML; the message gives the line.
    """
    if len(text) > _MOST_CHARACTERS:
        raise SettingsError(
            f"TOML exceeds a limit: it has {len(text)} characters, and at most {_MOST_CHARACTERS} are "
            "read; shorten it, or split it into several files"
        )
    _check_keys(text)
    _check_depth(text)
    return parse_checked_toml(text)


def parse_checked_toml(text: str) -> dict[str, Any]:
    """Parse a part of a text that :func:`parse_toml` has accepted; its bounds hold for the part.

    Raises:
        SettingsError: The text is not valid TOML; the message gives the line.
    """
    try:
        import tomllib  # pyright: ignore[reportMissingImports]
    except ModuleNotFoundError:  # before Python 3.11
        import tomli as tomllib  # pyright: ignore[reportMissingImports]
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        why = str(error).replace(_GIVEN_TWICE, "a key is given twice")
        raise SettingsError(f"not valid TOML: {why}") from error
    except ValueError as error:  # Python limits the digits of an integer
        number = re.search(r"\d{4000,}", text)
        line = 1 if number is None else _count_lines(text, number.start())
        raise SettingsError(f"TOML exceeds a limit: {error} (at line {line})") from None


def _check_keys(text: str) -> None:
    """Refuse dotted keys of very many parts, including quoted ones."""
    # Only the newlines of strings and comments matter.
    plain = TOML_TOKEN.sub(lambda token: "\n" * token[0].count("\n") or "x", text)
    if found := _DOTTED.search(plain):
        raise SettingsError(
            f"TOML exceeds a limit: a key has more than {_MOST_PARTS} parts (at line "
            f"{_count_lines(plain, found.start())})"
        )


def _check_depth(text: str) -> None:
    """Refuse deeply nested brackets."""
    depth = 0
    line = 1
    for token in TOML_TOKEN.finditer(text):
        line += token[0].count("\n")
        depth += (token[0] in "[{") - (token[0] in "]}")
        if depth > _MOST_NESTED:
            raise SettingsError(
                f"TOML exceeds a limit: brackets are nested more than {_MOST_NESTED} deep (at line {line})"
            )


def _count_lines(text: str, end: int) -> int:
    return text.count("\n", 0, end) + 1


def override(settings: Settings, table: Mapping[str, Any], name: str) -> Settings:
    """Return a copy of settings with some fields replaced.

    Args:
        settings: A frozen dataclass.
        table: Values by field name, as parsed from TOML; lists become tuples.
        name: The table's name, for error messages.

    Raises:
        SettingsError: A key is unknown, or a value has a wrong type or range; the message names the
            key.

    Example:
        >>> from dataclasses import dataclass
        >>> @dataclass(frozen=True)
        ... class Fall:
        ...     height: float = 1.0
        >>> override(Fall(), {"height": 2}, "fall")
        Fall(height=2.0)
        >>> override(Fall(), {"hight": 2}, "fall")
        Traceback (most recent call last):
        voxshell.errors.SettingsError: fall.hight: unknown setting; valid settings: height
    """
    changes = _convert_table(type(settings), table, name)
    try:
        return replace(settings, **changes)  # pyright: ignore[reportArgumentType]
    except SettingsError as error:
        raise SettingsError(f"{name}.{error}") from error


def make(kind: type[Settings], table: Mapping[str, Any], name: str) -> Settings:
    """Make settings from a table that must give every field without a default.

    Args:
        kind: A frozen dataclass.
        table: Values by field name, as parsed from TOML; lists become tuples.
        name: The table's name, for error messages.

    Raises:
        SettingsError: As for :func:`override`, or a field is missing.
    """
    values = _convert_table(kind, table, name)
    for each in fields(kind):  # pyright: ignore[reportArgumentType]
        if each.name not in values and each.default is MISSING:
            raise SettingsError(f"{name}.{each.name} must be given")
    try:
        return kind(**values)
    except SettingsError as error:
        raise SettingsError(f"{name}.{error}") from error


def _convert_table(kind: type[Any], table: Mapping[str, Any], name: str) -> dict[str, Any]:
    types = _find_types(kind)
    known = [each.name for each in fields(kind)]
    values = {}
    for key, value in table.items():
        if key not in known:
            raise SettingsError(
                f"{name}.{key[:80]}: unknown setting; valid settings: {', '.join(known)}"
            )
        values[key] = _convert(value, types[key], f"{name}.{key}")
    return values


@cache
def _find_types(kind: type[Any]) -> dict[str, Any]:
    """Return the types of a dataclass's fields, which Python evaluates from texts in 0.5 ms."""
    return get_type_hints(kind)


def _convert(value: Any, kind: Any, name: str) -> Any:
    """Return a value as the type of its field."""
    origin = get_origin(kind)
    if origin in (Union, UnionType):
        return _convert(value, next(k for k in get_args(kind) if k is not type(None)), name)
    if origin is tuple:
        if not isinstance(value, list):
            raise SettingsError(f"{name} must be a list, not {show_value(value)}")
        item = get_args(kind)[0]
        return tuple(_convert(each, item, f"{name}[{i}]") for i, each in enumerate(value))
    if isinstance(kind, type) and is_dataclass(kind):
        if not isinstance(value, dict):
            raise SettingsError(f"{name} must be a table, not {show_value(value)}")
        return make(kind, value, name)
    if origin is Literal:
        return as_choice(value, name, get_args(kind))
    words = {float: "a number", int: "an integer", str: "a string", bool: "true or false"}
    # TOML writes 2 for the float 2.0, and in Python True is an int.
    accepted = (int, float) if kind is float else (kind,)
    if not isinstance(value, accepted) or (isinstance(value, bool) and kind is not bool):
        raise SettingsError(f"{name} must be {words[kind]}, not {show_value(value)}")
    if isinstance(value, int) and abs(value) > _LARGEST:
        raise SettingsError(
            f"{name} must be {words[kind]} from -2^63 to 2^63, not {show_value(value)}"
        )
    return kind(value)


def list_names(names: Iterable[str]) -> str:
    """Return names for an error message: all of a few, and the first ones of many.

    Example:
        >>> list_names(["a", "b"])
        'a, b'
        >>> list_names(str(number) for number in range(100)).endswith("18, 19, and 80 more")
        True
    """
    known = list(names)
    shown = ", ".join(name[:_LONGEST_SHOWN] for name in known[:_MOST_NAMES])
    more = len(known) - _MOST_NAMES
    return f"{shown}, and {more} more" if more > 0 else shown
