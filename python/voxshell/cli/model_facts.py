"""Properties of a model in words."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.measuring.units import format_length, format_size

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.model.accuracy import ErrorStatistic
    from voxshell.model.model import Model

MEASURED_FIELD = "field error"
"""Measured errors of the field's distance on the surface."""

MEASURED_SHELL = "shell coverage"
"""Measured heights of the surface above the shell: the depth that it can miss."""

THINNEST = "thinnest wall"
"""Thickness of the thinnest walls."""

PROVED = "proven bounds"
"""Proven bounds, which hold everywhere and are usually much larger than measured errors."""


def describe_facts(model: Model) -> list[tuple[str, str]]:
    """Return names and values, one per line."""
    field, shell = model.field, model.shell
    vertices, faces = model.mesh
    return [
        ("mesh", f"{len(faces):,} triangles, {len(vertices):,} vertices"),
        ("extents", format_extents(model.bounds)),
        ("inside", describe_sign(model)),
        ("tolerance", _describe_tolerance(model)),
        ("field", f"{' x '.join(map(str, field.shape))} nodes, {format_size(field.nbytes)}"),
        ("voxel size", format_length(field.voxel_size)),
        ("shell", f"{len(shell):,} points, {shell.tree.levels} levels of clusters"),
        ("point spacing", format_length(shell.spacing)),
        (THINNEST, format_length(model.thickness)),
        *describe_accuracy(model),
    ]


def describe_accuracy(model: Model) -> list[tuple[str, str]]:
    """Return measured errors on the model's surface, and proven bounds."""
    accuracy = model.accuracy
    return [
        (MEASURED_FIELD, _format_errors(accuracy.distance)),
        (MEASURED_SHELL, _format_errors(accuracy.coverage)),
        (
            "normal error",
            f"median {math.degrees(accuracy.normal.median):.2g}, "
            f"99 % {math.degrees(accuracy.normal.p99):.2g}, "
            f"worst {math.degrees(accuracy.normal.max):.2g} degrees",
        ),
        (
            PROVED,
            f"field error {format_length(field_bound(model))}, "
            f"distance to the shell {format_length(shell_bound(model))}",
        ),
    ]


def list_accuracy(model: Model) -> dict[str, Any]:
    """Return measured errors and proven bounds for JSON: meters and radians."""
    return {
        "measured": asdict(model.accuracy),
        "proved": {"field": field_bound(model), "shell": shell_bound(model)},
        "thickness": model.thickness,
    }


def field_bound(model: Model) -> float:
    """Return the proven distance from the surface where field and mesh may disagree, meters."""
    return model.field.surface_error


def shell_bound(model: Model) -> float:
    """Return the proven largest distance of the surface from the shell, meters."""
    return math.sqrt(3.0) * model.shell.spacing


def _describe_tolerance(model: Model) -> str:
    if model.tolerance is None:
        return "none: the model is uniform"
    return format_length(model.tolerance)


def _format_errors(errors: ErrorStatistic) -> str:
    return (
        f"median {format_length(errors.median)}, 99 % {format_length(errors.p99)}, "
        f"worst {format_length(errors.max)}"
    )


def format_extents(bounds: NDArray[np.float64]) -> str:
    """Return the edge lengths of the box around a body, meters."""
    return f"{' x '.join(f'{x:.4g}' for x in np.ptp(bounds, axis=0))} m"


def describe_sign(model: Model) -> str:
    """Return how the inside was found."""
    if model.field.sign_method == "closed":
        return "by the closed surface"
    return f"by winding numbers, with a confidence of {model.field.sign_confidence:.3f}"
