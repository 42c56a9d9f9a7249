"""A cut through a mug's field, and some of its nodes."""

import matplotlib.pyplot as plt
import numpy as np
import voxshell as vx
from mug import make_mug

VOXEL = 0.002
model = vx.Model.from_mesh(make_mug(), voxel_size=VOXEL)


def sample(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Distances in the plane y = 0, (len(z), len(x)), millimeters."""
    places = np.stack([*np.meshgrid(x, z)], axis=-1)
    points = np.insert(places.reshape(-1, 2), 1, 0.0, axis=1)
    return 1e3 * model.field.sample(points).reshape(len(z), len(x))


figure, (whole, near) = plt.subplots(1, 2)
for axes, x_ends, z_ends in (
    (whole, (-0.06, 0.09), (-0.02, 0.11)),
    (near, (0.026, 0.046), (0.057, 0.0745)),
):
    x, z = np.linspace(*x_ends, 300), np.linspace(*z_ends, 260)
    distances = sample(x, z)
    reach = 20.0 if axes is whole else 6.0
    shades = axes.contourf(
        1e3 * x, 1e3 * z, distances, np.linspace(-reach, reach, 25), cmap="RdBu_r", extend="both"
    )
    axes.contour(1e3 * x, 1e3 * z, distances, [0.0], colors="black", linewidths=1.8)
    axes.set(aspect="equal", xlabel="x, mm", ylabel="z, mm")
    figure.colorbar(shades, ax=axes, label="signed distance, mm", shrink=0.85)
origin = model.field.origin
first = origin + np.round((np.array([0.026, 0.0, 0.057]) - origin) / VOXEL) * VOXEL
x, z = first[0] + VOXEL * np.arange(11), first[2] + VOXEL * np.arange(9)
near.scatter(*(1e3 * np.array(np.meshgrid(x, z))), s=8, color="black")
near.set(xlim=(26, 46), ylim=(57, 74.5))
