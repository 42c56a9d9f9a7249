"""What contacts and a yes or no are worth, in terms of the meshes themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

from voxshell import _core
from voxshell.query.contact_set import ROLES
from voxshell.query.pairs import as_shells, parts_of_pair

if TYPE_CHECKING:
    from voxshell.query.pairs import Collidable, Shell


class ContactBounds(NamedTuple):
    """How the contacts of two bodies relate to their meshes; metres.

    Attributes:
        overlap: Where one body is deeper in the other than this, there is a contact. Of uniform models
            depth is that of the surface of the body whose points are tested.
        clearance: Where the surfaces are farther apart than this, and neither body is inside the
            other, there is none: proved.
        shell: Whose points "auto" tests: "a", "b" or "both".
        miss: As ``overlap``, but wholly as it was measured when the models were built.
    """

    overlap: float
    clearance: float
    shell: Literal["a", "b", "both"]
    miss: float


def contact_bounds(a: Collidable, b: Collidable, *, shell: Shell = "auto") -> ContactBounds:
    """States what contacts of two bodies say about their meshes, and who is their shell.

    What the fields add is proved: :attr:`DistanceField.surface_error`. Of uniform models it is also
    proved that no place of the surface is farther than sqrt(3) spacings from a point of the shell. How
    far the surface of a model by tolerance stands out above its points and edges was measured at
    100,000 places when it was built (:attr:`Accuracy.coverage`).

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
    bodies = parts_of_pair(a, b, shell)
    role, miss, *_ = _core.role(*bodies, as_shells(shell))
    name = ROLES[role]
    overlap, clearance = _core.pair_bounds(*bodies, role)
    return ContactBounds(overlap, clearance, name, miss)
