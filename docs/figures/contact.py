"""Two mugs that hang in each other's handles."""

import matplotlib.pyplot as plt
import numpy as np
import voxshell as vx
from mug import GRIP, HEIGHT, RADIUS, THICKNESS, make_mug

mug = vx.Model.from_mesh(make_mug(), voxel_size=0.001)
# Its handle's ring at right angles to the first one's, 1 mm into its bar.
grip_in_mug = np.eye(4)
grip_in_mug[:3, 3] = RADIUS, 0.0, 0.5 * HEIGHT
turned = np.array(
    [[-1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
)
place = np.eye(4)
place[0, 3] = RADIUS + 2.0 * (GRIP - THICKNESS) + 0.001
place[2, 3] = 0.5 * HEIGHT
pose = place @ turned @ np.linalg.inv(grip_in_mug)
contacts = vx.contacts(mug, mug, b_pose=pose, shell="b")
other = mug.shell.points @ pose[:3, :3].T + pose[:3, 3]

figure, panels = plt.subplots(1, 2)
middle = contacts.points_b.mean(axis=0)
for axes, (across, up), names in zip(panels, ((0, 2), (0, 1)), ("xz", "xy"), strict=True):
    for points, color in ((mug.shell.points, "#5c8dd0"), (other, "#b08abe")):
        near = np.abs(points - middle).max(axis=1) < 0.024
        axes.scatter(*(1e3 * points[near][:, [across, up]].T), s=2, color=color, alpha=0.5)
    at = 1e3 * contacts.points_b
    shades = axes.scatter(at[:, across], at[:, up], s=12, c=1e3 * contacts.depths, cmap="autumn_r")
    some = contacts.manifold(4)
    axes.quiver(
        *(1e3 * some.points_b[:, [across, up]].T), *some.normals[:, [across, up]].T, width=0.006
    )
    axes.set(aspect="equal", xlabel=f"{names[0]}, mm", ylabel=f"{names[1]}, mm")
figure.colorbar(shades, ax=panels, label="depth, mm", shrink=0.85)
