"""Saving and restoring the state of a world."""

from __future__ import annotations

from typing import Any

from voxshell.simulation.state import WorldState, find_fitting
from voxshell.simulation.world_view import ViewedWorld


class WorldWithStates(ViewedWorld):
    """A world whose state can be saved and restored."""

    __slots__ = ("_settings",)

    _settings: dict[str, Any]

    def save_state(self) -> WorldState:
        """Save everything that moves, for :meth:`restore_state`.

        The state contains poses, velocities, pending forces and sleep; gravity; contacts with their
        cached impulses; motors, and how many turns hinges have made; friction, restitution, damping,
        groups and pairs that do not collide. It does not contain bodies and joints themselves: they
        must be the same at :meth:`restore_state`, which may be that of another world with an equal
        scene. :meth:`WorldState.save` writes a state to a file.

        After both calls, the same steps give the same bits, because both calls rebuild Bullet's
        caches (its tree of bounds, pairs, contact points) from the state alone. A run in which a
        state was saved therefore differs by rounding errors from a run without: resting bodies lose
        cached data about their contacts.

        Returns:
            The state.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> ground = world.add(vx.Plane(), mass=0)
            >>> ball = world.add(vx.Sphere(0.1))
            >>> state = world.save_state()
            >>> world.step(100)
            >>> first = ball.pose
            >>> world.restore_state(state)
            >>> world.step(100)
            >>> bool((ball.pose == first).all())
            True
        """
        return WorldState(
            self._simulation.save(), self._simulation, self._settings, self.bodies, self.joints
        )

    def restore_state(self, state: WorldState) -> None:
        """Return to a state of :meth:`save_state`; this can be repeated.

        The state may come from another world, or with :meth:`WorldState.load` from a file, if the scenes
        are equal: the same settings of the world, except ``threads``, and the same bodies and joints
        with the same names in the same order. The next steps then have the same bits as those of the
        other world, with the same version of voxshell.

        Recorders and timings continue; they do not go back.

        Raises:
            InputTypeError: ``state`` is not a state.
            SettingsError: It belongs to a world with another scene, or bodies or joints were added or
                removed since. The message says what differs.
        """
        fitting = find_fitting(self._simulation, self._settings, self.bodies, self.joints, state)
        self._simulation.restore(fitting)
