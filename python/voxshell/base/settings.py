"""Settings as typed dataclasses, whose fields a TOML file can override."""

from __future__ import annotations

import re
from dataclasses import MISSING, fields, replace
from types import UnionType
from typing import TYPE_CHECKING, Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from voxshell.base.input_files import read_small_file
from voxshell.errors import SettingsError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

Settings = TypeVar("Settings")


_MOST_CHARACTERS = 2_000_000
"""Of a text; the parser takes a second or two."""

_LARGEST = 2**63
"""Of integers, as in TOML's own definition."""

_LONGEST_SHOWN = 80

_MOST_PARTS = 100
"""Of a dotted key; the parser takes time that grows as their square, 90 s for 100,000."""

TOML_TOKEN = re.compile(
    r'''"""(?:\\.|[^\\])*?"""(?:"{0,2})|\'{3}.*?\'{3}(?:\'{0,2})|"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\''''
    r"|#[^\n]*|[\[\]{}]|\n",
    re.DOTALL,
)
"""Texts, comments, brackets and ends of lines of a TOML text: what its statements are told apart by."""

_MOST_NESTED = 100
"""Brackets in each other; the parser takes time that grows as their square, 10 s for 100,000."""

_DOTTED = re.compile(rf"(?<![\w-])(?:[\w-]+[ \t]*\.[ \t]*){{{_MOST_PARTS}}}")


def read_text(path: Path, what: str) -> str:
    """Reads a text file.

    Args:
        path: Of the file.
        what: Kind of file, for errors: "scene file".

    Raises:
        SettingsError: The file does not exist, is not a regular file, or is too large. The message
            names it.
        FileAccessError: The system does not let it be read.
        UnicodeDecodeError: The text is not UTF-8.
    """
    # A character takes four bytes at most.
    text = read_small_file(path, 4 * _MOST_CHARACTERS, what).decode("utf-8")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def parse_toml(text: str) -> dict[str, Any]:
    """What a TOML text holds.

    Raises:
        SettingsError: It is no TOML; says at which line.
    """
    try:
        import tomllib  # pyright: ignore[reportMissingImports]
    except ModuleNotFoundError:  # before Python 3.11
        import tomli as tomllib  # pyright: ignore[reportMissingImports]
    if len(text) > _MOST_CHARACTERS:
        raise SettingsError(
            f"no TOML that is read: it has {len(text)} characters, and at most {_MOST_CHARACTERS} are "
            "read"
        )
    _check_keys(text)
    _check_depth(text)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise SettingsError(f"no TOML: {error}") from error
    except ValueError as error:  # of Python's own limit of the digits of an integer
        number = re.search(r"\d{4000,}", text)
        line = 1 if number is None else _count_lines(text, number.start())
        raise SettingsError(f"no TOML that is read: {error} (at line {line})") from None


def _check_keys(text: str) -> None:
    """Refuses keys of very many parts, quoted ones, too."""
    # Of texts and comments only the lines count.
    plain = TOML_TOKEN.sub(lambda token: "\n" * token[0].count("\n") or "x", text)
    if found := _DOTTED.search(plain):
        raise SettingsError(
            f"no TOML that is read: a key has more than {_MOST_PARTS} parts (at line "
            f"{_count_lines(plain, found.start())})"
        )


def _check_depth(text: str) -> None:
    """Refuses brackets that are nested deeply."""
    depth = 0
    line = 1
    for token in TOML_TOKEN.finditer(text):
        line += token[0].count("\n")
        depth += (token[0] in "[{") - (token[0] in "]}")
        if depth > _MOST_NESTED:
            raise SettingsError(
                f"no TOML that is read: brackets are nested too deeply (at line {line})"
            )


def _count_lines(text: str, end: int) -> int:
    return text.count("\n", 0, end) + 1


def override(settings: Settings, table: Mapping[str, Any], name: str) -> Settings:
    """The same settings with some fields replaced.

    Args:
        settings: A frozen dataclass.
        table: Values by field, as TOML has them; lists become tuples.
        name: Of the table, for errors.

    Raises:
        SettingsError: A key is no field, or a value is not of its type or range; it names the key.

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
    """Settings from a table that gives all fields without a default.

    Args:
        kind: A frozen dataclass.
        table: Values by field, as TOML has them; lists become tuples.
        name: Of the table, for errors.

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
    types = get_type_hints(kind)
    known = [each.name for each in fields(kind)]
    values = {}
    for key, value in table.items():
        if key not in known:
            raise SettingsError(
                f"{name}.{key[:80]}: unknown setting; valid settings: {', '.join(known)}"
            )
        values[key] = _convert(value, types[key], f"{name}.{key}")
    return values


def _convert(value: Any, kind: Any, name: str) -> Any:
    """The value as its field's type has it."""
    origin = get_origin(kind)
    if origin in (Union, UnionType):
        return _convert(value, next(k for k in get_args(kind) if k is not type(None)), name)
    if origin is tuple:
        if not isinstance(value, list):
            raise SettingsError(f"{name} must be a list, not {_show(value)}")
        item = get_args(kind)[0]
        return tuple(_convert(each, item, f"{name}[{i}]") for i, each in enumerate(value))
    if origin is Literal:
        if value not in get_args(kind):
            raise SettingsError(
                f"{name} must be one of {', '.join(map(repr, get_args(kind)))}, not {_show(value)}"
            )
        return value
    words = {float: "a number", int: "an integer", str: "a text", bool: "true or false"}
    # TOML writes 2 for a float of 2, and True is an int to Python.
    accepted = (int, float) if kind is float else (kind,)
    if not isinstance(value, accepted) or (isinstance(value, bool) and kind is not bool):
        raise SettingsError(f"{name} must be {words[kind]}, not {_show(value)}")
    if isinstance(value, int) and abs(value) > _LARGEST:
        raise SettingsError(f"{name} must be {words[kind]} from -2^63 to 2^63, not {_show(value)}")
    return kind(value)


def _show(value: Any) -> str:
    """As Python writes it, in a line."""
    if isinstance(value, int) and abs(value) > _LARGEST:
        return f"an integer of {value.bit_length()} bits"
    try:
        text = repr(value)
    except ValueError:  # of Python's own limit of the digits of an integer
        return f"a {type(value).__name__} with an integer of too many digits"
    return text if len(text) <= _LONGEST_SHOWN else f"{text[:_LONGEST_SHOWN]}..."
