"""Grid lines on the grounds of replays and live views."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    import viser

_CELL_COLOR, _SECTION_COLOR = (188, 194, 202), (150, 158, 168)


def add_grid(
    scene: viser.SceneApi,
    name: str,
    *,
    size: tuple[float, float],
    cell: float,
    plane: Literal["xy", "xz", "yz"] = "xy",
    position: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Any:
    """Add lines outward from a plane's center, every fifth one stronger, in display units."""
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
        shadow_opacity=0.0,
    )
