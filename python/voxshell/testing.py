"""Reference implementations for tests of voxshell and of programs that use it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from voxshell import _core
from voxshell.query import queries

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from voxshell.query.contact_set import Contacts
    from voxshell.query.pairs import Collidable, Shell
    from voxshell.query.scratch import QueryScratch


def contacts_flat(
    a: Collidable,
    b: Collidable,
    a_pose: ArrayLike | None = None,
    b_pose: ArrayLike | None = None,
    *,
    shell: Shell = "auto",
    margin: float = 0.0,
    level: int | None = None,
    max_points: int | None = None,
    budget: int | None = None,
    scratch: QueryScratch | None = None,
) -> Contacts:
    """Find contacts by evaluating every point of the shell in order, without the tree.

    This is the oracle of :func:`voxshell.contacts`, which returns the same bits faster. Arguments,
    results and errors are the same, except that this function always finds all contacts, whatever
    the ``budget``, and ignores ``scratch``.

    Example:
        >>> import numpy as np
        >>> import trimesh
        >>> import voxshell as vx
        >>> ball = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.1), voxel_size=0.01)
        >>> plane = vx.Plane(offset=-0.09)
        >>> found, oracle = vx.contacts(ball, plane), vx.testing.contacts_flat(ball, plane)
        >>> np.array_equal(found.ids, oracle.ids) and np.array_equal(found.depths, oracle.depths)
        True
    """
    return queries.find(
        _core.contacts_flat, a, b, a_pose, b_pose, shell, margin, level, max_points, budget, scratch
    )
