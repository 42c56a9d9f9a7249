"""Colors that users give to bodies of a world."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from voxshell.base.arguments import as_color
from voxshell.errors import InputTypeError
from voxshell.simulation.body import Body


def as_body_colors(colors: Any) -> dict[Body, tuple[int, int, int]]:
    """Return the colors of bodies, red, green and blue from 0 to 255; none for None.

    Raises:
        InputTypeError: ``colors`` is not a mapping, or a key is not a body.
        SettingsError: A color is not three integers from 0 to 255.
    """
    if colors is None:
        return {}
    if not isinstance(colors, Mapping):
        raise InputTypeError(
            f"colors must be a mapping from bodies to (red, green, blue), not {type(colors).__name__}"
        )
    for body in colors:
        if not isinstance(body, Body):
            raise InputTypeError(
                f"colors must have bodies as keys, as World.add returns them, not {body!r}"
            )
    return {body: as_color(color, f"color of {body.name!r}") for body, color in colors.items()}
