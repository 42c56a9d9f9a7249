"""Checks of the settings of a build."""

from __future__ import annotations

from typing import Any

from voxshell.base.arguments import FARTHEST, as_choice, as_integer, as_length, as_real
from voxshell.errors import SettingsError

_LARGEST_INT = 2**31 - 1

# The default tolerance, as choose_tolerance() in core/src/model/model.cpp has it.
_OF_SIDE, _OF_LARGE_SIDE, _OF_THICKNESS = 1.0 / 2000.0, 1.0 / 20000.0, 1.0 / 20.0
_LARGE = 0.0002  # meters
SHEET_OF_SIDE = 1.0 / 200.0
"""Default thickness of sheets as a fraction of the longest side, in models by tolerance."""


def choose_tolerance(longest: float, thickness: float) -> float:
    """Return the tolerance that a model gets by default, meters.

    Args:
        longest: Longest side of the mesh, meters.
        thickness: Of its thinnest wall, meters.

    Example:
        >>> choose_tolerance(0.06, 0.002), choose_tolerance(0.06, 0.0002)
        (3e-05, 1e-05)
    """
    by_side = min(_OF_SIDE * longest, max(_LARGE, _OF_LARGE_SIDE * longest))
    return min(by_side, _OF_THICKNESS * thickness) if thickness > 0.0 else by_side


def as_settings(
    *,
    tolerance: float | None = None,
    voxel_size: float | None = None,
    resolution: int | None = None,
    point_spacing: float | None = None,
    target_points: int | None = None,
    padding: float | None = None,
    sign: str = "auto",
    open_as: str = "auto",
    sheet_thickness: float | None = None,
) -> dict[str, Any]:
    """Return the settings of a build as the core takes them; see :meth:`Model.from_mesh`.

    Raises:
        SettingsError: One is out of range or contradicts another.
    """
    for one, other, names in (
        (voxel_size, resolution, "voxel_size or resolution"),
        (point_spacing, target_points, "point_spacing or target_points"),
    ):
        if one is not None and other is not None:
            raise SettingsError(f"give either {names}, not both")
    sizes = (voxel_size, resolution, point_spacing, target_points)
    if tolerance is not None and any(size is not None for size in sizes):
        raise SettingsError(
            "give either a tolerance or the sizes of a uniform model (voxel_size, resolution, "
            "point_spacing, target_points), not both"
        )
    # The core takes 0 for "not given".
    return {
        "tolerance": 0.0 if tolerance is None else as_length(tolerance, "tolerance"),
        "voxel_size": 0.0 if voxel_size is None else as_length(voxel_size, "voxel_size"),
        "resolution": 0
        if resolution is None
        else as_integer(resolution, "resolution", 2, _LARGEST_INT),
        "point_spacing": 0.0
        if point_spacing is None
        else as_length(point_spacing, "point_spacing"),
        "target_points": 0
        if target_points is None
        else as_integer(target_points, "target_points", 1, _LARGEST_INT),
        "padding": -1.0 if padding is None else as_padding(padding),
        "sign": as_sign(sign),
        "open": as_open(open_as),
        "sheet_thickness": as_sheet_thickness(sheet_thickness, open_as),
    }


def as_sign(value: str) -> str:
    """Return a method to find the inside of a mesh."""
    return as_choice(value, "sign", ("auto", "closed", "winding"))


def as_open(value: str) -> str:
    """Return a treatment of open meshes."""
    return as_choice(value, "open", ("auto", "solid", "sheet"))


def as_sheet_thickness(value: float | None, open_as: str) -> float:
    """Return a thickness in meters, or 0 to let the core choose."""
    if value is None:
        return 0.0
    if open_as == "solid":
        raise SettingsError("sheet_thickness is for open='sheet' or 'auto', not for open='solid'")
    return as_length(value, "sheet_thickness")


def as_padding(value: float) -> float:
    """Return a padding around the mesh, in meters."""
    number = as_real(value, "padding")
    if not 0.0 <= number <= FARTHEST:
        raise SettingsError(f"padding must be from 0 to {FARTHEST:g} m, not {number:g}")
    return number
