"""A peg in a hole: 0.1 mm decides.

A block has a hole of 20 mm with a guide above it. Three pegs fall by 2 mm toward the hole, 0.14 mm beside its axis and
tilted by 0.3 degrees. Two have radii 0.1 and 0.05 mm smaller than the hole's and enter. The third is 0.1 mm larger and
stops. The voxels of 0.25 mm are larger than the clearance, but on these smooth walls the field is off by only 0.5 µm.
"""

import numpy as np
import voxshell as vx
from command import parse_command, tell
from drawing import as_recording, draw, plot
from machine_parts import as_mesh, m3
from trimesh.transformations import rotation_matrix

RADIUS, DEPTH, CHAMFER, SEGMENTS = 0.01, 0.02, 0.001, 192
RATE, SECONDS = 500.0, 1.0


def cylinder(height, low, high=None, at=0.0):
    """Makes a cylinder, or a cone from radius ``low`` to ``high``; its lower end is at the height ``at``."""
    return m3.Manifold.cylinder(height, low, high or low, SEGMENTS).translate((0, 0, at))


def make_peg(radius):
    """Makes a peg from z = 0 to 30 mm, with a chamfer at its lower end."""
    tip = cylinder(CHAMFER, radius - CHAMFER, radius)
    return tip + cylinder(0.03 - CHAMFER, radius, at=CHAMFER)


options = parse_command(__doc__)
voxel = 0.0004 if options.quick else 0.00025
block = m3.Manifold.cube((0.04, 0.04, 0.025), center=True).translate((0, 0, -0.0125))
block -= cylinder(DEPTH, RADIUS, at=-DEPTH)
block -= cylinder(0.0005, RADIUS, RADIUS + 0.0005, at=-0.0005)
block += cylinder(0.015, 0.016, at=0.005) - cylinder(0.05, RADIUS + 0.0003)
fixed = vx.Model.from_mesh(as_mesh(block), voxel_size=voxel)

figures, lines, bodies = {}, {}, []
for name, difference in {"loose": -0.1e-3, "close": -0.05e-3, "thick": 0.1e-3}.items():
    peg = vx.Model.from_mesh(as_mesh(make_peg(RADIUS + difference)), voxel_size=voxel)
    world = vx.World(time_step=1 / RATE, sleeping=False)
    world.add(fixed, mass=0, friction=0.2, name="block")
    pose = rotation_matrix(np.radians(0.3), (1.0, 0.3, 0.0))
    pose[:3, 3] = 0.0001, 0.0001, 0.002
    body = world.add(peg, mass=0.2, pose=pose, friction=0.2, name=f"{name} peg")
    recorder = world.record(every=4)
    down = []
    world.step(round(SECONDS * RATE), lambda _, body=body, down=down: down.append(-body.pose[2, 3]))
    figures[f"{name}_peg_down_mm"] = 1e3 * float(down[-1])
    figures[f"{name}_peg_overlap_at_the_end_mm"] = 1e3 * max(
        -vx.distance(fixed, peg, None, body.pose, shell="both").distance, 0.0
    )
    lines[f"{1e3 * (RADIUS + difference):.2f} mm"] = 1e3 * np.array(down)
    bodies.append((peg, body.pose))
    recorder.save_html(
        options.out / f"{name}.html", title=f"A peg of {1e3 * (RADIUS + difference):g} mm"
    )
(options.out / "close.html").rename(options.out / "replay.html")
tell(options.out, figures)
half = as_mesh(block.trim_by_plane((0.0, 1.0, 0.0), 0.0))
apart = [np.eye(4), np.eye(4)]
apart[1][0, 3] = 0.05
pairs = [
    (shape, side @ pose, color)
    for side, (peg, peg_pose) in zip(apart, (bodies[1], bodies[2]), strict=True)
    for shape, pose, color in ((half, np.eye(4), (176, 182, 190)), (peg, peg_pose, (92, 141, 208)))
]
stopped = vx.contacts(fixed, bodies[2][0], apart[1], apart[1] @ bodies[2][1], shell="both")
labels = {
    "radius 9.95 mm: enters": (0.0, -0.006, -0.02),
    "radius 10.1 mm: stops": (0.05, -0.01, 0.0),
}
view = {"azimuth": 12, "elevation": 12, "labels": labels}
draw(options.out / "picture.png", as_recording(pairs, stopped), **view)
time = np.arange(len(down)) / RATE
plot(options.out / "plot.png", time, lines, x_label="time, s", y_label="depth in the hole, mm")
