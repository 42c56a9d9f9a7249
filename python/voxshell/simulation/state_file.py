"""Files of states of worlds: tables of numbers, and a header that describes the scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell import _bullet
from voxshell.base.arguments import show_value
from voxshell.base.array_file import FileKind
from voxshell.errors import SimulationError, StateError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

_KIND = FileKind("world state", 1, StateError)


def write_state(path: Path, state: _bullet.SimulationState, scene: Mapping[str, Any]) -> None:
    """Write a state completely or not at all.

    Raises:
        SettingsError: No file can be written there.
        FileAccessError: The system refuses to write it.
        SimulationError: The simulation had diverged.
    """
    tables = state.to_rows()
    if not all(np.isfinite(table).all() for table in tables.values()):
        raise SimulationError(
            f"cannot write {path}: the simulation had diverged when its state was saved, so the state "
            "has numbers that are not finite"
        )
    _KIND.write(path, {"scene": scene}, tables)


def read_state(path: Path) -> tuple[_bullet.SimulationState, dict[str, Any]]:
    """Return a state, and the description of its scene.

    Raises:
        MissingFileError: The file does not exist.
        FileAccessError: The system refuses to read it.
        SettingsError: It is a folder or a device.
        StateError: It is damaged, is not a state, or has a version that this package does not read.
        MemoryLimitError: Its arrays have more than 4 GiB, or there is no memory for them.
    """
    return _KIND.read(path, _make)


def _make(
    header: dict[str, Any], arrays: Mapping[str, NDArray[Any]]
) -> tuple[_bullet.SimulationState, dict[str, Any]]:
    scene = header["scene"]
    _check_scene(scene)
    tables = {name: table for name, table in arrays.items() if name != "header"}
    for name, table in tables.items():
        if table.dtype != np.float64 or table.ndim != 2:
            raise ValueError(f"its table {show_value(name)} does not consist of rows of float64")
    ordered = {name: np.ascontiguousarray(table) for name, table in tables.items()}
    return _bullet.SimulationState.from_rows(ordered), scene


def _check_scene(scene: Any) -> None:
    """Refuse what no world describes.

    Raises:
        ValueError: The scene has a wrong form.
    """
    form = {"settings": dict, "bodies": list, "joints": list}
    if not isinstance(scene, dict) or not all(
        isinstance(scene.get(name), kind) for name, kind in form.items()
    ):
        raise ValueError("its scene has no settings, bodies and joints")
    if not all(isinstance(part, dict) for part in scene["bodies"] + scene["joints"]):
        raise ValueError("its scene has a body or a joint that is not an object")
