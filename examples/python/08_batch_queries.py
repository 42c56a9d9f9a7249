"""Many poses at once: where a hook fits in and around a ring.

`collide_batch` tests a hook against a ring at a grid of positions in several orientations, on all cores, as planning,
sampling and learning need it. `contacts_batch` returns the contacts of many poses in the same way. The picture shows
eight of the poses; hooks that hit the ring are red.
"""

import time

import numpy as np
import trimesh
import voxshell as vx
from command import parse_command, tell
from drawing import draw, plt
from replaying import replay

options = parse_command(__doc__)
side, turns = (48, 6) if options.quick else (160, 12)
ring = vx.Model.from_mesh(trimesh.creation.torus(0.04, 0.008), voxel_size=0.001)
bar = trimesh.creation.box((0.012, 0.012, 0.09))
tip = trimesh.creation.box((0.03, 0.012, 0.012)).apply_translation((0.021, 0.0, 0.039))
hook = vx.Model.from_mesh(trimesh.boolean.union([bar, tip], engine="manifold"), voxel_size=0.001)

places = np.linspace(-0.07, 0.07, side)
x, y = np.meshgrid(places, places)
poses = np.tile(np.eye(4), (turns, side * side, 1, 1))
for pose, angle in zip(poses, np.linspace(0.0, np.pi, turns, endpoint=False), strict=True):
    pose[:] = trimesh.transformations.rotation_matrix(angle, (0, 0, 1))
    pose[:, 0, 3], pose[:, 1, 3] = x.ravel(), y.ravel()
poses = poses.reshape(-1, 4, 4)
begin = time.perf_counter()
hit = vx.collide_batch(ring, hook, b_poses=poses)
seconds = time.perf_counter() - begin
contacts = vx.contacts_batch(ring, hook, b_poses=poses[hit][:100])

tell(
    options.out,
    {
        "poses": len(poses),
        "free_fraction": float(1.0 - hit.mean()),
        "microseconds_per_pose": 1e6 * seconds / len(poses),
        "contacts_of_100_poses": len(contacts.depths),
        "agrees_with_single_calls": all(
            vx.collide(ring, hook, b_pose=pose) == answer
            for pose, answer in zip(poses[::97], hit[::97], strict=True)
        ),
    },
)
free = 1.0 - hit.reshape(turns, side, side).mean(axis=0)
figure, axes = plt.subplots(figsize=(6, 5), layout="constrained")
shades = axes.pcolormesh(1e3 * places, 1e3 * places, free, cmap="viridis")
axes.set(aspect="equal", xlabel="x, mm", ylabel="y, mm")
figure.colorbar(shades, label="fraction of orientations that are free")
figure.savefig(
    options.out / "plot.png", dpi=110, bbox_inches="tight"
)  # constrained layout cuts labels off
row = turns // 2, side // 2, np.linspace(0, side - 1, 8).astype(int)
some, stuck = poses.reshape(turns, side, side, 4, 4)[row], hit.reshape(turns, side, side)[row]
colors = [(200, 52, 72) if hits else (92, 141, 208) for hits in stuck]
shown = [(hook, pose, color) for pose, color in zip(some, colors, strict=True)]
draw(options.out / "picture.png", [(ring, np.eye(4), (176, 182, 190)), *shown], elevation=30)
line = poses.reshape(turns, side, side, 4, 4)[0, side // 2]  # straight across the ring
replay(options.out / "replay.html", ring, hook, line, seconds=4.0, title="A hook across a ring")
