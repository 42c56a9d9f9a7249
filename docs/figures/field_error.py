"""Error of the field near the surface, against the voxel size."""

import matplotlib.pyplot as plt
import numpy as np
import voxshell as vx
from bodies import make_bodies

VOXELS = np.array([0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0]) * 1e-3
rng = np.random.default_rng(1)
figure, panels = plt.subplots(1, 2, sharey=True)
for axes, (name, (mesh, exact)) in zip(panels, make_bodies().items(), strict=True):
    surface = mesh.sample(20_000, seed=1)
    rows = []
    for voxel in VOXELS:
        field = vx.Model.from_mesh(mesh, voxel_size=voxel, target_points=500).field
        points = surface + voxel / np.sqrt(3.0) * rng.uniform(-1.0, 1.0, surface.shape)
        error = np.abs(field.sample(points) - exact(points))
        rows.append((field.interpolation_error, error.max(), np.median(error)))
    for values, label in zip(np.array(rows).T, ("stated bound", "worst", "median"), strict=True):
        axes.loglog(1e3 * VOXELS, 1e3 * values, marker="o", label=label)
    axes.set(title=name, xlabel="voxel size, mm", xticks=(0.5, 1, 2, 4))
    axes.set_xticklabels(("0.5", "1", "2", "4"))
    axes.minorticks_off()
    axes.grid(alpha=0.3)
panels[0].set_ylabel("error, mm")
panels[0].legend(frameon=False)
