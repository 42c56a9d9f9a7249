"""Light, the same on all pages: a sun with shadows, a sky, and a room."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from voxshell.viewer.lanes import view_axes

if TYPE_CHECKING:
    import viser

SUN = (-0.50, -0.42, 0.76)
"""From where the sun shines: to the right, away from the viewer, and up."""
_SUN_LIGHT, _SKY_LIGHT, ROOM_LIGHT = 2.8, 0.35, 0.2


def add_lights(scene: viser.SceneApi, *, up: str, room: bool = True) -> tuple[Any, Any]:
    """Replaces viser's lights, which shine from above.

    Args:
        scene: Where.
        up: The world axis that points up.
        room: Whether to send the picture of the room, too. A replay would load it again in each round, and the
            player hides everything while it loads; the page dims the player's own instead.

    Returns:
        The nodes of the sun and of the sky.
    """
    right, forward, upward = view_axes(up)
    across, back, above = SUN
    place = 10.0 * (across * right + back * forward + above * upward)
    scene.configure_default_lights(enabled=False)
    if room:
        scene.configure_environment_map("studio", environment_intensity=ROOM_LIGHT)
    sun = scene.add_light_directional(
        "/lights/sun",
        color=(255, 247, 235),
        intensity=_SUN_LIGHT,
        cast_shadow=True,
        position=tuple(place.tolist()),
    )
    sky = scene.add_light_hemisphere(
        "/lights/sky",
        sky_color=(226, 236, 250),
        ground_color=(176, 172, 168),
        intensity=_SKY_LIGHT,
    )
    return sun, sky
