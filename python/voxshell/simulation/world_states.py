"""Saving and restoring the state of a world."""

from __future__ import annotations

from voxshell.simulation.state import WorldState, check_same
from voxshell.simulation.world_view import ViewedWorld


class WorldWithStates(ViewedWorld):
    """A world whose state can be saved and restored."""

    __slots__ = ()

    def save_state(self) -> WorldState:
        """Save everything that moves, for :meth:`restore_state`.

        The state contains poses, velocities, pending forces and sleep; gravity; contacts with their
        cached impulses; motors, and how many turns hinges have made; friction, restitution, damping,
        groups and pairs that do not collide. It does not contain bodies and joints themselves: they
        must be the same at :meth:`restore_state`.

        After both calls, the same steps give the same bits, because both calls rebuild Bullet's
        caches (its tree of bounds, pairs, contact points) from the state alone. A run in which a
        state was saved therefore differs by rounding errors from a run without: resting bodies lose
        cached data about their contacts.

        Returns:
            The state; it fits only this world.

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
        return WorldState(self._simulation, self.bodies, self.joints)

    def restore_state(self, state: WorldState) -> None:
        """Return to a state of :meth:`save_state`; this can be repeated.

        Recorders and timings continue; they do not go back.

        Raises:
            InputTypeError: ``state`` is not a state.
            SettingsError: It belongs to another world, or bodies or joints were added or removed
                since.
        """
        check_same(self._simulation, self.bodies, self.joints, state)
        self._simulation.restore(state._state)
