"""How much the deepest point of a shell falls short of the deepest place of its mesh."""

import matplotlib.pyplot as plt
import numpy as np
import trimesh
import voxshell as vx
from bodies import make_bodies

SPACINGS = np.array([0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0]) * 1e-3
DEPTH = 0.008
figure, panels = plt.subplots(1, 2, sharey=True)
for axes, (name, (mesh, _)) in zip(panels, make_bodies().items(), strict=True):
    rows = []
    for spacing in SPACINGS:
        model = vx.Model.from_mesh(mesh, voxel_size=0.004, point_spacing=spacing)
        missed = []
        for seed in range(40):
            pose = trimesh.transformations.random_rotation_matrix(
                np.random.default_rng(seed).random(3)
            )
            pose[2, 3] = -(model.mesh.vertices @ pose[2, :3]).min() - DEPTH
            missed.append(
                DEPTH - vx.contacts(model, vx.Plane(), a_pose=pose).depths.max(initial=0.0)
            )
        bound = vx.contact_bounds(model, vx.Plane()).overlap
        rows.append((bound, max(missed), np.median(missed)))
    for values, label in zip(np.array(rows).T, ("bound", "worst", "median"), strict=True):
        axes.loglog(1e3 * SPACINGS, 1e3 * np.maximum(values, 1e-7), marker="o", label=label)
    axes.set(title=name, xlabel="spacing of points, mm", xticks=(0.5, 1, 2, 4))
    axes.set_xticklabels(("0.5", "1", "2", "4"))
    axes.minorticks_off()
    axes.grid(alpha=0.3)
panels[0].set_ylabel("depth missed, mm")
panels[0].legend(frameon=False)
