"""What there is to say of a model, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from voxshell.experiments.units import format_length, format_size

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.model import Model


def describe_facts(model: Model) -> list[tuple[str, str]]:
    """Names and values, one a line."""
    field, shell = model.field, model.shell
    vertices, faces = model.mesh
    return [
        ("mesh", f"{len(faces):,} triangles, {len(vertices):,} vertices"),
        ("extents", format_extents(model.bounds)),
        ("inside", describe_sign(model)),
        ("field", f"{' x '.join(map(str, field.shape))} nodes, {format_size(field.nbytes)}"),
        ("voxel size", format_length(field.voxel_size)),
        ("field error", f"at most {format_length(field.interpolation_error)} near the surface"),
        ("shell", f"{len(shell):,} points, {shell.tree.levels} levels of clusters"),
        ("point spacing", format_length(shell.spacing)),
    ]


def format_extents(bounds: NDArray[np.float64]) -> str:
    """Edges of the box around a body, metres."""
    return f"{' x '.join(f'{x:.4g}' for x in np.ptp(bounds, axis=0))} m"


def describe_sign(model: Model) -> str:
    """How it was told what is inside."""
    if model.field.sign_method == "closed":
        return "told by the surface, which is closed"
    return f"told by winding numbers, with a confidence of {model.field.sign_confidence:.3f}"
