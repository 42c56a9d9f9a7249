"""Gears: 12 teeth drive 24 through contacts alone.

The teeth are involutes of module 2 mm with 0.2 mm of backlash. The radius of each bore is 0.1 mm larger than that
of its pin. A motor of at most 0.05 N m turns the small gear. The large gear follows at half the speed, for one turn.
"""

import numpy as np
import voxshell as vx
from command import parse_command, tell
from drawing import draw, plot
from machine_parts import as_mesh, m3, make_gear
from trimesh.transformations import rotation_matrix

MODULE, TEETH, WIDTH, BORE = 0.002, (12, 24), 0.008, 0.004
SPEED, TORQUE, RATE, MASSES = 1.0, 0.05, 500.0, (0.05, 0.2)  # turns/s, N m, Hz, kg
AXES = 0.5 * MODULE * sum(TEETH)  # distance of the pins, meters

options = parse_command(__doc__)
voxel = 0.0004 if options.quick else 0.0002
plate = m3.Manifold.cube((0.12, 0.07, 0.004), center=True).translate((0.018, 0, -0.002))
for x in (0.0, AXES):
    plate += m3.Manifold.cylinder(0.011, BORE - 0.0001, circular_segments=96).translate(
        (x, 0, -0.001)
    )
gears = [
    vx.Model.from_mesh(as_mesh(make_gear(teeth, MODULE, WIDTH, BORE, 0.0002)), voxel_size=voxel)
    for teeth in TEETH
]
ground = vx.Model.from_mesh(as_mesh(plate), voxel_size=voxel)
world = vx.World(time_step=1 / RATE, sleeping=False)
world.add(ground, mass=0, friction=0.1, name="pins")
meshed = rotation_matrix(np.pi / TEETH[1], (0, 0, 1))  # a gap faces a tooth of the small gear
meshed[0, 3] = AXES
poses = (np.eye(4), meshed)
small, large = (
    world.add(model, mass=mass, pose=pose, friction=0.1, name=f"{teeth} teeth")
    for model, mass, pose, teeth in zip(gears, MASSES, poses, TEETH, strict=True)
)
recorder = world.record(every=8)
inertia = gears[0].mass_properties(MASSES[0]).inertia[2, 2]
turns, angles, rows = np.zeros(2), np.array([0.0, np.pi / TEETH[1]]), []


def drive(world):
    """Applies the motor's torque, and records how far each gear has turned, in turns."""
    global angles
    missing = 2.0 * np.pi * SPEED - small.angular_velocity[2]
    small.apply_torque((0.0, 0.0, np.clip(missing * inertia * RATE, -TORQUE, TORQUE)))
    now = np.array([np.arctan2(body.pose[1, 0], body.pose[0, 0]) for body in (small, large)])
    change = (now - angles) / (2.0 * np.pi)
    turns[:] += change - np.round(change)
    angles = now
    rows.append((*turns, world.contacts()["depth"].max(initial=0.0)))


while turns[1] > -1.0 and len(rows) < 4 * RATE * TEETH[1] / TEETH[0] / SPEED:
    world.step(1, drive)
first, second, depths = np.array(rows).T
tell(
    options.out,
    {
        "turns_of_the_small_gear": float(first[-1]),
        "turns_of_the_large_gear": float(second[-1]),
        "ratio": float(-first[-1] / second[-1]),
        "ratio_of_teeth": TEETH[1] / TEETH[0],
        "deepest_contact_mm": 1e3 * float(depths.max()),
        "seconds": len(rows) / RATE,
    },
)
recording = recorder.recording()
draw(options.out / "picture.png", recording, frame=20, azimuth=15, elevation=48)
off = 360.0 * (-second - first * TEETH[0] / TEETH[1])
time = np.arange(1, len(rows) + 1) / RATE
labels = {"x_label": "time, s", "y_label": "large gear ahead, degrees"}
plot(options.out / "plot.png", time, {"lag": off}, **labels)
recording.save_html(options.out / "replay.html", title="12 teeth drive 24")
