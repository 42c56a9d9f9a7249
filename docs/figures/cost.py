"""Memory of the field and number of points against the voxel size."""

import matplotlib.pyplot as plt
import numpy as np
import voxshell as vx
from bodies import make_bodies

VOXELS = np.array([0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0]) * 1e-3
mesh, _ = make_bodies()["torus"]
models = [vx.Model.from_mesh(mesh, voxel_size=voxel) for voxel in VOXELS]
dense = np.array([4 * np.prod(np.array(model.field.shape, float)) for model in models])
figure, (memory, points) = plt.subplots(1, 2)
memory.loglog(
    1e3 * VOXELS, [model.field.nbytes / 1e6 for model in models], marker="o", label="field"
)
memory.loglog(1e3 * VOXELS, dense / 1e6, marker="o", color="0.6", label="a dense grid of floats")
memory.set(ylabel="MB")
memory.legend(frameon=False)
points.loglog(1e3 * VOXELS, [len(model.shell) for model in models], marker="o")
points.set(ylabel="points")
for axes in (memory, points):
    axes.set(xlabel="voxel size, mm", xticks=(0.5, 1, 2, 4))
    axes.set_xticklabels(("0.5", "1", "2", "4"))
    axes.xaxis.minorticks_off()
    axes.grid(alpha=0.3)
