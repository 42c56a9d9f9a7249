"""A nut on a bolt: a motor turns it down three turns of its thread.

The thread has 0.4 mm of radial clearance. Only contacts guide the nut. It must descend by one pitch per turn, its
contacts must be no deeper than a fraction of the clearance, and it must stay within the clearance of the axis. At a
friction of 0.25, the nut does not turn by itself: the motor drives it.
"""

import numpy as np
import voxshell as vx
from command import parse_command, tell
from drawing import draw, plot
from machine_parts import as_mesh, make_bolt, make_nut
from trimesh.transformations import rotation_matrix

TURNS, SPEED, TORQUE = 3.0, 2.0, 0.01  # turns, turns/s, N m at most
RATE, MASS = 1000.0, 0.05
RADIUS, DEPTH, PITCH, CLEARANCE = 0.010, 0.0015, 0.006, 0.0004  # of the thread, meters
HEAD, LENGTH, HEIGHT = 0.006, 0.048, 0.009  # heights of the bolt's head, its thread and the nut


def measure_turns(pose):
    """Returns the angle of a pose about z, in turns from -0.5 to 0.5."""
    return np.arctan2(pose[1, 0], pose[0, 0]) / (2.0 * np.pi)


options = parse_command(__doc__)
thread = RADIUS, DEPTH, PITCH
solids = make_bolt(*thread, LENGTH, HEAD), make_nut(*thread, HEIGHT, CLEARANCE)
voxel = 0.0004 if options.quick else 0.0002
bolt, nut_model = (
    vx.Model.from_mesh(as_mesh(solid), voxel_size=voxel, point_spacing=2.0 * voxel)
    for solid in solids
)
start = rotation_matrix(2.0 * np.pi * 5.3, (0, 0, 1))  # 5.3 turns up the thread
start[2, 3] = 5.3 * PITCH - CLEARANCE  # on the lower flanks, which slope by 45 degrees
world = vx.World(time_step=1 / RATE, sleeping=False)
world.add(bolt, mass=0, friction=0.5, name="bolt")
nut = world.add(nut_model, mass=MASS, pose=start, friction=0.5, name="nut")
recorder = world.record(every=16)
inertia = nut_model.mass_properties(MASS).inertia[2, 2]
turned, before, rows = 0.0, measure_turns(start), []


def drive(world):
    """Applies the motor's torque, at most TORQUE, and records the state after each step."""
    global turned, before
    missing = -2.0 * np.pi * SPEED - nut.angular_velocity[2]
    nut.apply_torque((0.0, 0.0, np.clip(missing * inertia * RATE, -TORQUE, TORQUE)))
    change = measure_turns(nut.pose) - before
    turned += round(change) - change
    before += change
    down = start[2, 3] - nut.pose[2, 3]
    deepest = world.contacts()["depth"].max(initial=0.0)
    rows.append((turned, down, np.hypot(*nut.pose[:2, 3]), deepest))


while turned < TURNS and len(rows) < 3 * RATE * TURNS / SPEED:
    world.step(1, drive)
turns, down, sideways, depths = np.array(rows).T
gap = vx.distance(bolt, nut_model, None, nut.pose, shell="both").distance
tell(
    options.out,
    {
        "turns": float(turns[-1]),
        "seconds": len(rows) / RATE,
        "down_mm": 1e3 * float(down[-1]),
        "down_per_turn_mm": 1e3 * float(down[-1] / turns[-1]),
        "pitch_mm": 1e3 * PITCH,
        "off_the_helix_at_most_mm": 1e3 * float(np.abs(down - PITCH * turns).max()),
        "off_the_axis_at_most_mm": 1e3 * float(sideways.max()),
        "clearance_mm": 1e3 * CLEARANCE,
        "deepest_contact_mm": 1e3 * float(depths.max()),
        "distance_at_the_end_mm": 1e3 * gap,
    },
)
recording = recorder.recording()
draw(options.out / "picture.png", recording, frame=30, cut=("nut",), azimuth=35)
lines = {"measured": 1e3 * down, "one pitch per turn": 1e3 * PITCH * turns}
plot(options.out / "plot.png", turns, lines, x_label="turns", y_label="descent, mm")
recording.save_html(options.out / "replay.html", title="A nut runs down its bolt")
