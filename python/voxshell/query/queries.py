"""Questions about two bodies: where they touch, and whether."""

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
    """Finds where two bodies touch.

    One body is its point shell, the other its signed distance field. A point of the shell with a
    distance below ``margin`` is a contact: its depth is minus the distance, its direction the
    field's gradient there. All such points are found, exactly as a loop over every point would
    find them (:func:`voxshell.testing.contacts_flat`): same ids, same bits, same order.

    Args:
        a: A :class:`Model`, or an analytic shape such as :class:`Plane` or :class:`Capsule`.
        b: Likewise. At least one of the two must be a model.
        a_pose: ``world_from_a``, metres: (4, 4) float64, which is read fastest, or another form of a pose
            that :func:`pose` lists. None: the identity.
        b_pose: ``world_from_b``, likewise.
        shell: Whose points are tested. "auto": the body with which least can be missed, or both where
            neither is enough alone: a constant of the two bodies, which :func:`contact_bounds`
            tells. "a" or "b": that body, which must be a model. "both": first a's, then b's.
            "fewest": the one with fewer points, as the thesis has it, a if they have equally many;
            but where these are so far apart that the other would fit between them, or are all
            outside of it and enclose it, the other.
        margin: Metres. Above 0, points that near to the surface count as well, with negative
            depths; below 0, only points that deep.
        level: Level of the point-sphere tree, 1 to 12, by which contacts are told apart in
            :attr:`Contacts.segments` and :meth:`Contacts.deepest_per_segment`. None is level 1,
            which is one segment.
        max_points: Where there are more contacts, only so many: the deepest; of equally deep ones
            those that come first.
        budget: How many nodes of the tree to look at for each shell that is asked (a node is eight
            spheres or eight points, of about equal cost), 1 at least. Where that is too few, some
            contacts may be missing: see :attr:`Contacts.exact` and :attr:`Contacts.depth_bound`.
        scratch: Makes a series of queries faster; see :class:`QueryScratch`.

    Returns:
        The contacts in the world frame, ascending by id; of both shells, a's before b's. The
        normals are unit length, on body b, pointing towards body a, whichever of them is the
        shell. In single precision are the relative pose (worked out in double precision before),
        distances and normals; with points 1 m from their origin this is good to about 1e-7 m.

    Raises:
        PoseError: A pose is in no form that :func:`pose` lists, is not rigid, or is not finite.
        SettingsError: Neither body is a model, or the one that ``shell`` names is not; ``margin``
            is not finite; ``level``, ``max_points`` or ``budget`` is out of range.
        InputTypeError: ``a`` or ``b`` is not a body, or ``scratch`` no :class:`QueryScratch`.

    Example:
        A ball of radius 0.1 m whose centre is 0.099 m above the ground:

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
        >>> deepest.normals  # on the ground, towards the ball
        array([[0., 0., 1.]])

        Two models; what is within 1 mm counts, too:

        >>> contacts = vx.contacts(ball, ball, world_from_ball, np.eye(4), margin=0.001)
        >>> len(contacts)
        0

        The deepest of both balls' points; and what little work can find:

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
    """Finds a few contacts that stand for all: the deepest, then those that span the largest area.

    The same bits as ``contacts(...).manifold(max_points)``. Where one shell is asked, this is by
    branch and bound: the other contacts are not listed, so that it is faster where there are many.

    Args:
        a: A :class:`Model`, or an analytic shape such as :class:`Plane` or :class:`Capsule`.
        b: Likewise. At least one of the two must be a model.
        a_pose: ``world_from_a``, (4, 4) or as :func:`pose` lists. None: the identity.
        b_pose: ``world_from_b``, likewise.
        shell: As for :func:`contacts`.
        margin: As for :func:`contacts`.
        max_points: From 1 to 4. Points that would add no area are left out.
        scratch: Makes a series of queries faster; see :class:`QueryScratch`.

    Returns:
        The contacts chosen, in the order chosen; the deepest is first.

    Raises:
        PoseError: A pose is in no form that :func:`pose` lists, is not rigid, or is not finite.
        SettingsError: Neither body is a model, or the one that ``shell`` names is not; ``margin``
            is not finite; ``max_points`` is out of range.
        InputTypeError: ``a`` or ``b`` is not a body, or ``scratch`` no :class:`QueryScratch`.

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
    """Finds the deepest contact of each segment of a level.

    The same bits as ``contacts(..., level=level).deepest_per_segment()``, but by branch and bound,
    as :func:`manifold`.

    Args:
        a: A :class:`Model`, or an analytic shape such as :class:`Plane` or :class:`Capsule`.
        b: Likewise. At least one of the two must be a model.
        a_pose: ``world_from_a``, (4, 4) or as :func:`pose` lists. None: the identity.
        b_pose: ``world_from_b``, likewise.
        level: Level of the point-sphere tree, 1 to 12; a level L has 4^(L - 1) segments at most.
        shell: As for :func:`contacts`.
        margin: As for :func:`contacts`.
        scratch: Makes a series of queries faster; see :class:`QueryScratch`.

    Returns:
        One contact a segment that has any, ascending by id; of both shells, a's before b's. Of
        equally deep ones, the smaller id.

    Raises:
        PoseError: A pose is in no form that :func:`pose` lists, is not rigid, or is not finite.
        SettingsError: Neither body is a model, or the one that ``shell`` names is not; ``margin``
            is not finite; ``level`` is out of range.
        InputTypeError: ``a`` or ``b`` is not a body, or ``scratch`` no :class:`QueryScratch`.

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
    """Tells whether two bodies touch: whether :func:`contacts` would find any; stops at the first.

    Args:
        a: A :class:`Model`, or an analytic shape such as :class:`Plane` or :class:`Capsule`.
        b: Likewise. At least one of the two must be a model.
        a_pose: ``world_from_a``, (4, 4) or as :func:`pose` lists. None: the identity.
        b_pose: ``world_from_b``, likewise.
        shell: As for :func:`contacts`.
        margin: Metres; above 0, bodies that near touch as well.

    Returns:
        True if a point of the shell has a distance below ``margin``.

    Raises:
        PoseError: A pose is in no form that :func:`pose` lists, is not rigid, or is not finite.
        SettingsError: Neither body is a model, or the one that ``shell`` names is not; ``margin``
            is not finite.
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
    # Unpacked into names, not starred: a list less to be made of the arguments, in what may take a microsecond.
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
    """Checks the arguments of :func:`contacts` and asks one of the core's searches."""
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
