"""Warnings that point at the line of the user's program, and name things in few words."""

from __future__ import annotations

import math
import os
import sys
import warnings
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable
    from types import FrameType

_WHOLE_TURN = 2.0 * math.pi
_LEAST_DEGREES = 15.0  # fewer may well be radians
_PACKAGE = os.path.dirname(os.path.dirname(__file__)) + os.sep
_LONGEST_PATH = 200


class UnitWarning(UserWarning):
    """A number is probably in another unit, such as degrees or millimeters."""


def warn_user(text: str, category: type[Warning]) -> None:
    """Show a warning at the first line outside of the package, however deep the call is in it."""
    level = 1
    frame: FrameType | None = sys._getframe()
    while frame is not None and frame.f_code.co_filename.startswith(_PACKAGE):
        frame = frame.f_back
        level += 1
    warnings.warn(text, category, stacklevel=level)


def doubt_degrees(angles: Iterable[float], name: str) -> None:
    """Warn of an angle that is probably in degrees: 15, 20, 25 and so on.

    Other angles beyond a turn are those of bodies that turn on and on.
    """
    for angle in angles:
        if abs(angle) >= _LEAST_DEGREES and angle % 5.0 == 0.0:
            warn_user(
                f"{name}: angles are in radians, and {angle:g} radians are {abs(angle) / _WHOLE_TURN:.3g} turns; "
                f"for degrees, pass math.radians({angle:g})",
                UnitWarning,
            )
            return


def shorten_path(path: str | os.PathLike[str]) -> str:
    """Return a path for a warning: the end of a long one, because it names the file.

    Example:
        >>> shorten_path("folder/part.stl")
        'folder/part.stl'
        >>> shorten_path("folder/" * 100 + "part.stl")[-16:]
        '/folder/part.stl'
    """
    text = os.fsdecode(path)
    return text if len(text) <= _LONGEST_PATH else f"...{text[-_LONGEST_PATH:]}"
