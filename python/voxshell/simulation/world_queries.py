"""Queries of a world: contacts, rays and timings."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from voxshell.base.arguments import FARTHEST, as_floats, as_not_negative
from voxshell.errors import SettingsError
from voxshell.model.shapes import Plane
from voxshell.simulation.comparison_shapes import GImpact
from voxshell.simulation.forks import Using
from voxshell.simulation.tables import as_contacts, as_hits, as_timings, take_contacts
from voxshell.simulation.world_contents import WorldContents

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from voxshell.simulation.body import Body


class WorldQueries(WorldContents):
    """The contents of a world, with queries."""

    __slots__ = ()

    def ray_cast(self, starts: ArrayLike, ends: ArrayLike) -> NDArray[np.void]:
        """Return the first hit of each ray, among all bodies in their present poses.

        Rays hit the triangles of a model's mesh from either side.

        Args:
            starts: (n, 3), meters, world frame, within 1e15 m; or (3,) for one ray.
            ends: Likewise.

        Returns:
            (n,) structured array: ``body`` (its number; -1 without a hit), ``fraction`` (of the
            ray, 0 to 1), ``point`` ((3,), meters, world frame; the ray's end without a hit) and
            ``normal`` ((3,), unit normal of the surface; zero without a hit).

        Raises:
            SettingsError: The arrays differ in shape, or a number is not finite or beyond 1e15.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> ground = world.add(vx.Plane(), mass=0)
            >>> hits = world.ray_cast([(0, 0, 2), (0, 0, 2)], [(1, 0, -2), (0, 0, 1)])
            >>> hits["body"].tolist(), hits["fraction"].tolist()
            ([0, -1], [0.5, 1.0])
            >>> hits["point"][0]
            array([0.5, 0. , 0. ])
        """
        first, last = _as_rows(starts, "starts"), _as_rows(ends, "ends")
        if first.shape != last.shape:
            raise SettingsError(
                "starts and ends must have the same shape, not "
                f"{np.shape(starts)} and {np.shape(ends)}"
            )
        for name, points in (("starts", first), ("ends", last)):
            if not np.isfinite(points).all():
                raise SettingsError(f"{name} must be finite")
            farthest = float(np.abs(points).max(initial=0.0))
            if farthest > FARTHEST:
                raise SettingsError(
                    f"{name} must be within {FARTHEST:g} m of the origin, not {farthest:g}"
                )
        with Using(self):
            return as_hits(self._simulation.cast_rays(first, last))

    def query_contacts(
        self, a: Body, b: Body | None = None, *, margin: float = 0.0
    ) -> NDArray[np.void]:
        """Return the contacts of a body with another, or with all others, in their present poses.

        This query considers geometry alone: it also finds bodies that groups, pairs or joints keep
        from colliding. It does not affect the simulation.

        Args:
            a: A body.
            b: Another body. None: all others.
            margin: Meters. Points within this distance count as well, with a negative depth. For
                pairs with a model, the result includes the nearest point.

        Returns:
            An array like that of :meth:`contacts`, with up to four points for each pair of parts;
            ``body_a`` is the body ``a``, and ``impulse`` is 0.

        Raises:
            InputTypeError: ``a`` or ``b`` is not a body.
            SettingsError: One belongs to another world or has been removed; both are the same;
                ``margin`` is below 0; or one is a :class:`GImpact` and the other a GImpact or a plane, a pair that Bullet
                cannot query.

        Example:
            >>> import numpy as np
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> ground = world.add(vx.Plane(), mass=0)
            >>> above = np.eye(4)
            >>> above[2, 3] = 0.15
            >>> ball = world.add(vx.Sphere(0.1), pose=above)
            >>> len(world.query_contacts(ball))
            0
            >>> float(world.query_contacts(ball, margin=0.1)["depth"][0])
            -0.04...
        """
        self._check_own(a, "a")
        reach = as_not_negative(margin, "margin")
        if b is not None:
            self._check_two(a, b)
        others = [b] if b is not None else [body for body in self.bodies if body is not a]
        for other in others:
            _refuse_unanswered(a, other)
        rows = [self._simulation.find_contacts(a.number, it.number, reach) for it in others]
        found = np.concatenate(rows) if rows else np.empty((0, 17))
        return as_contacts(take_contacts(found, a.number))

    def overlaps(self, a: Body, b: Body) -> bool:
        """Return whether two bodies touch or overlap in their present poses.

        Raises:
            InputTypeError: ``a`` or ``b`` is not a body.
            SettingsError: As for :meth:`query_contacts`.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> a, b = world.add(vx.Sphere(0.1)), world.add(vx.Box((1, 1, 1)))
            >>> world.overlaps(a, b)
            True
        """
        return len(self.query_contacts(a, b)) > 0

    def contacts(self, a: Body | None = None, b: Body | None = None) -> NDArray[np.void]:
        """Return the contact points of the last step, as Bullet's solver used them.

        Args:
            a: A body. Only its contacts are returned, and it is ``body_a`` in all of them, so that
                normals point toward it. None: all contacts, in which either body may be ``body_a``.
            b: Another body. Only contacts of ``a`` with it are returned.

        Returns:
            (n,) structured array: ``body_a``, ``body_b`` (numbers of bodies), ``id`` (of the
            shell's element), ``point_a``, ``point_b`` and ``normal`` ((3,), meters, world frame,
            the normal on body b and toward body a), ``depth`` (meters, positive where the bodies
            overlap), ``impulse`` (normal impulse of the last step, N s) and ``friction`` ((3,),
            impulse of friction on body a in the last step, N s, world frame). The force on body a at
            ``point_a`` is ``(impulse * normal + friction) / world.time_step``, newtons, and on body b
            the opposite.

        Raises:
            InputTypeError: ``a`` or ``b`` is not a body.
            SettingsError: One belongs to another world or has been removed, both are the same, or
                ``b`` is given without ``a``.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> ground = world.add(vx.Plane(), mass=0)
            >>> ball = world.add(vx.Sphere(0.1), mass=2.0, pose=(0, 0, 0.1))
            >>> world.step(100)
            >>> round(float(world.contacts()["impulse"].sum() / world.time_step), 2)  # newtons
            19.62
            >>> push = world.contacts(ground)  # the ground is body a: the ball pushes it down
            >>> push["normal"][0] + 0.0
            array([ 0.,  0., -1.])
        """
        if a is None:
            if b is not None:
                raise SettingsError("b is given without a: pass a body alone as a")
            return as_contacts(self._simulation.contacts())
        self._check_own(a, "a")
        if b is not None:
            self._check_two(a, b)
        other = None if b is None else b.number
        return as_contacts(take_contacts(self._simulation.contacts(), a.number, other))

    @property
    def timings(self) -> NDArray[np.void]:
        """Durations of the steps since the start or :meth:`clear_timings`, seconds, (steps,).

        They are a structured array. After more than 100,000 steps, only the last 100,000 are kept.

        ``step`` is all of Bullet's step. ``narrow_phase`` is the collision algorithms of all pairs
        and shapes. ``query``, ``reduction`` and ``manifold`` are the models' part of that: finding
        contacts, choosing points, and passing them to Bullet. If several threads find contacts,
        ``query`` is the time until all of them are done, and includes the choice of pairs that
        touch.
        """
        return as_timings(self._simulation.timings())

    def clear_timings(self) -> None:
        """Delete the :attr:`timings` so far, for example after a warm-up.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> world.step(10)
            >>> world.clear_timings()
            >>> world.step(3)
            >>> len(world.timings)
            3
        """
        self._simulation.clear_timings()


def _as_rows(value: ArrayLike, name: str) -> NDArray[np.float64]:
    """Return the points, (n, 3), of one or many rays."""
    with suppress(TypeError, ValueError):  # as_floats raises the error
        if np.shape(value) == (3,):
            value = np.atleast_2d(value)
    return as_floats(value, name, (None, 3), meaning=" in meters, or (3,) for one ray")


def _refuse_unanswered(a: Body, b: Body) -> None:
    """Refuse pairs for which Bullet's contact test never finds anything."""
    for first, second in ((a, b), (b, a)):
        if isinstance(first.shape, GImpact) and isinstance(second.shape, (GImpact, Plane)):
            raise SettingsError(
                f"Bullet cannot query contacts of {first.name!r}, a GImpact, with {second.name!r}, a "
                f"{type(second.shape).__name__}, outside of a step: call World.contacts() after a step"
            )
