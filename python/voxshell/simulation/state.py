"""Saved states of a world."""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn

from voxshell.base.settings import list_names
from voxshell.errors import InputTypeError, SettingsError

if TYPE_CHECKING:
    from voxshell import _bullet
    from voxshell.simulation.body import Body
    from voxshell.simulation.joints import Joint


class WorldState:
    """A state that :meth:`World.save_state` saved, for :meth:`World.restore_state`.

    It fits only the world that it was saved from, with the same bodies and joints.
    """

    __slots__ = ("_bodies", "_joints", "_simulation", "_state")

    def __init__(
        self,
        simulation: _bullet.Simulation,
        bodies: tuple[Body, ...],
        joints: tuple[Joint, ...],
    ) -> None:
        self._simulation = simulation
        self._state = simulation.save()
        self._bodies = bodies
        self._joints = joints

    def __reduce__(self) -> NoReturn:
        raise InputTypeError(
            "a WorldState cannot be copied or pickled, because it fits only its world: keep it, and pass it to "
            "that world's restore_state() as often as you like"
        )

    def __repr__(self) -> str:
        return f"WorldState({len(self._bodies)} bodies, {len(self._joints)} joints)"


def check_same(
    simulation: _bullet.Simulation,
    bodies: tuple[Body, ...],
    joints: tuple[Joint, ...],
    state: WorldState,
) -> None:
    """Check that a simulation with these bodies and joints can return to a state.

    Raises:
        InputTypeError: ``state`` is not a state.
        SettingsError: It belongs to another world, or bodies or joints were added or removed since.
    """
    if not isinstance(state, WorldState):
        raise InputTypeError(f"state must come from World.save_state(), not {type(state).__name__}")
    if state._simulation is not simulation:
        raise SettingsError("the state belongs to another world")
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
