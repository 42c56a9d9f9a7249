"""Contact queries of two bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING

from voxshell import _core
from voxshell.base.arguments import as_integer
from voxshell.base.pose_forms import as_pose, mend_poses
from voxshell.errors import PoseError
from voxshell.query.contact_set import Contacts
from voxshell.query.pairs import (
    Collidable,
    Shell,
    as_budget,
    as_level,
    as_margin,
    as_max_points,
    as_pair,
    as_scratch,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from voxshell.query.scratch import QueryScratch


def contacts(
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
    """Find the contacts of two bodies.

    One body is a point shell, the other a signed distance field. A point of the shell with a
    distance below ``margin`` is a contact: its depth is minus the distance, its normal is the
    gradient of the field. The query finds exactly the contacts that a loop over every point would
    find (:func:`voxshell.testing.contacts_flat`), with the same ids, bits and order.

    Args:
        a: A :class:`Model`, or an analytic shape such as :class:`Plane` or :class:`Capsule`.
        b: Likewise. At least one of the two must be a model.
        a_pose: ``world_from_a``, meters, in any form that :func:`pose` lists; (4, 4) float64 is the
            fastest. None: the identity.
        b_pose: ``world_from_b``, likewise.
        shell: The body whose points are tested. "auto": the body whose shell misses less, or both
            if neither is sufficient alone. This choice is a constant of the two bodies; see
            :func:`contact_bounds`. "a" or "b": that body, which must be a model. "both": first a's
            points, then b's. "fewest": the body with fewer points, as in the thesis, or a if they
            have equally many. The exception: if these points are so far apart that the other body
            fits between them, or if all of them are outside the other body and enclose it, the
            points of the other body are tested.
        margin: Meters. Above 0, points within this distance of the surface are contacts, too, with
            negative depths. Below 0, only points of at least this depth are contacts.
        level: Level of the point-sphere tree, 1 to 12, that defines :attr:`Contacts.segments` and
            :meth:`Contacts.deepest_per_segment`. None is level 1: segment 0 has all points, and 1
            all edge segments.
        max_points: Largest number of contacts. If there are more, the deepest are returned; among
            equally deep ones, those that come first.
        budget: Largest number of tree nodes to visit for each shell, at least 1. A node is eight
            spheres or eight points, at about equal cost. If the budget is too small, contacts may
            be missing: see :attr:`Contacts.exact` and :attr:`Contacts.depth_bound`.
        scratch: Speeds up a series of queries; see :class:`QueryScratch`.

    Returns:
        The contacts in the world frame, in ascending order of ids; for both shells, a's before b's.
        Normals have unit length and point from body b toward body a, whichever body contributes the
        shell. The relative pose is computed in double precision and then rounded to single
        precision, like distances and normals. For points 1 m from their origin, the error is about
        1e-7 m.

    Raises:
        PoseError: A pose is in no form that :func:`pose` lists, is not rigid, or is not finite.
        SettingsError: Neither body is a model, or ``shell`` names one that is not; ``margin`` is
            not finite; ``level``, ``max_points`` or ``budget`` is out of range.
        InputTypeError: ``a`` or ``b`` is not a body, or ``scratch`` is not a :class:`QueryScratch`.

    Example:
        A ball of radius 0.1 m whose center is 0.099 m above the ground:

        >>> import numpy as np
        >>> import trimesh
        >>> import voxshell as vx
        >>> ball = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.1), voxel_size=0.01)
        >>> world_from_ball = np.eye(4)
        >>> world_from_ball[:3, 3] = (0.5, 0.6, 0.099)
        >>> contacts = vx.contacts(ball, vx.Plane(), a_pose=world_from_ball)
        >>> contacts
        Contacts(5 of a's points, deepest 0.001 m)
        >>> deepest = contacts.manifold(1)
        >>> deepest.points_a.round(6)  # the ball's lowest point
        array([[ 0.5  ,  0.6  , -0.001]])
        >>> deepest.points_b.round(6) + 0.0  # on the ground above it
        array([[0.5, 0.6, 0. ]])
        >>> deepest.normals  # on the ground, toward the ball
        array([[0., 0., 1.]])

        Two models, with a margin of 1 mm:

        >>> contacts = vx.contacts(ball, ball, world_from_ball, np.eye(4), margin=0.001)
        >>> len(contacts)
        0

        The 20 deepest of both balls' points, and the contacts that a small budget finds:

        >>> world_from_ball[:3, 3] = (0, 0, 0.19)
        >>> both = vx.contacts(ball, ball, world_from_ball, shell="both", max_points=20)
        >>> len(both), sorted(set(both.shells.tolist()))
        (20, ['a', 'b'])
        >>> few = vx.contacts(ball, ball, world_from_ball, budget=1)
        >>> few.exact, few.depth_bound > 0.009
        (False, True)
    """
    return find(
        _core.contacts, a, b, a_pose, b_pose, shell, margin, level, max_points, budget, scratch
    )


def manifold(
    a: Collidable,
    b: Collidable,
    a_pose: ArrayLike | None = None,
    b_pose: ArrayLike | None = None,
    *,
    shell: Shell = "auto",
    margin: float = 0.0,
    max_points: int = 4,
    scratch: QueryScratch | None = None,
) -> Contacts:
    """Find up to four representative contacts: the deepest, then those that span most area.

    The result has the same bits as ``contacts(...).manifold(max_points)``. For a single shell, this
    function uses branch and bound, which does not list the other contacts. It is faster if there
    are many.

    Args:
        a: A :class:`Model`, or an analytic shape such as :class:`Plane` or :class:`Capsule`.
        b: Likewise. At least one of the two must be a model.
        a_pose: ``world_from_a`` in any form that :func:`pose` lists. None: the identity.
        b_pose: ``world_from_b``, likewise.
        shell: As for :func:`contacts`.
        margin: As for :func:`contacts`.
        max_points: From 1 to 4. Contacts that would add no area are left out.
        scratch: Speeds up a series of queries; see :class:`QueryScratch`.

    Returns:
        The chosen contacts in the order of choice; the deepest is first.

    Raises:
        PoseError: A pose is in no form that :func:`pose` lists, is not rigid, or is not finite.
        SettingsError: Neither body is a model, or ``shell`` names one that is not; ``margin`` is
            not finite; ``max_points`` is out of range.
        InputTypeError: ``a`` or ``b`` is not a body, or ``scratch`` is not a :class:`QueryScratch`.

    Example:
        >>> import trimesh
        >>> import voxshell as vx
        >>> box = vx.Model.from_mesh(trimesh.creation.box(), resolution=20)
        >>> corners = vx.manifold(box, vx.Plane(offset=-0.499))
        >>> len(corners), corners.depths.round(6)
        (4, array([0.001, 0.001, 0.001, 0.001]))
    """
    bodies, shells = as_pair(a, b, shell)
    try:
        found = _core.manifold(
            *bodies,
            as_pose(a_pose, "a_pose"),
            as_pose(b_pose, "b_pose"),
            shells,
            as_margin(margin),
            as_integer(max_points, "max_points", 1, 4),
            as_scratch(scratch),
        )
    except PoseError as error:
        mended = mend_poses(error, a_pose=a_pose, b_pose=b_pose)
        return manifold(
            a, b, **mended, shell=shell, margin=margin, max_points=max_points, scratch=scratch
        )
    return Contacts(found)


def deepest_per_segment(
    a: Collidable,
    b: Collidable,
    a_pose: ArrayLike | None = None,
    b_pose: ArrayLike | None = None,
    *,
    level: int,
    shell: Shell = "auto",
    margin: float = 0.0,
    scratch: QueryScratch | None = None,
) -> Contacts:
    """Find the deepest contact of each segment on a level.

    The result has the same bits as ``contacts(..., level=level).deepest_per_segment()``, but this
    function uses branch and bound, like :func:`manifold`.

    Args:
        a: A :class:`Model`, or an analytic shape such as :class:`Plane` or :class:`Capsule`.
        b: Likewise. At least one of the two must be a model.
        a_pose: ``world_from_a`` in any form that :func:`pose` lists. None: the identity.
        b_pose: ``world_from_b``, likewise.
        level: Level of the point-sphere tree, 1 to 12; level L has at most 4^(L - 1) segments.
        shell: As for :func:`contacts`.
        margin: As for :func:`contacts`.
        scratch: Speeds up a series of queries; see :class:`QueryScratch`.

    Returns:
        One contact for each segment that has any, in ascending order of ids. For both shells, a's
        segments come before b's. Of equally deep contacts, the one with the smaller id is returned.

    Raises:
        PoseError: A pose is in no form that :func:`pose` lists, is not rigid, or is not finite.
        SettingsError: Neither body is a model, or ``shell`` names one that is not; ``margin`` is
            not finite; ``level`` is out of range.
        InputTypeError: ``a`` or ``b`` is not a body, or ``scratch`` is not a :class:`QueryScratch`.

    Example:
        >>> import trimesh
        >>> import voxshell as vx
        >>> box = vx.Model.from_mesh(trimesh.creation.box(), resolution=20)
        >>> few = vx.deepest_per_segment(box, vx.Plane(offset=-0.499), level=3)
        >>> len(few) == len(set(few.segments.tolist())) > 1
        True
    """
    bodies, shells = as_pair(a, b, shell)
    try:
        found = _core.deepest_per_segment(
            *bodies,
            as_pose(a_pose, "a_pose"),
            as_pose(b_pose, "b_pose"),
            shells,
            as_margin(margin),
            as_integer(level, "level", 1, _core.PointSphereTree.deepest_level),
            as_scratch(scratch),
        )
    except PoseError as error:
        mended = mend_poses(error, a_pose=a_pose, b_pose=b_pose)
        return deepest_per_segment(
            a, b, **mended, level=level, shell=shell, margin=margin, scratch=scratch
        )
    return Contacts(found)


def collide(
    a: Collidable,
    b: Collidable,
    a_pose: ArrayLike | None = None,
    b_pose: ArrayLike | None = None,
    *,
    shell: Shell = "auto",
    margin: float = 0.0,
) -> bool:
    """Return whether two bodies touch, that is, whether :func:`contacts` finds any contact.

    The query stops at the first contact.

    Args:
        a: A :class:`Model`, or an analytic shape such as :class:`Plane` or :class:`Capsule`.
        b: Likewise. At least one of the two must be a model.
        a_pose: ``world_from_a`` in any form that :func:`pose` lists. None: the identity.
        b_pose: ``world_from_b``, likewise.
        shell: As for :func:`contacts`.
        margin: Bodies that are nearer than this count as touching, meters.

    Returns:
        True if a point of the shell has a distance below ``margin``.

    Raises:
        PoseError: A pose is in no form that :func:`pose` lists, is not rigid, or is not finite.
        SettingsError: Neither body is a model, or ``shell`` names one that is not; ``margin`` is
            not finite.
        InputTypeError: ``a`` or ``b`` is not a body.

    Example:
        >>> import numpy as np
        >>> import trimesh
        >>> import voxshell as vx
        >>> torus = trimesh.creation.torus(major_radius=0.2, minor_radius=0.05)
        >>> ring = vx.Model.from_mesh(torus, resolution=50)
        >>> vx.collide(ring, vx.Sphere(radius=0.1))  # in the hole
        False
        >>> world_from_ring = np.eye(4)
        >>> world_from_ring[0, 3] = 0.1
        >>> vx.collide(ring, vx.Sphere(radius=0.1), a_pose=world_from_ring)
        True
    """
    # Unpacking avoids a list of the arguments: this query may take only a microsecond.
    (field_a, model_a, field_b, model_b), shells = as_pair(a, b, shell)
    try:
        return _core.collide(
            field_a,
            model_a,
            field_b,
            model_b,
            as_pose(a_pose, "a_pose"),
            as_pose(b_pose, "b_pose"),
            shells,
            as_margin(margin),
        )
    except PoseError as error:
        mended = mend_poses(error, a_pose=a_pose, b_pose=b_pose)
        return collide(a, b, **mended, shell=shell, margin=margin)


def find(
    search: Callable[..., _core.ContactSet],
    a: Collidable,
    b: Collidable,
    a_pose: ArrayLike | None,
    b_pose: ArrayLike | None,
    shell: Shell,
    margin: float,
    level: int | None,
    max_points: int | None,
    budget: int | None,
    scratch: QueryScratch | None,
) -> Contacts:
    """Check the arguments of :func:`contacts` and call one of the core's searches."""
    bodies, shells = as_pair(a, b, shell)
    try:
        found = search(
            *bodies,
            as_pose(a_pose, "a_pose"),
            as_pose(b_pose, "b_pose"),
            shells,
            as_margin(margin),
            as_level(level),
            as_max_points(max_points),
            as_budget(budget),
            as_scratch(scratch),
        )
    except PoseError as error:
        a_pose, b_pose = mend_poses(error, a_pose=a_pose, b_pose=b_pose).values()
        return find(search, a, b, a_pose, b_pose, shell, margin, level, max_points, budget, scratch)
    return Contacts(found)
