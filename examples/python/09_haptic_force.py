"""Haptic forces: a probe moves along a rough wall, with 1,000 queries a second.

The force of `wrench` is continuous in the pose: it does not jump when points enter or leave the contact. A scratch that
is reused lets each call start from the result of the last one. The program also measures the time of each call.
"""

import time

import numpy as np
import trimesh
import voxshell as vx
from command import parse_command, tell
from drawing import as_recording, draw, plot
from replaying import replay

options = parse_command(__doc__)
steps = 1000 if options.quick else 5000
wall = trimesh.creation.icosphere(5, radius=0.1)
wall.vertices *= (1.0 + 0.03 * np.sin(0.25e3 * wall.vertices).prod(axis=1))[:, None]
rough = vx.Model.from_mesh(wall, voxel_size=0.001, point_spacing=0.004)
probe = vx.Model.from_mesh(trimesh.creation.capsule(0.04, 0.006), voxel_size=0.0005)

scratch, forces, times, poses = vx.QueryScratch(), [], [], []
for angle in np.linspace(-0.5, 0.5, steps):
    pose = np.eye(4)
    pose[:3, 3] = 0.1 * np.sin(angle), 0.0, 0.1 * np.cos(angle) + 0.0255
    begin = time.perf_counter()
    push = vx.wrench(probe, rough, pose, None, stiffness=2e8, shell="a", scratch=scratch)
    times.append(time.perf_counter() - begin)
    forces.append(push.force)
    poses.append(pose)
forces = np.array(forces)
jumps = np.linalg.norm(np.diff(forces, axis=0), axis=1)
tell(
    options.out,
    {
        "calls": steps,
        "largest_force_N": float(np.linalg.norm(forces, axis=1).max()),
        "largest_change_from_call_to_call_N": float(jumps.max()),
        "median_microseconds": 1e6 * float(np.median(times)),
        "99th_percentile_microseconds": 1e6 * float(np.quantile(times, 0.99)),
    },
)
touching = as_recording(
    [(rough, np.eye(4)), (probe, poses[-steps // 3])], vx.contacts(probe, rough, poses[-steps // 3])
)
draw(options.out / "picture.png", touching, elevation=20, focus=("1",), fill=0.6)
lines = {axis: forces[:, number] for number, axis in enumerate("xyz")}
milliseconds = np.arange(steps)
plot(
    options.out / "plot.png",
    milliseconds,
    lines,
    x_label="time, ms",
    y_label="force on the probe, N",
)
way = poses[:: steps // 100]
replay(options.out / "replay.html", rough, probe, way, seconds=4.0, title="A probe along a wall")
