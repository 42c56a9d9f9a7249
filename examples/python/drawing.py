"""Pictures of bodies, and plots, with numpy and matplotlib alone."""

import matplotlib.pyplot as plt
import numpy as np
import voxshell as vx
from matplotlib.colors import to_rgb

LIGHT = np.array([0.35, -0.6, 0.72])
COLORS = ("#5c8dd0", "#48a39a", "#8a7aca", "#c98f4e", "#b08abe", "#7aa05c")
WIDTH, HEIGHT, FINER = 720, 500, 2  # pixels, and how many are drawn for each one along a side


def draw(path, bodies, *, azimuth=25.0, elevation=20.0):
    """Writes a picture, seen from afar, of the nearest triangle in each pixel.

    Args:
        path: Of the PNG.
        bodies: Of a world, or pairs of model or mesh and pose; whatever has no mesh is left out.
        azimuth: From which side, degrees about z; 0 looks along y.
        elevation: From how far above, degrees.
    """
    turn, tilt = np.radians([azimuth, elevation])
    right = np.array([np.cos(turn), np.sin(turn), 0.0])
    back = np.array([np.sin(turn) * np.cos(tilt), -np.cos(turn) * np.cos(tilt), np.sin(tilt)])
    axes = np.stack([right, np.cross(back, right), back])
    triangles, shades = [], []
    for number, body in enumerate(bodies):
        shape, pose = body if isinstance(body, tuple) else (body.shape, body.pose)
        mesh = shape if isinstance(shape, vx.Mesh) else getattr(shape, "mesh", None)
        if mesh is None:
            continue
        corners = (mesh.vertices @ pose[:3, :3].T + pose[:3, 3])[mesh.faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        front = normals @ back > 0.0
        light = 0.35 + 0.65 * np.maximum(normals[front] @ LIGHT, 0.0)
        color = np.array(to_rgb(COLORS[number % len(COLORS)]))
        triangles.append(corners[front] @ axes.T)
        shades.append(np.minimum(light[:, None] * color + 0.12, 1.0))
    plt.imsave(path, _paint(np.concatenate(triangles), np.concatenate(shades)))


def _paint(triangles, shades):
    """Triangles (n, 3, 3), right, up and towards the viewer, as pixels (h, w, 3)."""
    size = np.array([WIDTH, HEIGHT]) * FINER
    low, high = triangles[:, :, :2].min(axis=(0, 1)), triangles[:, :, :2].max(axis=(0, 1))
    scale = 0.94 * (size / (high - low)).min()
    places = (triangles[:, :, :2] - 0.5 * (low + high)) * scale + 0.5 * size
    picture, nearest = np.ones((size[1], size[0], 3)), np.full((size[1], size[0]), -np.inf)
    first, last = np.floor(places.min(axis=1)).astype(int), np.ceil(places.max(axis=1)).astype(int)
    for (a, b, c), depths, (x0, y0), (x1, y1), shade in zip(
        places, triangles[:, :, 2], first, last, shades, strict=True
    ):
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if area == 0.0:
            continue
        x, y = np.arange(x0, x1 + 1), np.arange(y0, y1 + 1)[:, None]
        second = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area
        third = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area
        depth = depths[0] + second * (depths[1] - depths[0]) + third * (depths[2] - depths[0])
        window = np.s_[y0 : y1 + 1, x0 : x1 + 1]
        inside = (second >= 0) & (third >= 0) & (second + third <= 1) & (depth > nearest[window])
        nearest[window][inside] = depth[inside]
        picture[window][inside] = shade
    coarse = picture.reshape(HEIGHT, FINER, WIDTH, FINER, 3).mean(axis=(1, 3))
    return np.ascontiguousarray(coarse[::-1])


def plot(path, x, lines, *, x_label, y_label):
    """Writes a plot of named lines over x."""
    figure, axes = plt.subplots(figsize=(7.0, 3.5), layout="constrained")
    for label, y in lines.items():
        axes.plot(x, y, label=label)
    axes.set(xlabel=x_label, ylabel=y_label)
    axes.grid(alpha=0.3)
    if len(lines) > 1:
        axes.legend(frameon=False)
    figure.savefig(path, dpi=110)
    plt.close(figure)
