"""A sweep on many machines: how the clearance of a peg decides how far it tilts.

Each part is a pure function of its settings, run by Dask: on processes of this machine, or with
`--scheduler tcp://HOST:8786` on a cluster. Models are built once on each worker and kept in its cache.
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
    """A tube and a peg in it, both 40 mm high."""
    tube = trimesh.creation.annulus(RADIUS, 0.015, 0.04, sections=192)
    peg = trimesh.creation.cylinder(RADIUS - clearance, 0.04, sections=192)
    return tuple(vx.Model.from_mesh(mesh, voxel_size=0.0005) for mesh in (tube, peg))


def find_tilt(clearance, poses):
    """The largest tilt about its middle, degrees, that a peg of so much clearance has."""
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
        # Dask sends functions of the main program by value, with what they refer to.
        tilts = np.array(client.gather(client.map(find_tilt, clearances, poses=poses)))
    if local:
        local.close()
    # A peg of 40 mm in a bore of 40 mm: its corners, 20 mm away, move by the clearance.
    exact = np.degrees(clearances / 0.02)
    tell(
        options.out,
        {
            "parts": len(clearances),
            "tilts_degrees": [round(tilt, 3) for tilt in tilts.tolist()],
            "of_small_angles_degrees": [round(tilt, 3) for tilt in exact.tolist()],
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
    # To and fro, a tenth of a degree further than the peg of the widest clearance can go.
    swing = np.radians(tilts[-1] + 0.1) * np.sin(np.linspace(0.0, 2.0 * np.pi, 120))
    way = [rotation_matrix(angle, (0, 1, 0)) for angle in swing]
    replay(options.out / "replay.html", tube, peg, way, seconds=4.0, title="How far a peg tilts")
