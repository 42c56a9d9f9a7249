"""Quick start: where two rings touch.

Two rings are linked: one hangs in the other. The program builds their model once and queries it in several poses:
whether the rings touch, where, how deep, and how far apart they are.
"""

import numpy as np
import trimesh
import voxshell as vx
from command import parse_command, tell
from drawing import as_recording, draw, plot

options = parse_command(__doc__)
ring = vx.Model.from_mesh(trimesh.creation.torus(0.04, 0.01), voxel_size=0.001)


def hang(drop):
    """The pose of the upright ring, which passes through the flat one; drop: from center to center, meters."""
    pose = trimesh.transformations.rotation_matrix(np.pi / 2, (1, 0, 0))
    pose[:3, 3] = 0.04, 0.0, -drop
    return pose


# The rings are 20 mm thick. They touch once the upright ring has dropped by 20 mm.
drop = 0.0202
contacts = vx.contacts(ring, ring, b_pose=hang(drop))
four = contacts.manifold(4)
drops = np.linspace(0.0, 0.025, 26)
nearest = [vx.distance(ring, ring, b_pose=hang(d)).distance for d in drops]

tell(
    options.out,
    {
        "points_of_each_ring": len(ring.shell),
        "contacts": len(contacts),
        "deepest_mm": 1e3 * float(contacts.depths.max()),
        "points_for_a_solver": len(four),
        "they_touch": vx.collide(ring, ring, b_pose=hang(drop)),
    },
)
touching = as_recording([(ring, np.eye(4)), (ring, hang(drop))], contacts)
draw(options.out / "picture.png", touching, azimuth=60, elevation=25, floor=0.15)
plot(
    options.out / "plot.png",
    1e3 * drops,
    {"nearest distance": 1e3 * np.array(nearest)},
    x_label="lowered by, mm",
    y_label="distance, mm (negative: overlap)",
)

world = vx.World()  # with gravity, the upright ring falls until it hangs in the flat one
world.add(ring, mass=0, name="flat ring")
world.add(ring, mass=0.1, pose=hang(0.0), name="hanging ring")
recorder = world.record(every=2)
world.step(300)
recorder.save_html(options.out / "replay.html", title="A ring falls into another")
