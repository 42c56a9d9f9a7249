"""The ground and the light of videos: soft shadows on a grid that fades into the background."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.viewer.lanes import view_axes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

BACKGROUND = (244, 246, 249)
_LINE_COLOR = (176, 184, 194)
_REACH = 2.5  # half of the ground's side, in sides of the stage
_TEXELS = 480  # along a side, of shadows
_SUN = np.array([0.42, 0.30, -1.0])  # along right, forward and up: where its light goes
_DARKEST = 0.36  # fraction of the light that a shadow takes
_SOFT = 5  # texels that edges of shadows are blurred by, three times
_SAMPLES = 6000  # points of a body that cast its shadow


class Ground:
    """A level square under all bodies.

    Args:
        pyvista: The library.
        plotter: Where it is drawn.
        up: The world axis that points up.
        place: (3,) meters; its height along ``up`` is that of the ground.
        low, high: (3,) meters; the corners of what moves.
        cell: Distance of grid lines, meters.
        color: Of the ground.
    """

    def __init__(
        self,
        pyvista: Any,
        plotter: Any,
        *,
        up: str,
        place: NDArray[np.float64],
        low: NDArray[np.float64],
        high: NDArray[np.float64],
        cell: float,
        color: tuple[int, int, int],
    ) -> None:
        right, forward, upward = view_axes(up)
        self._axes = np.stack([right, forward, upward])
        first, last = self._axes[:2] @ low, self._axes[:2] @ high
        self._middle = 0.5 * (first + last)
        self._reach = _REACH * float(np.abs(last - first).max())
        self._height = float(upward @ place)
        ticks = np.linspace(-self._reach, self._reach, _TEXELS)
        across, along = np.meshgrid(ticks, ticks)
        self._color_fraction = self._fade(np.hypot(across, along))[..., None]
        self._base = np.array(color, dtype=np.float64)
        self._bare = self._shade(1.0, self._color_fraction)
        ends = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
        corners = self._lift(self._middle + self._reach * ends, 0.0)
        plane = pyvista.PolyData.from_regular_faces(corners, np.array([[0, 1, 2], [0, 2, 3]]))
        plane.active_texture_coordinates = 0.5 + 0.5 * ends
        self._picture = pyvista.Texture(np.zeros((_TEXELS, _TEXELS, 3), dtype=np.uint8))
        self._picture.interpolate = True
        plotter.add_mesh(plane, texture=self._picture, lighting=False, render=False)
        self._add_lines(pyvista, plotter, cell)

    def cast(self, bodies: Sequence[tuple[NDArray[np.float64], NDArray[np.float64]]]) -> None:
        """Color the ground by the shadows of bodies: (k, 3) points of each, and its pose."""
        shadow = np.zeros((_TEXELS, _TEXELS))
        for points, pose in bodies:
            seen = (points @ pose[:3, :3].T + pose[:3, 3]) @ self._axes.T
            above = seen[:, 2] - self._height
            places = seen[:, :2] + np.maximum(above, 0.0)[:, None] * (_SUN[:2] / -_SUN[2])
            texels = (places - self._middle + self._reach) * ((_TEXELS - 1) / (2.0 * self._reach))
            columns, rows = texels.round().astype(np.int64).T
            inside = (np.minimum(columns, rows) >= 0) & (np.maximum(columns, rows) < _TEXELS)
            shadow[rows[inside], columns[inside]] = 1.0
        color = self._bare.copy()
        part = _find_part(shadow)
        if part is not None:
            light = 1.0 - _DARKEST * np.minimum(1.4 * _blur(shadow[part]), 1.0)
            color[part] = self._shade(light[..., None], self._color_fraction[part])
        image = self._picture.to_image()
        image.point_data.active_scalars[:] = color.reshape(-1, 3)
        self._picture.Modified()

    def _shade(
        self, light: NDArray[np.float64] | float, fraction: NDArray[np.float64]
    ) -> NDArray[np.uint8]:
        """Return colors in a light, 0 to 1, where a fraction of the ground's color is seen."""
        color = self._base * light * fraction + BACKGROUND * (1.0 - fraction)
        return color.round().astype(np.uint8)

    def _fade(self, distance: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how much of the ground's color is seen at a distance from the middle, 1 to 0."""
        fraction = np.clip((0.95 * self._reach - distance) / (0.7 * self._reach), 0.0, 1.0)
        return fraction * fraction * (3.0 - 2.0 * fraction)

    def _lift(self, level: NDArray[np.float64], by: float) -> NDArray[np.float64]:
        """Return (k, 3) world points from (k, 2) coordinates along right and forward."""
        heights = np.full((len(level), 1), self._height + by)
        return np.concatenate([level, heights], axis=1) @ self._axes

    def _add_lines(self, pyvista: Any, plotter: Any, cell: float) -> None:
        """Add lines that cross at multiples of the cell, and fade with the ground."""
        steps = np.linspace(-self._reach, self._reach, 65)
        ends = []
        for axis in (0, 1):
            first = math.ceil((self._middle[axis] - self._reach) / cell)
            last = math.floor((self._middle[axis] + self._reach) / cell)
            for line in range(first, last + 1):
                points = np.empty((len(steps), 2))
                points[:, axis] = line * cell
                points[:, 1 - axis] = self._middle[1 - axis] + steps
                ends.append(np.repeat(points, 2, axis=0)[1:-1])
        if not ends:
            return
        level = np.concatenate(ends)
        lines = pyvista.line_segments_from_points(self._lift(level, 0.0005 * self._reach))
        fraction = self._fade(np.linalg.norm(level - self._middle, axis=1))[:, None]
        color = np.array(_LINE_COLOR) * fraction + np.array(BACKGROUND) * (1.0 - fraction)
        lines["color"] = color.round().astype(np.uint8)
        plotter.add_mesh(
            lines, scalars="color", rgb=True, line_width=1, lighting=False, render=False
        )


def add_light(pyvista: Any, plotter: Any, *, up: str) -> None:
    """Add the sun, which shines from the left above the camera, and weaker light from the right."""
    right, forward, upward = view_axes(up)
    for way, strength in (
        (-_SUN @ (right, forward, upward), 0.85),
        (0.9 * right - 0.8 * forward + 0.4 * upward, 0.25),
    ):
        light = pyvista.Light(position=tuple(way), light_type="scene light", intensity=strength)
        plotter.add_light(light)


def sample_surface(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return points that lie evenly on a surface, the same in every call."""
    corners = vertices[faces]
    areas = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    total = np.cumsum(areas)
    if total[-1] <= 0.0:
        return vertices
    # Multiples of these irrational numbers fill a cube evenly.
    fractions = (
        np.arange(1, _SAMPLES + 1)[:, None] * (0.8191725134, 0.6710436067, 0.5497004779) % 1.0
    )
    chosen = np.searchsorted(total, fractions[:, 0] * total[-1]).clip(max=len(faces) - 1)
    root, second = np.sqrt(fractions[:, 1:2]), fractions[:, 2:]
    a, b, c = np.moveaxis(corners[chosen], 1, 0)
    return (1.0 - root) * a + root * (1.0 - second) * b + root * second * c


def _find_part(shadow: NDArray[np.float64]) -> tuple[slice, slice] | None:
    """Return the rows and columns that a shadow reaches once it is blurred; None without a shadow."""
    margin = 3 * _SOFT + 4
    part = []
    for axis in (1, 0):
        found = np.flatnonzero(shadow.any(axis=axis))
        if not len(found):
            return None
        part.append(slice(max(int(found[0]) - margin, 0), int(found[-1]) + margin + 1))
    return part[0], part[1]


def _blur(picture: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a picture whose edges are soft: three times the mean of neighbors along both axes."""
    for axis in (0, 1):
        for _ in range(3):
            sums = np.cumsum(picture, axis=axis)
            ahead, behind = np.roll(sums, -_SOFT, axis), np.roll(sums, _SOFT + 1, axis)
            # Sums wrap around at the border, where the ground has faded out.
            picture = np.maximum((ahead - behind) / (2 * _SOFT + 1), 0.0)
    return picture
