"""Bounds that relate contacts of models to the meshes themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

from voxshell import _core
from voxshell.base.calls import explain_calls
from voxshell.query.contact_set import ROLES
from voxshell.query.pairs import as_shells, parts_of_pair

if TYPE_CHECKING:
    from voxshell.query.pairs import Collidable, Shell


class ContactBounds(NamedTuple):
    """How the contacts of two bodies relate to their meshes; meters.

    Attributes:
        overlap: If one body is deeper in the other than this, there is a contact. For uniform
            models, this is the depth of the surface of the body whose points are tested.
        clearance: If the surfaces are farther apart than this, and neither body is inside the
            other, there is no contact. This is proven.
        shell: The body whose points "auto" tests: "a", "b" or "both".
        miss: Like ``overlap``, but all of its parts were measured when the models were built.
    """

    overlap: float
    clearance: float
    shell: Literal["a", "b", "both"]
    miss: float


@explain_calls
def contact_bounds(a: Collidable, b: Collidable, *, shell: Shell = "auto") -> ContactBounds:
    """Return bounds that relate the contacts of two bodies to their meshes.

    The errors of fields are proven: :attr:`DistanceField.surface_error`. For uniform models it is
    also proven that every place of the surface is within sqrt(3) spacings of a point of the shell.
    For models by tolerance, the rise of the surface above points and edges was measured at 100,000
    places when the model was built (:attr:`Accuracy.coverage`).

    Args:
        a: A :class:`Model`, or an analytic shape.
        b: Likewise. At least one of the two must be a model.
        shell: As for :func:`contacts`.

    Returns:
        The bounds for a margin of 0. ``contact_bounds(b, a)`` returns the same with "a" and "b"
        exchanged. They hold in exact arithmetic; single precision adds about 1e-7 of the bodies'
        coordinates.

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
    shells = as_shells(shell)
    bodies = parts_of_pair(a, b, shell)
    role, miss, *_ = _core.role(*bodies, shells)
    name = ROLES[role]
    overlap, clearance = _core.pair_bounds(*bodies, role)
    return ContactBounds(overlap, clearance, name, miss)
