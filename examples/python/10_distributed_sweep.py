"""A parameter sweep on many machines: how far a peg tilts at each clearance.

Each task is a pure function of its settings. Dask runs the tasks in processes of this machine or, with
`--scheduler tcp://HOST:8786`, on a cluster. Each worker builds the models once and keeps them in its cache.
"""

import numpy as np
import trimesh
import voxshell as vx
from command import parse_command, tell
from drawing import as_recording, draw, plot
from replaying import replay
from trimesh.transformations import rotation_matrix

RADIUS = 0.01


def build(clearance):
    """Builds the models of a tube and of a peg in it, both 40 mm high; clearance in meters."""
    tube = trimesh.creation.annulus(RADIUS, 0.015, 0.04, sections=192)
    peg = trimesh.creation.cylinder(RADIUS - clearance, 0.04, sections=192)
    return tuple(vx.Model.from_mesh(mesh, voxel_size=0.0005) for mesh in (tube, peg))


def find_tilt(clearance, poses):
    """Finds the largest tilt of the peg about its center at a clearance in meters, in degrees."""
    tube, peg = build(clearance)
    angles = np.linspace(0.0, 4.0, poses)
    tilted = np.array([rotation_matrix(np.radians(angle), (1, 0, 0)) for angle in angles])
    hit = vx.collide_batch(tube, peg, b_poses=tilted, threads=1)
    return float(angles[np.argmax(hit)]) if hit.any() else float(angles[-1])


if __name__ == "__main__":
    from distributed import Client, LocalCluster

    options = parse_command(__doc__, scheduler=None)
    clearances = np.linspace(0.1e-3, 0.5e-3, 5 if options.quick else 33)
    poses = 400 if options.quick else 4000
    local = None if options.scheduler else LocalCluster(n_workers=2, dashboard_address=None)
    with Client(options.scheduler or local) as client:
        # Dask sends functions of the main program by value, together with everything they refer to.
        tilts = np.array(client.gather(client.map(find_tilt, clearances, poses=poses)))
    if local:
        local.close()
    # The corners of the peg are 20 mm above and below its center, and can move by the clearance.
    exact = np.degrees(clearances / 0.02)
    tell(
        options.out,
        {
            "tasks": len(clearances),
            "tilts_degrees": [round(tilt, 3) for tilt in tilts.tolist()],
            "small_angle_tilts_degrees": [round(tilt, 3) for tilt in exact.tolist()],
            "off_by_at_most_degrees": float(np.abs(tilts - exact).max()),
        },
    )
    tube, peg = build(clearances[-1])
    pose = rotation_matrix(np.radians(tilts[-1]), (0, 1, 0))
    found = vx.contacts(tube, peg, b_pose=pose)
    jammed = as_recording([(tube, np.eye(4)), (peg, pose)], found)
    draw(options.out / "picture.png", jammed, cut=("0",), azimuth=35, elevation=30)
    lines = {"found": tilts, "for small angles": exact}
    plot(
        options.out / "plot.png",
        1e3 * clearances,
        lines,
        x_label="clearance, mm",
        y_label="degrees",
    )
    # The peg with the largest clearance swings to both sides, 0.1 degrees farther than it fits.
    swing = np.radians(tilts[-1] + 0.1) * np.sin(np.linspace(0.0, 2.0 * np.pi, 120))
    way = [rotation_matrix(angle, (0, 1, 0)) for angle in swing]
    replay(options.out / "replay.html", tube, peg, way, seconds=4.0, title="How far a peg tilts")
