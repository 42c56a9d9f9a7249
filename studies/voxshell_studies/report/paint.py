"""Pictures of bodies without a graphics card: triangles and points, painted from back to front."""

from __future__ import annotations

import colorsys
from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np
from voxshell.base.outputs import write_bytes
from voxshell.errors import MissingExtraError
from voxshell.model.meshes import Mesh

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

_LIGHT = np.array([0.35, -0.6, 0.72])
_AMBIENT = 0.35
_SMOOTHING = 2
"""Painted pixels per final pixel, along each side."""


@dataclass(frozen=True)
class Camera:
    """A parallel view.

    Attributes:
        target: The point in the center, meters, world frame.
        width: Width of the view, meters.
        pixels: Width and height of the picture.
        azimuth: Direction of the view, degrees about z; 0 looks along y.
        elevation: Angle from above, degrees.
    """

    target: tuple[float, float, float]
    width: float
    pixels: tuple[int, int]
    azimuth: float = 25.0
    elevation: float = 18.0

    @property
    def axes(self) -> NDArray[np.float64]:
        """The axes right, up, and toward the viewer as rows, world frame."""
        turn, tilt = np.radians([self.azimuth, self.elevation])
        right = np.array([np.cos(turn), np.sin(turn), 0.0])
        back = np.array([np.sin(turn) * np.cos(tilt), -np.cos(turn) * np.cos(tilt), np.sin(tilt)])
        return np.stack([right, np.cross(back, right), back])

    def project(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return column, row in painted pixels, and nearness, meters, of points, (n, 3)."""
        seen = (points - np.array(self.target)) @ self.axes.T
        scale = _SMOOTHING * self.pixels[0] / self.width
        seen[:, 0] = 0.5 * _SMOOTHING * self.pixels[0] + scale * seen[:, 0]
        seen[:, 1] = 0.5 * _SMOOTHING * self.pixels[1] - scale * seen[:, 1]
        return seen


@dataclass(frozen=True, eq=False)
class Solid:
    """A body to paint.

    Attributes:
        mesh: Its triangles, body frame.
        pose: ``world_from_body``, (4, 4).
        color: 0 to 255, (3,), or one per face, (m, 3).
        edges: Draw the triangles' outlines.
    """

    mesh: Mesh
    pose: NDArray[np.float64]
    color: Any
    edges: bool = False


class Canvas:
    """A white picture to paint on; later objects hide earlier ones.

    Raises:
        MissingExtraError: Pillow is not installed.
    """

    def __init__(self, camera: Camera) -> None:
        image, draw = _import_pillow()
        self.camera = camera
        size = (camera.pixels[0] * _SMOOTHING, camera.pixels[1] * _SMOOTHING)
        self._image = image.new("RGB", size, "white")
        self._draw = draw.Draw(self._image)

    def paint_floor(self, low: Sequence[float], high: Sequence[float], height: float = 0.0) -> None:
        """Paint a gray rectangle at a height, between corners (x, y), meters."""
        corners = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]
        flat = self.camera.project(np.array([(*corner, height) for corner in corners]))
        self._draw.polygon([tuple(p) for p in flat[:, :2].tolist()], fill=(226, 229, 234))

    def paint(self, solids: Sequence[Solid]) -> None:
        """Paint bodies, lit from above; bodies that hide each other must be painted together."""
        triangles, colors, outlined = [], [], []
        for solid in solids:
            world = solid.mesh.vertices @ solid.pose[:3, :3].T + solid.pose[:3, 3]
            corners = world[solid.mesh.faces]
            normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-30)[:, None]
            front = normals @ self.camera.axes[2] > 0.0
            base = np.broadcast_to(np.asarray(solid.color, float), (len(normals), 3))
            triangles.append(corners[front])
            colors.append(_shade(base[front], normals[front]))
            outlined.append(np.full(int(front.sum()), solid.edges))
        corners = np.concatenate(triangles)
        seen = self.camera.project(corners.reshape(-1, 3)).reshape(-1, 3, 3)
        order = np.argsort(seen[:, :, 2].mean(axis=1))
        shades, edges = np.concatenate(colors), np.concatenate(outlined)
        flat = seen[order, :, :2].reshape(-1, 6).tolist()
        for place, shade, edge in zip(flat, shades[order].tolist(), edges[order], strict=True):
            color = tuple(shade)
            # The outline closes the thin gap between neighbors.
            outline = tuple(c // 2 for c in color) if edge else color
            self._draw.polygon(place, fill=color, outline=outline)

    def paint_points(
        self,
        points: NDArray[np.float64],
        normals: NDArray[np.float64],
        colors: NDArray[np.float64],
        radius: float,
    ) -> None:
        """Paint the points of a surface that face the viewer, as discs.

        Args:
            points: (n, 3) meters, world frame.
            normals: (n, 3) unit, outward.
            colors: (n, 3), 0 to 255.
            radius: Meters.
        """
        front = normals @ self.camera.axes[2] > 0.0
        seen = self.camera.project(points[front])
        order = np.argsort(seen[:, 2])
        shades = _shade(colors[front], normals[front])[order].tolist()
        size = max(radius * _SMOOTHING * self.camera.pixels[0] / self.camera.width, 1.0)
        for (x, y), shade in zip(seen[order, :2].tolist(), shades, strict=True):
            self._draw.ellipse((x - size, y - size, x + size, y + size), fill=tuple(shade))

    def write(self, text: str, column: float, row: float) -> None:
        """Write dark text, centered at fractions of the width and height."""
        font = _import_font(int(_SMOOTHING * 13))
        at = (column * self._image.width, row * self._image.height)
        self._draw.multiline_text(
            at, text, fill=(60, 60, 60), anchor="mm", font=font, align="center"
        )

    def finish(self) -> Any:
        """Return the picture."""
        image, _ = _import_pillow()
        return self._image.resize(self.camera.pixels, image.Resampling.BOX)


def thin_out(mesh: Mesh, cell: float) -> Mesh:
    """Return a mesh with vertices merged on a grid of cubes, edge in meters, for small pictures.

    Example:
        >>> import trimesh
        >>> ball = trimesh.creation.icosphere(4)
        >>> len(thin_out(Mesh(ball.vertices, ball.faces), 0.3).faces) < len(ball.faces) / 4
        True
    """
    cells = np.floor(mesh.vertices / cell).astype(np.int64)
    _, inverse = np.unique(cells, axis=0, return_inverse=True)
    inverse = inverse.reshape(-1)
    counts = np.bincount(inverse)
    vertices = np.stack(
        [np.bincount(inverse, mesh.vertices[:, i]) / counts for i in range(3)], axis=1
    )
    faces = inverse[mesh.faces]
    whole = (
        (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    )
    return Mesh(vertices, faces[whole].astype(np.uint32))


def join_row(pictures: Sequence[Any], columns: int | None = None) -> Any:
    """Return pictures of equal size side by side; with ``columns``, in several rows."""
    image, _ = _import_pillow()
    columns = min(columns or len(pictures), len(pictures))
    rows = -(-len(pictures) // columns)
    width, height = pictures[0].size
    sheet = image.new("RGB", (width * columns, height * rows), "white")
    for number, picture in enumerate(pictures):
        sheet.paste(picture, (width * (number % columns), height * (number // columns)))
    return sheet


def save_row(pictures: Sequence[Any], path: Path, columns: int | None = None) -> None:
    """Write the result of :func:`join_row`."""
    save_picture(join_row(pictures, columns), path)


def save_picture(picture: Any, path: Path, **options: Any) -> None:
    """Write a Pillow picture completely or not at all.

    Args:
        picture: The picture.
        path: The file; its suffix determines the format.
        **options: Options of the format.
    """
    content = BytesIO()
    picture.save(content, format=path.suffix[1:].upper(), **options)
    write_bytes(path, content.getbuffer())


def make_hue(number: int) -> tuple[int, int, int]:
    """Return very different colors for consecutive numbers: hues by the golden ratio."""
    red, green, blue = colorsys.hsv_to_rgb((0.13 + 0.618034 * number) % 1.0, 0.55, 0.95)
    return round(255 * red), round(255 * green), round(255 * blue)


def _shade(colors: NDArray[np.float64], normals: NDArray[np.float64]) -> NDArray[np.int64]:
    light = _LIGHT / np.linalg.norm(_LIGHT)
    brightness = _AMBIENT + (1.0 - _AMBIENT) * np.clip(0.5 + 0.5 * normals @ light, 0.0, 1.0)
    return np.clip(colors * (1.15 * brightness)[:, None], 0, 255).astype(np.int64)


def _import_pillow() -> tuple[Any, Any]:
    try:
        from PIL import Image, ImageDraw
    except ImportError as error:
        raise MissingExtraError("pictures need Pillow: pip install voxshell-studies") from error
    return Image, ImageDraw


def _import_font(size: int) -> Any:
    from PIL import ImageFont

    return ImageFont.load_default(size)
