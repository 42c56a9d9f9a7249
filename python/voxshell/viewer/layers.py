"""Visible layers of a model: slices and level surfaces of its field, and its tree in colors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from voxshell.base.extras import explain_import
from voxshell.base.lengths import metric
from voxshell.model.meshes import Mesh

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.model.model import Model

Axis = Literal["x", "y", "z"]

_PIXELS = 256
_BANDS = 12
"""Number of distance bands, from the surface to the farthest distance in a slice."""

_CELLS = 48
"""Number of grid cells along the longest side, from which a level surface is made."""

# Colors from the surface inward and outward, pale to strong.
_INSIDE = np.array(((198, 219, 245), (33, 82, 156)), dtype=np.float64)
_OUTSIDE = np.array(((252, 226, 205), (176, 58, 30)), dtype=np.float64)
_SURFACE = np.array((20.0, 20.0, 20.0))


def find_box(model: Model) -> NDArray[np.float64]:
    """Return the box for slices, (2, 3), meters: the model's bounds, enlarged by a fifth."""
    low, high = model.bounds
    around = 0.2 * float((high - low).max())
    return np.stack([low - around, high + around])


def paint_slice(model: Model, axis: Axis, fraction: float) -> NDArray[np.uint8]:
    """Return the field in a plane normal to an axis, in bands of color, with a black surface.

    Args:
        model: The model.
        axis: The normal of the plane.
        fraction: Position along that side of :func:`find_box`, 0 to 1.

    Returns:
        (h, w, 3): blue inside, red outside. Of the other two axes, in the order x, y, z, columns
        follow the first and rows go up the second.
    """
    low, high = find_box(model)
    across = "xyz".index(axis)
    first, second = (number for number in range(3) if number != across)
    sides = (high - low)[[first, second]]
    width, height = np.maximum(np.round(_PIXELS * sides / sides.max()), 2).astype(int).tolist()
    points = np.empty((height, width, 3))
    points[..., across] = low[across] + fraction * (high - low)[across]
    points[..., first] = np.linspace(low[first], high[first], width)
    points[..., second] = np.linspace(low[second], high[second], height)[:, None]
    distances = model.field.sample(points.reshape(-1, 3)).reshape(height, width)
    reach = _find_reach(model)
    bands = np.clip(np.ceil(np.abs(distances) / reach * _BANDS) / _BANDS, 0.0, 1.0)[..., None]
    inside, outside = (
        pale + bands * (strong - pale) for pale, strong in (tuple(_INSIDE), tuple(_OUTSIDE))
    )
    colors = np.where(distances[..., None] < 0.0, inside, outside)
    colors[np.abs(distances) < 0.6 * sides.max() / _PIXELS] = _SURFACE
    return colors.round().astype(np.uint8)


def describe_slice(model: Model) -> str:
    """Return the legend of :func:`paint_slice`, HTML: the colors, their distances, and the width of a band."""
    reach = _find_reach(model)
    colors = [*_INSIDE[::-1], *_OUTSIDE]
    deep, shallow, near, far = (
        f"rgb({red:.0f}, {green:.0f}, {blue:.0f})" for red, green, blue in colors
    )
    bar = "display: inline-block; width: 2.8em; height: 0.7em; background: linear-gradient(90deg, "
    return (
        f"{metric(reach)} inside "
        f'<span style="{bar}{deep}, {shallow}); border-right: 2px solid black"></span>'
        f'<span style="{bar}{near}, {far})"></span> {metric(reach)} outside<br>'
        f"black: the surface; a band: {metric(reach / _BANDS)}"
    )


def _find_reach(model: Model) -> float:
    """Return the distance of the strongest colors of a slice, meters."""
    low, high = find_box(model)
    return 0.5 * float((high - low).max())


def find_level_surface(model: Model, distance: float) -> Mesh:
    """Return the surface where the field has a value, meters; empty if there is none.

    Raises:
        MissingExtraError: manifold3d is not installed.
    """
    try:
        from manifold3d import Manifold  # pyright: ignore[reportMissingImports]
    except ImportError as error:
        raise explain_import(
            error, "level surfaces are made with manifold3d: pip install 'voxshell[viewer]'"
        ) from error
    low, high = model.bounds
    edge = float((high - low).max()) / _CELLS
    around = max(distance, 0.0) + 2.0 * edge
    sample = model.field.sample

    def inner(x: float, y: float, z: float) -> float:
        return -float(sample([[x, y, z]])[0])

    box = [*(low - around).tolist(), *(high + around).tolist()]
    found = Manifold.level_set(inner, box, edge, -distance).to_mesh64()
    return Mesh(
        np.array(found.vert_properties[:, :3], dtype=np.float64),
        np.array(found.tri_verts, dtype=np.uint32),
    )


def color_segments(segments: NDArray[np.int64]) -> NDArray[np.uint8]:
    """Return a color for each segment, (n, 3); consecutive segments have very different colors.

    Example:
        >>> import numpy as np
        >>> color_segments(np.array([0, 0, 1])).tolist()
        [[217, 87, 87], [217, 87, 87], [87, 125, 217]]
    """
    # Multiples of the golden ratio spread evenly over the color circle, whatever their number.
    hue = 6.0 * np.modf(segments * 0.6180339887498949)[0]
    channels = [
        np.clip(np.abs(hue - 3.0) - 1.0, 0.0, 1.0),
        np.clip(2.0 - np.abs(hue - 2.0), 0.0, 1.0),
        np.clip(2.0 - np.abs(hue - 4.0), 0.0, 1.0),
    ]
    return (87.0 + 130.0 * np.stack(channels, axis=1)).round().astype(np.uint8)
