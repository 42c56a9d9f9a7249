"""What a yes or no is worth, in terms of the meshes themselves."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from voxshell.errors import InputTypeError
from voxshell.field import DistanceField, Field
from voxshell.model import Model

if TYPE_CHECKING:
    from voxshell.queries import Collidable


class ContactBounds(NamedTuple):
    """How the contacts of a shell in a field relate to the surfaces that they sample.

    Attributes:
        overlap: Where the shell's surface reaches deeper than this into the other body, metres,
            there is a contact.
        clearance: Where the surfaces are farther apart than this, metres, and neither body is
            inside the other, there is none.
    """

    overlap: float
    clearance: float


def contact_bounds(shell: Model, field: Collidable) -> ContactBounds:
    """States what contacts of one body's points in another's field say about their meshes.

    Points lie on the surface, so between them a spike or an edge may enter the other body unseen:
    no place of the surface is farther than sqrt(3) spacings from a point. And a field on a grid is
    off the true distance by at most :attr:`DistanceField.interpolation_error`.

    Args:
        shell: The body whose points are tested.
        field: The other body.

    Returns:
        The bounds, at no margin. They hold in exact arithmetic; single precision adds about 1e-7
        of the bodies' coordinates.

    Raises:
        InputTypeError: ``shell`` is not a model, or ``field`` is no body.

    Example:
        >>> import trimesh
        >>> import voxshell as vx
        >>> model = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.1), voxel_size=0.01)
        >>> bounds = vx.contact_bounds(model, model)
        >>> round(bounds.overlap, 4), round(bounds.clearance, 4)
        (0.026, 0.0087)
        >>> vx.contact_bounds(model, vx.Plane()).clearance
        0.0
    """
    if not isinstance(shell, Model):
        raise InputTypeError(f"shell must be a Model, not {type(shell).__name__}")
    distances = field.field if isinstance(field, Model) else field
    if not isinstance(distances, Field):
        raise InputTypeError(
            f"field must be a Model or an analytic field, not {type(field).__name__}"
        )
    error = distances.interpolation_error if isinstance(distances, DistanceField) else 0.0
    return ContactBounds(math.sqrt(3.0) * shell.shell.spacing + error, error)
