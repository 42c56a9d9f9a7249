"""Default colors of bodies, the same on every page and in every export."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from voxshell.recording import BodyTrack, Recording

# Cool and muted, so that contacts, which have warm colors, stand out.
BODY_COLORS = (
    (92, 141, 208),
    (72, 163, 154),
    (138, 122, 202),
    (122, 160, 92),
    (104, 132, 160),
    (176, 138, 190),
)
FIXED_COLOR = (176, 182, 190)
FLOOR_COLOR = (226, 230, 235)
FORCE_COLOR, PULL_COLOR = (196, 24, 92), (30, 120, 60)
"""Of the arrows for normal forces and for the mouse's spring."""


def choose_colors(recording: Recording) -> list[tuple[int, int, int]]:
    """Return red, green and blue, 0 to 255, of each body of a recording."""
    moving = [body for body in recording.bodies if not body.fixed]

    def choose(body: BodyTrack) -> tuple[int, int, int]:
        if body.color is not None or body.fixed:
            return body.color or FIXED_COLOR
        return BODY_COLORS[moving.index(body) % len(BODY_COLORS)]

    return [choose(body) for body in recording.bodies]
