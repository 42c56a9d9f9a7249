"""Bodies of one tree that overlap at the start."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable

    from voxshell.simulation.body import Body
    from voxshell.simulation.world import World

_FRACTION = 0.02
"""Largest accepted overlap, as a fraction of the smaller body's longest side. Deeper overlaps are
intended, or do not matter with MuJoCo's soft contacts. Bullet would push the bodies apart, and
stiff joints would make them jump."""


def keep_overlaps_apart(world: World, pairs: Iterable[tuple[Body, Body]]) -> list[str]:
    """Turn off collisions between bodies that overlap.

    Args:
        world: The world of the bodies.
        pairs: Bodies that may collide.

    Returns:
        A phrase for each pair that overlaps.
    """
    bounds: dict[int, np.ndarray] = {}
    found = []
    for a, b in pairs:
        for body in (a, b):
            if body.number not in bounds:
                bounds[body.number] = body.bounds
        (low_a, high_a), (low_b, high_b) = bounds[a.number], bounds[b.number]
        most = _FRACTION * min((high_a - low_a).max(), (high_b - low_b).max())
        if not (np.minimum(high_a, high_b) - np.maximum(low_a, low_b) > most).all():
            continue
        if world.query_contacts(a, b)["depth"].max(initial=0.0) > most:
            world.set_collision(a, b, False)
            found.append(" and ".join(body.name.rpartition("/")[2] for body in (a, b)))
    return found
