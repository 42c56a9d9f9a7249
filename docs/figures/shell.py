"""A mug's points in the colors of their segments, with the spheres of three levels."""

import matplotlib.pyplot as plt
import numpy as np
import voxshell as vx
from mug import make_mug

shell = vx.Model.from_mesh(make_mug(), voxel_size=0.002, point_spacing=0.0025).shell
points = 1e3 * shell.points
front = shell.normals[:, 1] < 0.0
figure, panels = plt.subplots(1, 3, sharey=True)
for axes, level in zip(panels, (2, 3, 4), strict=True):
    segments = shell.tree.segments(level)
    colors = plt.get_cmap("tab20")((7 * segments % 20) / 20)
    axes.scatter(points[front, 0], points[front, 2], s=3, color=colors[front])
    for x, _, z, radius in 1e3 * shell.tree.spheres(level):
        axes.add_patch(plt.Circle((x, z), radius, fill=False, color="0.25", linewidth=0.6))
    count = len(np.unique(segments))
    axes.set(aspect="equal", title=f"level {level}: {count} segments", xlabel="x, mm")
    axes.set(xlim=(-65, 90), ylim=(-25, 115))
panels[0].set_ylabel("z, mm")
