"""Saved states of a world."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from voxshell.base.arguments import as_path
from voxshell.base.array_file import SUFFIX
from voxshell.base.calls import explain_calls
from voxshell.base.outputs import check_output_file, check_suffix
from voxshell.base.settings import list_names
from voxshell.errors import InputTypeError, SettingsError
from voxshell.simulation.scene_identity import describe_scene, find_difference
from voxshell.simulation.state_file import read_state, write_state

if TYPE_CHECKING:
    from collections.abc import Mapping

    from voxshell import _bullet
    from voxshell.simulation.body import Body
    from voxshell.simulation.joints import Joint


@explain_calls
class WorldState:
    """A state that :meth:`World.save_state` saved, for :meth:`World.restore_state`.

    It fits the world that it was saved from, and any other world with an equal scene, also in another
    process: the same settings, and the same bodies and joints in the same order.
    """

    __slots__ = ("_bodies", "_described", "_joints", "_settings", "_simulation", "_state")

    def __init__(
        self,
        core: _bullet.SimulationState | None = None,
        simulation: _bullet.Simulation | None = None,
        settings: Mapping[str, Any] | None = None,
        bodies: tuple[Body, ...] = (),
        joints: tuple[Joint, ...] = (),
        described: dict[str, Any] | None = None,
    ) -> None:
        if core is None:
            raise InputTypeError("a state comes from World.save_state() or WorldState.load(path)")
        self._state = core
        self._simulation = simulation  # None if it comes from a file
        self._settings = settings or {}
        self._bodies = bodies
        self._joints = joints
        self._described = described  # the scene; None until it is needed

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the state to a file, which :meth:`load` reads, also in another process.

        The file does not contain shapes: the world that it is loaded into must have them.

        Args:
            path: The file, with the suffix .npz; written completely or not at all.

        Returns:
            The path of the file.

        Raises:
            SettingsError: The suffix is another one, or the path is a folder, a device or a pipe.
            FileAccessError: The file cannot be written, or its folder does not exist.
            SimulationError: The simulation had diverged.
            InputTypeError: ``path`` is not a path.

        Example:
            >>> import tempfile
            >>> import voxshell as vx
            >>> def make_world():
            ...     world = vx.World()
            ...     world.add(vx.Plane(), mass=0)
            ...     world.add(vx.Box((0.1, 0.1, 0.1)), pose=(0, 0, 0.5), name="box")
            ...     return world
            >>> first, second = make_world(), make_world()
            >>> first.step(50)
            >>> with tempfile.TemporaryDirectory() as folder:
            ...     path = first.save_state().save(folder + "/falling.npz")
            ...     second.restore_state(vx.WorldState.load(path))
            >>> first.step(100)
            >>> second.step(100)
            >>> bool((first.bodies[1].pose == second.bodies[1].pose).all())
            True
        """
        place = Path(os.fsdecode(as_path(path, "path")))
        check_output_file(place)
        check_suffix(place, (SUFFIX,), "a state")
        write_state(place, self._state, self._describe())
        return place

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> WorldState:
        """Read a state that :meth:`save` wrote.

        Args:
            path: The file's path.

        Returns:
            The state, for :meth:`World.restore_state` of a world with an equal scene.

        Raises:
            MissingFileError: The file does not exist.
            FileAccessError: The file cannot be read.
            StateError: It is damaged, is not a state, or has another version.
            MemoryLimitError: Its arrays have more than 4 GiB, or there is no memory for them.
            SettingsError: It is a folder or a device.
            InputTypeError: ``path`` is not a path.

        Example:
            >>> import voxshell as vx
            >>> vx.WorldState.load("pyproject.toml")
            Traceback (most recent call last):
            voxshell.errors.StateError: cannot read the world state pyproject.toml: it is not a world state (.npz)
        """
        core, described = read_state(Path(os.fsdecode(as_path(path, "path"))))
        return cls(core, described=described)

    def _describe(self) -> dict[str, Any]:
        """Return the description of the scene."""
        if self._described is None:
            self._described = describe_scene(self._settings, self._bodies, self._joints)
        return self._described

    def __reduce__(self) -> NoReturn:
        raise InputTypeError(
            "a WorldState cannot be copied or pickled: keep it, and pass it to restore_state() as often as you "
            "like; for another process, write it to a file with save(path)"
        )

    def __repr__(self) -> str:
        described = self._described or {"bodies": self._bodies, "joints": self._joints}
        return f"WorldState({len(described['bodies'])} bodies, {len(described['joints'])} joints)"


def find_fitting(
    simulation: _bullet.Simulation,
    settings: Mapping[str, Any],
    bodies: tuple[Body, ...],
    joints: tuple[Joint, ...],
    state: WorldState,
) -> _bullet.SimulationState:
    """Return a state as a simulation with these bodies and joints can restore it.

    Raises:
        InputTypeError: ``state`` is not a state.
        SettingsError: It belongs to a world with another scene, or bodies or joints were added or
            removed since.
    """
    if not isinstance(state, WorldState):
        raise InputTypeError(
            "state must come from World.save_state() or WorldState.load(path), not "
            f"{type(state).__name__}"
        )
    if state._simulation is simulation:
        _check_same(state, bodies, joints)
        return state._state
    difference = find_difference(state._describe(), describe_scene(settings, bodies, joints))
    if difference:
        raise SettingsError(
            f"the state belongs to another world, whose scene differs: {difference}; make the world, its bodies "
            "and its joints as those of the state were made"
        )
    return simulation.adopt(state._state)


def _check_same(state: WorldState, bodies: tuple[Body, ...], joints: tuple[Joint, ...]) -> None:
    """Check that a world still has the bodies and joints of its state.

    Raises:
        SettingsError: Some were added or removed since.
    """
    for what, then, now in (
        ("bodies", state._bodies, bodies),
        ("joints", state._joints, joints),
    ):
        added = [it.name for it in now if it not in then]
        gone = [it.name for it in then if it not in now]
        if added or gone:
            changes = [
                f"{len(names)} {how} ({list_names(map(repr, names))})"
                for how, names in (("added", added), ("removed", gone))
                if names
            ]
            raise SettingsError(
                f"the world's {what} have changed since the state was saved: {', '.join(changes)}; "
                "save a new state after bodies or joints change"
            )
