"""Worlds that another thread was using when the process forked, whose turn never ends in the child."""

from __future__ import annotations

import os
import threading
from typing import TYPE_CHECKING, Any, NoReturn, cast

from voxshell.errors import SimulationError

if TYPE_CHECKING:
    from voxshell import _bullet
    from voxshell.simulation.world_contents import WorldContents


class Using:
    """A call of a world's simulation that lets other threads run Python, and fork.

    Example:
        >>> import voxshell as vx
        >>> world = vx.World()
        >>> with Using(world):
        ...     world.step(1)
    """

    __slots__ = ("thread", "world")
    thread: int
    world: WorldContents

    def __init__(self, world: WorldContents) -> None:
        self.world = world
        self.thread = threading.get_ident()

    def __enter__(self) -> None:
        _in_use.add(self)

    def __exit__(self, *_: object) -> None:
        _in_use.discard(self)


class LostSimulation:
    """What a world has instead of its simulation in such a child: everything raises SimulationError."""

    def __init__(self, simulation: _bullet.Simulation) -> None:
        self._left_behind = simulation  # in the middle of a step: it cannot be destroyed, either

    def __getattr__(self, name: str) -> NoReturn:
        raise SimulationError(
            "another thread was stepping this world when the process forked, and its step never ends "
            "in the child: fork between steps, or start processes with spawn"
        )


_in_use: set[Using] = set()


def _lose_worlds() -> None:
    """In a forked child, take the simulations from worlds that other threads were using."""
    for use in tuple(_in_use):
        if use.thread != threading.get_ident():
            _lose(use.world)
            _in_use.discard(use)


def _lose(world: Any) -> None:
    lost = cast("_bullet.Simulation", LostSimulation(world._simulation))
    for part in (*world._bodies, *world._joints):
        part._world = lost
    world._simulation = lost


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_lose_worlds)
