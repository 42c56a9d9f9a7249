"""Pouring bunnies: many bodies of one model fall into a bowl.

Models are immutable, so all bunnies share one. The bowl has its own. Bunnies and bowl are concave, and none of them is
split into convex parts. `--mesh` takes any other file.
"""

import numpy as np
import trimesh
import voxshell as vx
from command import parse_command, tell
from drawing import draw, plot
from machine_parts import as_mesh, m3

BUNNY = "/usr/share/glmark2/models/bunny.obj"  # Debian: glmark2-data
RATE, EACH = 200.0, 0.15  # Hz; seconds for each bunny

options = parse_command(__doc__, mesh=BUNNY, count=None)
count = int(options.count or (8 if options.quick else 24))
mesh = trimesh.load_mesh(options.mesh)
mesh.apply_translation(-mesh.bounds.mean(axis=0))
mesh.apply_scale(0.08 / mesh.extents.max())
mesh.merge_vertices()
# Fewer triangles make the pictures faster to draw; the simulation does not need this.
solid = m3.Manifold(m3.Mesh64(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.uint64)))
bunny = vx.Model.from_mesh(
    as_mesh(solid.simplify(4e-4 if options.quick else 1e-4)), voxel_size=0.001, target_points=2000
)
angles = np.linspace(0.0, np.pi / 2, 16)  # the bowl's profile: outside up to the rim, then inside
outer = 0.16 * np.column_stack([np.sin(angles), -np.cos(angles)])
profile = np.concatenate([outer, outer[::-1] * 0.94])
bowl = vx.Model.from_mesh(trimesh.creation.revolve(profile, sections=96), voxel_size=0.003)

world = vx.World(time_step=1 / RATE)
world.add(bowl, mass=0, friction=0.6, name="bowl")
rng = np.random.default_rng(4)
poses = [trimesh.transformations.random_rotation_matrix(rng.random(3)) for _ in range(count)]
for number, pose in enumerate(poses):
    layer, turn = number // 3, 2.0 * np.pi * (number % 3) / 3.0 + 0.5 * (number // 3)
    pose[:3, 3] = 0.055 * np.cos(turn), 0.055 * np.sin(turn), 0.06 + 0.11 * layer
    world.add(bunny, mass=0.1, pose=pose, friction=0.6, name=f"bunny {number + 1}")
recorder = world.record(every=8)
energy, contacts = [], []


def note(world):
    """Records the kinetic energy in joules, without spin, and the number of Bullet's contact points."""
    speeds = np.array([body.linear_velocity for body in world.bodies[1:]])
    energy.append(0.5 * 0.1 * float((speeds**2).sum()))
    contacts.append(len(world.contacts()))


steps = round(RATE * (2.0 + EACH * count))
world.step(steps, note)
places = np.array([body.pose[:3, 3] for body in world.bodies[1:]])
step_ms = 1e3 * float(np.median(world.timings["step"]))
tell(
    options.out,
    {
        "bunnies": count,
        "in_the_bowl": int(np.sum((np.hypot(*places[:, :2].T) < 0.16) & (places[:, 2] > -0.16))),
        "energy_at_the_end_mJ": 1e3 * energy[-1],
        "contacts_at_the_end": contacts[-1],
        "milliseconds_per_step": step_ms,
        "fraction_of_real_time": step_ms * RATE / 1e3,
    },
)
recording = recorder.recording()
draw(options.out / "picture.png", recording, frames=(-1,), elevation=50, fill=0.9)
lines = {"kinetic energy, mJ": 1e3 * np.array(energy), "contact points": np.array(contacts)}
plot(options.out / "plot.png", np.arange(1, steps + 1) / RATE, lines, x_label="time, s", y_label="")
recording.save_html(options.out / "replay.html", title="Pouring bunnies", max_contacts=100)
