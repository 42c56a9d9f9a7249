"""Coming from pybullet: a ring that falls over a post.

The comments show the calls of pybullet, in the same order. pybullet makes a convex hull of a dynamic mesh. This
closes the ring, which then lies on top of the post. A model of the ring falls over the post to the ground.
"""

import numpy as np
import trimesh
import voxshell as vx
from command import parse_command, tell
from drawing import draw, plot

options = parse_command(__doc__)
mesh = trimesh.creation.torus(0.06, 0.015)
post = vx.Model.from_mesh(trimesh.creation.cylinder(0.03, 0.1), voxel_size=0.002)


def drop(shape):
    """Drops a ring of a shape; returns the world, the ring, its recorder and its height after each step."""
    # p.connect(p.DIRECT); p.setGravity(0, 0, -9.81); p.setTimeStep(1 / 240)
    world = vx.World(gravity=(0, 0, -9.81), time_step=1 / 240)
    # p.createMultiBody(0, p.createCollisionShape(p.GEOM_PLANE))
    world.add(vx.Plane(), mass=0)
    # p.createMultiBody(0, p.createCollisionShape(p.GEOM_CYLINDER, radius=0.03, height=0.1), ...)
    pose = np.eye(4)
    pose[2, 3] = 0.05
    world.add(post, mass=0, pose=pose, name="post")
    # p.createMultiBody(0.2, shape, basePosition=[0.008, 0, 0.25])
    pose = np.eye(4)
    pose[:3, 3] = 0.008, 0.0, 0.25
    ring = world.add(shape, mass=0.2, pose=pose, name="ring")
    recorder = world.record(every=4)
    heights = []
    # for _ in range(480): p.stepSimulation(); p.getBasePositionAndOrientation(ring)
    world.step(480, lambda _: heights.append(ring.pose[2, 3]))
    return world, ring, recorder, np.array(heights)


# shape = p.createCollisionShape(p.GEOM_MESH, fileName="ring.obj")   # dynamic: its convex hull
_, hull, _, hull_heights = drop(vx.ConvexHull(mesh.vertices))
# shape = p.createCollisionShape(p.GEOM_MESH, ..., flags=p.GEOM_FORCE_CONCAVE_TRIMESH)  # static only
model = vx.Model.from_mesh(mesh, voxel_size=0.002)
world, ring, recorder, heights = drop(model)

contacts = world.contacts()  # p.getContactPoints(ring) returns tuples, this a structured array
tell(
    options.out,
    {
        "height_of_the_model_mm": 1e3 * float(ring.pose[2, 3]),
        "height_of_the_hull_mm": 1e3 * float(hull.pose[2, 3]),
        "contacts_at_rest": len(contacts),
        "deepest_mm": 1e3 * float(contacts["depth"].max(initial=0.0)),
    },
)
recording = recorder.recording()
draw(options.out / "picture.png", recording, frames=(-1,), elevation=30)
lines = {"model": 1e3 * heights, "pybullet's convex hull": 1e3 * hull_heights}
plot(options.out / "plot.png", np.arange(480) / 240, lines, x_label="time, s", y_label="height, mm")
recording.save_html(options.out / "replay.html", title="A ring falls over a post")
