"""Light, the same on all pages: a sun with shadows, and a sky."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from voxshell.viewer.lanes import view_axes

if TYPE_CHECKING:
    import viser

SUN = (-0.50, -0.42, 0.76)
"""From where the sun shines: to the right, away from the viewer, and up."""
_SUN_LIGHT, _SKY_LIGHT = 2.8, 1.27


def add_lights(scene: viser.SceneApi, *, up: str) -> tuple[Any, Any]:
    """Replace viser's lights, which are its own sun and the picture of a room; ``own_look.js`` keeps them away.

    Args:
        scene: Where.
        up: The world axis that points up.

    Returns:
        The nodes of the sun and of the sky.
    """
    right, forward, upward = view_axes(up)
    across, back, above = SUN
    place = 10.0 * (across * right + back * forward + above * upward)
    scene.configure_default_lights(enabled=False)
    scene.configure_environment_map(None)
    sun = scene.add_light_directional(
        "/lights/sun",
        color=(255, 247, 235),
        intensity=_SUN_LIGHT,
        cast_shadow=True,
        position=tuple(place.tolist()),
    )
    sky = scene.add_light_hemisphere(
        "/lights/sky",
        sky_color=(231, 236, 255),
        ground_color=(106, 101, 97),
        intensity=_SKY_LIGHT,
    )
    return sun, sky
