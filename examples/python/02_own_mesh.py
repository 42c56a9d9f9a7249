"""A mesh of your own: inspect its model.

`--mesh part.stl --scale 0.001` reads a file in millimeters. Without it, the program writes a part that has a dent
and, like many scanned meshes, a hole in its surface. It prints what you should check before you use a model.
"""

import warnings

import numpy as np
import trimesh
import voxshell as vx
from command import parse_command, tell
from drawing import draw, plt

options = parse_command(__doc__, mesh=None, scale=0.001)
path, labels = options.mesh, {}
if path is None:
    path = options.out / "part.stl"
    part = trimesh.creation.icosphere(4, radius=50.0)  # millimeters
    part.vertices[:, 2] -= (
        40.0
        * np.exp(-((part.vertices[:, :2] / 20.0) ** 2).sum(axis=1))
        * (part.vertices[:, 2] > 0.0)
    )
    gone = np.argmax(part.triangles_center @ (0.6, -0.75, 0.3))
    labels["one triangle is missing; the model closes the hole"] = part.triangles_center[gone] / 1e3
    part.update_faces(np.arange(len(part.faces)) != gone)
    part.export(path)

with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    model = vx.Model.from_mesh(
        path, scale=float(options.scale), resolution=60 if options.quick else 200
    )
for warning in caught:
    print("warning:", warning.message)
bounds = vx.contact_bounds(model, model)
tell(
    options.out,
    {
        "size_mm": [round(1e3 * float(side), 2) for side in np.ptp(model.bounds, axis=0)],
        "center_of_mass_mm": [
            round(1e3 * x, 2) for x in model.mass_properties().center_of_mass.tolist()
        ],
        "points": len(model.shell),
        "voxel_size_mm": 1e3 * model.field.voxel_size,
        "field_MB": model.field.nbytes / 1e6,
        "sign_method": model.field.sign_method,
        "sign_confidence": model.field.sign_confidence,
        "overlap_that_is_always_found_mm": 1e3 * bounds.overlap,
    },
)
model.save(options.out / "part.vxs")
shown = [(model, np.eye(4), (92, 141, 208))]
draw(options.out / "picture.png", shown, elevation=40, labels=labels)

low, high = model.bounds
x, z = np.linspace(1.3 * low[0], 1.3 * high[0], 300), np.linspace(1.3 * low[2], 1.3 * high[2], 300)
places = np.stack(np.meshgrid(x, [model.bounds[:, 1].mean()], z, indexing="ij"), axis=-1)
distances = 1e3 * model.field.sample(places.reshape(-1, 3)).reshape(300, 300).T
figure, axes = plt.subplots(figsize=(6, 5), layout="constrained")
shades = axes.contourf(1e3 * x, 1e3 * z, distances, 24, cmap="RdBu_r")
axes.contour(1e3 * x, 1e3 * z, distances, [0.0], colors="black")
axes.set(aspect="equal", xlabel="x, mm", ylabel="z, mm")
figure.colorbar(shades, label="signed distance, mm")
figure.savefig(options.out / "plot.png", dpi=110, bbox_inches="tight")

world = vx.World()
world.add(vx.Plane(), mass=0, name="ground")
pose = trimesh.transformations.rotation_matrix(0.5, (1, 0.3, 0))
pose[2, 3] = 1.5 * np.linalg.norm(high - low)
world.add(model, mass=1.0, pose=pose, name="part")
recorder = world.record(every=2)
world.step(400)
recorder.save_html(options.out / "replay.html", title="The part falls")
