"""Settings of experiments: dataclasses whose fields a TOML file can override."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from voxshell.base.settings import override, parse_toml, read_text
from voxshell.errors import SettingsError

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["override", "read_settings_file"]


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
