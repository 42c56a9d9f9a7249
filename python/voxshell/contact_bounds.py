"""What contacts and a yes or no are worth, in terms of the meshes themselves."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal, NamedTuple

from voxshell import _core
from voxshell._pairs import as_shells, parts_of_pair
from voxshell.contact_set import ROLES
from voxshell.field import DistanceField
from voxshell.model import Model

if TYPE_CHECKING:
    from voxshell._pairs import Collidable, Shell


class ContactBounds(NamedTuple):
    """How the contacts of two bodies relate to the surfaces that they sample; metres.

    Attributes:
        overlap: Where the surface of the body whose points are tested reaches deeper than this into
            the other, there is a contact: proved. Of both bodies it is enough that one does.
        clearance: Where the surfaces are farther apart than this, and neither body is inside the
            other, there is none: proved.
        shell: Whose points "auto" tests: "a", "b" or "both".
        miss: How deep one body may be in the other where a query finds nothing, spikes and edges
            between the points included: measured when the models were built, not proved.
    """

    overlap: float
    clearance: float
    shell: Literal["a", "b", "both"]
    miss: float


def contact_bounds(a: Collidable, b: Collidable, *, shell: Shell = "auto") -> ContactBounds:
    """States what contacts of two bodies say about their meshes, and who is their shell.

    Points lie on the surface, so between them a spike or an edge may enter the other body unseen:
    no place of the surface is farther than sqrt(3) spacings from a point. And a field on a grid is
    off the true distance by at most :attr:`DistanceField.interpolation_error`. That is the worst
    case, and a proof; how much the two models at hand can miss is measured, and decides who is the
    shell.

    Args:
        a: A :class:`Model`, or an analytic shape.
        b: Likewise. At least one of the two must be a model.
        shell: As for :func:`contacts`.

    Returns:
        The bounds, at no margin, the same for ``contact_bounds(b, a)`` with "a" and "b" exchanged.
        They hold in exact arithmetic; single precision adds about 1e-7 of the bodies' coordinates.

    Raises:
        InputTypeError: ``a`` or ``b`` is not a body.
        SettingsError: Neither body is a model, or the one that ``shell`` names is not.

    Example:
        >>> import trimesh
        >>> import voxshell as vx
        >>> model = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.1), voxel_size=0.01)
        >>> bounds = vx.contact_bounds(model, vx.Plane())
        >>> bounds.shell, round(bounds.overlap, 4), bounds.clearance
        ('a', 0.0173, 0.0)
        >>> vx.contact_bounds(vx.Plane(), model).shell
        'b'
    """
    _, model_a, _, model_b = bodies = parts_of_pair(a, b, shell)
    role, miss, *_ = _core.role(*bodies, as_shells(shell))
    name = ROLES[role]
    sides = {"a": (model_a, b), "b": (model_b, a)}
    overlaps = []
    errors = []
    for side in ("a", "b") if name == "both" else (name,):
        of_shell, other = sides[side]
        assert of_shell is not None
        distances = other.field if isinstance(other, Model) else other
        error = distances.interpolation_error if isinstance(distances, DistanceField) else 0.0
        overlaps.append(math.sqrt(3.0) * of_shell.shell.spacing + error)
        errors.append(error)
    return ContactBounds(min(overlaps), max(errors), name, miss)
