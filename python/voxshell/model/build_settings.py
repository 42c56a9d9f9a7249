"""Checks of a build's settings other than lengths and numbers of points."""

from __future__ import annotations

from voxshell.base.arguments import FARTHEST, as_length, as_real
from voxshell.errors import SettingsError


def as_sign(value: str) -> str:
    """Return a method to find the inside of a mesh."""
    if value not in ("auto", "closed", "winding"):
        raise SettingsError(f"sign must be 'auto', 'closed' or 'winding', not {value!r}")
    return value


def as_open(value: str) -> str:
    """Return a treatment of open meshes."""
    if value not in ("auto", "solid", "sheet"):
        raise SettingsError(f"open must be 'auto', 'solid' or 'sheet', not {value!r}")
    return value


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
