"""A body that consists of several shapes."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from voxshell.base.arguments import is_iterable
from voxshell.base.calls import explain_calls
from voxshell.base.pose_forms import as_rigid_pose
from voxshell.errors import InputTypeError, SettingsError
from voxshell.model.model import Model
from voxshell.model.shapes import Box, Capsule, Cone, Cylinder, Sphere
from voxshell.simulation.comparison_shapes import ConvexDecomposition, GImpact

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike, NDArray

Part: TypeAlias = Model | Box | Sphere | Capsule | Cylinder | Cone | GImpact | ConvexDecomposition
"""The shapes that a compound can contain."""

PARTS = (Model, Box, Sphere, Capsule, Cylinder, Cone, GImpact, ConvexDecomposition)


@explain_calls
class Compound:
    """Several shapes with fixed relative poses that form one body of a :class:`World`.

    All parts have the same density. Where parts overlap, their mass counts twice.

    Args:
        parts: Pairs of a shape and its pose ``compound_from_part``, in any form that :func:`pose`
            lists; at least one. A plane or another compound cannot be a part.

    Raises:
        InputTypeError: ``parts`` is no sequence. Or a part is not a pair, or has an unsupported shape.
        PoseError: A pose is in no form that :func:`pose` lists, is not rigid, or is not finite.
        SettingsError: There is no part.

    Example:
        >>> import voxshell as vx
        >>> vx.Compound([(vx.Sphere(0.2), (0, 0, 0)), (vx.Sphere(0.2), (1, 0, 0))])
        Compound(Sphere(radius=0.2), Sphere(radius=0.2))
    """

    __slots__ = ("parts",)

    def __init__(self, parts: Iterable[tuple[Part, ArrayLike]]) -> None:
        if not is_iterable(parts):
            raise InputTypeError(
                f"parts must be pairs of a shape and a pose, not {type(parts).__name__}"
            )
        self.parts: list[tuple[Part, NDArray[np.float64]]] = []
        for index, part in enumerate(parts):
            if not (isinstance(part, (tuple, list)) and len(part) == 2):
                raise InputTypeError(f"parts[{index}] must be a pair of a shape and a pose")
            shape, pose = part
            if not isinstance(shape, PARTS):
                raise InputTypeError(
                    f"parts[{index}] must be one of {', '.join(kind.__name__ for kind in PARTS)}, "
                    f"not {type(shape).__name__}"
                )
            matrix = as_rigid_pose(pose, f"the pose of parts[{index}]")
            self.parts.append((shape, matrix.copy()))
        if not self.parts:
            raise SettingsError(
                "parts must contain at least one part, a pair of a shape and its pose"
            )

    def __repr__(self) -> str:
        return f"Compound({', '.join(repr(shape) for shape, _ in self.parts)})"
