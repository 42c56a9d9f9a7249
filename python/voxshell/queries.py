"""Questions about two bodies: where do they touch, do they touch at all."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np

from voxshell import _core
from voxshell._arguments import as_integer, as_pose, as_real
from voxshell.contact_set import Contacts
from voxshell.errors import InputTypeError, SettingsError
from voxshell.field import Field
from voxshell.model import Model

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

Collidable: TypeAlias = Model | Field
"""What queries take: a model, or a field without a shell such as a plane, box or sphere."""

Shell: TypeAlias = Literal["auto", "a", "b"]
"""Whose points are tested against the other's field."""

_CHOICES = {
    "auto": _core.ShellChoice.AUTOMATIC,
    "a": _core.ShellChoice.A,
    "b": _core.ShellChoice.B,
}


def contacts(
    a: Collidable,
    b: Collidable,
    a_pose: ArrayLike | None = None,
    b_pose: ArrayLike | None = None,
    *,
    shell: Shell = "auto",
    margin: float = 0.0,
    level: int | None = None,
) -> Contacts:
    """Finds where two bodies touch.

    One body is its point shell, the other its signed distance field. A point of the shell with a
    distance below ``margin`` is a contact: its depth is minus the distance, its direction the
    field's gradient there. All such points are found, exactly as a loop over every point would
    find them (:func:`voxshell.testing.contacts_flat`): same ids, same bits, same order.

    Args:
        a: A :class:`Model`, or an analytic shape such as :class:`Plane` or :class:`Capsule`.
        b: Likewise. At least one of the two must be a model.
        a_pose: (4, 4) float64, ``world_from_a``: rotation orthonormal to 1e-6, translation in
            metres. None: the identity.
        b_pose: (4, 4) float64, ``world_from_b``. None: the identity.
        shell: "a" or "b": the body whose points are tested, which must be a model. "auto": the one
            with fewer points, a if they have equally many.
        margin: Metres. Above 0, points that near to the surface count as well, with negative
            depths; below 0, only points that deep.
        level: Level of the point-sphere tree, 1 to 12, by which contacts are told apart in
            :attr:`Contacts.segments` and :meth:`Contacts.deepest_per_segment`. None is level 1,
            which is one segment.

    Returns:
        The contacts in the world frame, ascending by id. The normals are unit length, on body b,
        pointing towards body a, whichever of them is the shell. In single precision are the
        relative pose (worked out in double precision before), distances and normals; with points
        1 m from their origin this is good to about 1e-7 m.

    Raises:
        PoseError: A pose is not a 4x4 rigid transform of finite numbers.
        SettingsError: Neither body is a model, or the one that ``shell`` names is not; ``margin``
            is not finite; ``level`` is out of range.
        InputTypeError: ``a`` or ``b`` is not a body.

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
    """
    return find(_core.contacts, a, b, a_pose, b_pose, shell, margin, level)


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
        a_pose: (4, 4) float64, ``world_from_a``. None: the identity.
        b_pose: (4, 4) float64, ``world_from_b``. None: the identity.
        shell: "a", "b" or "auto", as for :func:`contacts`.
        margin: Metres; above 0, bodies that near touch as well.

    Returns:
        True if a point of the shell has a distance below ``margin``.

    Raises:
        PoseError: A pose is not a 4x4 rigid transform of finite numbers.
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
    return _core.collide(
        *_parts(a, "a"),
        *_parts(b, "b"),
        as_pose(a_pose, "a_pose"),
        as_pose(b_pose, "b_pose"),
        _as_choice(shell),
        _as_margin(margin),
    )


def find(
    search: Callable[..., _core.ContactSet],
    a: Collidable,
    b: Collidable,
    a_pose: ArrayLike | None,
    b_pose: ArrayLike | None,
    shell: Shell,
    margin: float,
    level: int | None,
) -> Contacts:
    """Checks the arguments of :func:`contacts` and asks one of the core's searches."""
    deepest = _core.PointSphereTree.deepest_level
    return Contacts(
        search(
            *_parts(a, "a"),
            *_parts(b, "b"),
            as_pose(a_pose, "a_pose"),
            as_pose(b_pose, "b_pose"),
            _as_choice(shell),
            _as_margin(margin),
            1 if level is None else as_integer(level, "level", 1, deepest),
        )
    )


def _parts(body: Collidable, name: str) -> tuple[_core.Field, _core.PointShell | None]:
    """The field and the shell that the core wants of a body."""
    if isinstance(body, Model):
        return body.field._core, body.shell._core
    if isinstance(body, Field):
        return body._core, None
    raise InputTypeError(f"{name} must be a Model, Plane, Box or Sphere, not {type(body).__name__}")


def _as_choice(shell: Shell) -> _core.ShellChoice:
    try:
        return _CHOICES[shell]
    except (KeyError, TypeError):
        raise SettingsError(f"shell must be 'auto', 'a' or 'b', not {shell!r}") from None


def _as_margin(value: float) -> float:
    margin = as_real(value, "margin")
    if abs(margin) > float(np.finfo(np.float32).max):
        raise SettingsError(f"margin must fit single precision, not {margin:g} m")
    return margin
