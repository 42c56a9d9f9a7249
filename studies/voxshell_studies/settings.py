"""Settings of experiments: dataclasses whose fields a TOML file can override."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from voxshell.base.settings import override, parse_toml, read_text
from voxshell.errors import SettingsError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

__all__ = ["check_scenes", "choose_scenes", "override", "read_settings_file"]

Scene = TypeVar("Scene")


def check_scenes(names: Iterable[str], scenes: Mapping[str, object]) -> None:
    """Check names of scenes in a study's settings.

    Raises:
        SettingsError: A name is not a key of ``scenes``.
    """
    for name in names:
        if name not in scenes:
            raise SettingsError(f"scenes: unknown scene {name!r}")


def choose_scenes(names: tuple[str, ...], scenes: Mapping[str, Scene]) -> tuple[Scene, ...]:
    """Return the named scenes; all if there are no names.

    Example:
        >>> choose_scenes((), {"ramp": 1, "stack": 2})
        (1, 2)
    """
    return tuple(scenes[name] for name in names or scenes)


def read_settings_file(path: Path) -> dict[str, dict[str, Any]]:
    """Return the tables of a TOML file, one for each experiment.

    Raises:
        MissingFileError: It does not exist.
        SettingsError: It is not TOML, or contains something other than tables.
        FileAccessError: The system refuses to read it.
    """
    try:
        text = read_text(path, "settings file")
    except UnicodeDecodeError as error:
        raise SettingsError(f"{path}: {error}") from error
    try:
        tables = parse_toml(text)
    except SettingsError as error:
        raise SettingsError(f"{path}: {error}") from error
    for name, table in tables.items():
        if not isinstance(table, dict):
            raise SettingsError(
                f"{path}: {name[:80]} = {str(table)[:80]} stands outside a table; begin with "
                "[ball], [bunny], ..."
            )
    return tables
