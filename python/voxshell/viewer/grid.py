"""Grid lines on the grounds of replays and live views."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from voxshell.viewer.palette import FLOOR_COLOR

if TYPE_CHECKING:
    import viser

_SHADOW = 0.42
"""How much darker a floor is in shadow."""

DROP = 0.004
"""How far below its true height a ground is drawn, display units: less than a pixel. At the same height, the faces of
bodies that lie on it would flicker."""

_CELL_COLOR, _SECTION_COLOR = (188, 194, 202), (150, 158, 168)


def add_grid(
    scene: viser.SceneApi,
    name: str,
    *,
    size: tuple[float, float],
    cell: float,
    plane: Literal["xy", "xz", "yz"] = "xy",
    position: tuple[float, float, float] = (0.0, 0.0, 0.0),
    fade: float | None = None,
    floor_color: tuple[int, int, int] = FLOOR_COLOR,
) -> Any:
    """Add lines outward from a plane's center, every fifth one stronger, in display units.

    Args:
        scene: The scene that gets the node.
        name: Name of the node.
        size: Sides of the plane.
        cell: Distance between lines.
        plane: The axes that span the plane.
        position: Center of the plane.
        fade: Distance from the center at which the floor has faded out; None draws lines alone.
        floor_color: Color of the floor.
    """
    floor: dict[str, Any] = {"shadow_opacity": 0.0}
    if fade is not None:
        floor = {
            "shadow_opacity": _SHADOW,
            "plane_color": floor_color,
            "plane_opacity": 1.0,
            "fade_distance": fade,
            "fade_strength": 1.4,
            "fade_from": "origin",
        }
    return scene.add_grid(
        name,
        width=size[0],
        height=size[1],
        plane=plane,
        position=position,
        cell_size=cell,
        section_size=5.0 * cell,
        cell_thickness=0.6,
        section_thickness=1.0,
        cell_color=_CELL_COLOR,
        section_color=_SECTION_COLOR,
        **floor,
    )
