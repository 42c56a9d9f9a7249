"""Memory that queries carry from one to the next."""

from __future__ import annotations

from voxshell import _core


class QueryScratch:
    """What a query can keep for the next one: memory, and where the last search ended.

    Handed to query after query, it saves them from allocating, and lets a query for a pose near
    the last one begin where that one ended. Results never depend on it. It keeps the memory that
    the largest model asked about needs. Make one for each thread, and for each pair that moves
    steadily; threads that share one wait for each other.

    Example:
        >>> import numpy as np
        >>> import trimesh
        >>> import voxshell as vx
        >>> ball = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.1), voxel_size=0.01)
        >>> scratch = vx.QueryScratch()
        >>> world_from_ball = np.eye(4)
        >>> for world_from_ball[2, 3] in (0.1, 0.0999, 0.0998):
        ...     contacts = vx.contacts(ball, vx.Plane(), world_from_ball, scratch=scratch)
        >>> len(contacts)
        1
    """

    __slots__ = ("_core",)

    def __init__(self) -> None:
        self._core = _core.QueryScratch()
