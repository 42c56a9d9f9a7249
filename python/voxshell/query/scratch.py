"""Memory that one query leaves for the next."""

from __future__ import annotations

from typing import NoReturn

from voxshell import _core
from voxshell.errors import InputTypeError


class QueryScratch:
    """Memory and search state that one query leaves for the next.

    With a scratch, queries do not allocate memory, and a query in a pose near the last one starts
    where that one ended. Results never depend on the scratch. It keeps as much memory as its
    largest model so far needed. Make a scratch for each thread, and for each pair that moves
    steadily. Threads that share a scratch wait for each other.

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

    def __reduce__(self) -> NoReturn:
        raise InputTypeError("a QueryScratch cannot be pickled or copied: make another one")
