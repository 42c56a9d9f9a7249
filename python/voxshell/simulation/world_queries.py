"""What a world answers: who touches whom, what rays meet, how long steps took."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from voxshell.base.arguments import as_not_negative, as_points
from voxshell.errors import SettingsError
from voxshell.model.shapes import Plane
from voxshell.simulation.comparison_shapes import GImpact
from voxshell.simulation.tables import as_contacts, as_hits, as_timings
from voxshell.simulation.world_contents import WorldContents

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from voxshell.simulation.body import Body


class WorldQueries(WorldContents):
    """A world's contents and the questions that can be asked about them."""

    def ray_cast(self, starts: ArrayLike, ends: ArrayLike) -> NDArray[np.void]:
        """What rays meet first, of all bodies as they stand now.

        Models are met at their meshes' triangles, from either side.

        Args:
            starts: (n, 3), metres, world frame; or (3,) for one ray.
            ends: The same.

        Returns:
            (n,) structured array: ``body`` (its number; -1 where a ray meets nothing), ``fraction`` (of
            the way, 0 to 1), ``point`` ((3,), metres, world frame; the end where it meets nothing) and
            ``normal`` ((3,), of the surface, unit; zero where it meets nothing).

        Raises:
            SettingsError: The arrays are not of the same shape, or a number is not finite.

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
                f"starts and ends must be of the same shape, not {first.shape} and {last.shape}"
            )
        for name, points in (("starts", first), ("ends", last)):
            if not np.isfinite(points).all():
                raise SettingsError(f"{name} must be finite")
        return as_hits(self._simulation.cast_rays(first, last))

    def query_contacts(
        self, a: Body, b: Body | None = None, *, margin: float = 0.0
    ) -> NDArray[np.void]:
        """Where a body touches another, or any other, as they stand now.

        It asks for geometry alone: bodies that are kept apart by groups, pairs or joints are found,
        and the simulation goes on as if nothing had been asked.

        Args:
            a: A body.
            b: Another body; None: all others.
            margin: Metres: places this near count as well, with a negative depth. Of pairs with a
                model, the nearest place is among those that are found.

        Returns:
            As :meth:`contacts`, up to four points of each pair of parts; ``impulse`` is 0.

        Raises:
            InputTypeError: One is no body.
            SettingsError: One is of another world or has been removed, ``margin`` is below 0, or one is
                a :class:`GImpact` and the other that or a plane: Bullet does not tell.

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
            self._check_own(b, "b")
        others = [b] if b is not None else [body for body in self.bodies if body is not a]
        for other in others:
            _refuse_unanswered(a, other)
        rows = [self._simulation.find_contacts(a.number, it.number, reach) for it in others]
        return as_contacts(np.concatenate(rows) if rows else np.empty((0, 14)))

    def overlaps(self, a: Body, b: Body) -> bool:
        """Whether two bodies touch or penetrate each other as they stand now.

        Raises:
            InputTypeError: One is no body.
            SettingsError: As for :meth:`query_contacts`.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> a, b = world.add(vx.Sphere(0.1)), world.add(vx.Box((1, 1, 1)))
            >>> world.overlaps(a, b)
            True
        """
        return len(self.query_contacts(a, b)) > 0

    def contacts(self) -> NDArray[np.void]:
        """The contact points after the last step, as Bullet's solver had them.

        Returns:
            (n,) structured array: ``body_a``, ``body_b`` (numbers of bodies), ``id`` (of the shell's
            point), ``point_a``, ``point_b`` and ``normal`` ((3,), metres, world frame, the normal on
            body b and towards body a), ``depth`` (metres, positive where the bodies overlap) and
            ``impulse`` (normal, N s, of the last step).
        """
        return as_contacts(self._simulation.contacts())

    @property
    def timings(self) -> NDArray[np.void]:
        """Seconds of every step since the start or :meth:`clear_timings`, (steps,) structured array.

        Of long runs, the last 100,000 steps.

        ``step`` is all of Bullet's step; ``narrow_phase`` all pairs' collision algorithms, whatever
        the shapes; ``query``, ``reduction`` and ``manifold`` the models' part of that: finding
        contacts, choosing points, handing them to Bullet. Where several threads find contacts,
        ``query`` is the time until all of them are done, and includes the choice of those that touch.
        """
        return as_timings(self._simulation.timings())

    def clear_timings(self) -> None:
        """Forgets the :attr:`timings` so far, as after a warm-up.

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
    """Points, (n, 3), of one or many."""
    with suppress(TypeError, ValueError):  # as_points says what is wrong
        value = np.atleast_2d(value)
    return as_points(value, name)


def _refuse_unanswered(a: Body, b: Body) -> None:
    """Of these pairs Bullet's contact test finds nothing, wherever they are."""
    for first, second in ((a, b), (b, a)):
        if isinstance(first.shape, GImpact) and isinstance(second.shape, (GImpact, Plane)):
            raise SettingsError(
                f"Bullet does not tell where {first.name!r}, a GImpact, touches {second.name!r}, a "
                f"{type(second.shape).__name__}, outside of a step: see World.contacts() after one"
            )
