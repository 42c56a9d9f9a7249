"""Coming from GImpact: the same ring in the same Bullet, with another shape.

This is the scene of the C++ program in `examples/bullet`. It runs once with Bullet's own `btGImpactMeshShape` for the
ring, and once with a model of the ring. Everything else stays the same.
"""

import numpy as np
import trimesh
import voxshell as vx
from command import parse_command, tell
from drawing import draw, plot

RATE, SECONDS = 200.0, 3.0
RING, THICKNESS, BALL = 0.1, 0.03, 0.06  # radii, meters

options = parse_command(__doc__)
sections = {"major_sections": 64, "minor_sections": 24}
mesh = trimesh.creation.torus(RING, THICKNESS, **sections)


def fall(ring):
    """Drops the ring; returns the world, the ring, its heights above the table, and the recorder."""
    world = vx.World(time_step=1 / RATE, sleeping=False)
    table, ball, above = np.eye(4), np.eye(4), np.eye(4)
    table[2, 3], ball[2, 3], above[:3, 3] = -0.1, BALL, (0.01, 0.0, 0.5)
    world.add(vx.Box((0.3, 0.3, 0.1)), mass=0, pose=table, name="table")
    world.add(vx.Sphere(BALL), mass=0, pose=ball, name="ball")
    body = world.add(ring, mass=1.0, pose=above, name="ring")
    recorder, heights = world.record(every=4), []
    world.step(round(SECONDS * RATE), lambda _: heights.append(body.pose[2, 3]))
    return world, body, np.array(heights), recorder


shapes = {
    "GImpact": vx.GImpact(mesh),
    "model": vx.Model.from_mesh(mesh, voxel_size=0.003 if options.quick else 0.001),
}
figures, lines = {"height_at_rest_mm": 1e3 * THICKNESS}, {}
for name, shape in shapes.items():
    world, body, heights, recorder = fall(shape)
    narrow = np.median(world.timings["narrow_phase"][heights < 2 * THICKNESS])
    figures[f"height_of_the_{name}_mm"] = 1e3 * float(heights[-1])
    figures[f"{name}_into_the_table_mm"] = 1e3 * float(THICKNESS - heights.min())
    figures[f"speed_of_the_{name}_at_the_end_mm_s"] = 1e3 * float(
        np.linalg.norm(body.linear_velocity)
    )
    figures[f"narrow_phase_of_the_{name}_us"] = 1e6 * float(narrow)
    lines[name] = 1e3 * heights
tell(options.out, figures)
recording = recorder.recording()
draw(options.out / "picture.png", recording, frames=(-1,), elevation=35.0)
time = np.arange(1, len(heights) + 1) / RATE
shown = (time > 0.28) & (time < 0.8)  # starts shortly before the ring lands
lines = {name: line[shown] for name, line in lines.items()}
plot(
    options.out / "plot.png",
    time[shown],
    lines,
    x_label="time, s",
    y_label="height of the ring, mm",
)
recording.save_html(options.out / "replay.html", title="A ring falls around a ball")
