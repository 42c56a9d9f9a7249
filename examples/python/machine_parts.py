"""Threads and gears, made with manifold3d. Lengths are in meters; each part's axis is z, and it starts at z = 0."""

import manifold3d as m3
import numpy as np
import voxshell as vx

PRESSURE_ANGLE = np.radians(20.0)  # of gears


def as_mesh(solid):
    """Returns the surface of a manifold3d.Manifold as a ``vx.Mesh``."""
    mesh = solid.to_mesh64()
    return vx.Mesh(mesh.vert_properties[:, :3], mesh.tri_verts.astype(np.uint32))


def make_thread(radius, depth, pitch, length, *, segments=64, sections=64):
    """Makes a rod with a right-handed trapezoidal thread.

    Its cross-section is a polar curve that turns once per pitch. Therefore, two threads whose radii differ by c have a
    radial clearance of c everywhere.

    Args:
        radius: Outer radius.
        depth: Depth of the thread.
        pitch: Height of one turn.
        length: Length of the rod.
        segments: Number of edges around the cross-section.
        sections: Number of cross-sections per pitch.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, segments, endpoint=False)
    wave = np.clip(2.0 * np.abs(angles / np.pi - 1.0) - 0.5, 0.0, 1.0)
    radii = radius - depth * (1.0 - wave)
    cut = m3.CrossSection([np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])])
    turns = length / pitch
    return m3.Manifold.extrude(cut, length, round(sections * turns), 360.0 * turns)


def make_bolt(radius, depth, pitch, length, head):
    """Makes a thread above a hexagonal head of height ``head``, which ends at z = 0."""
    below = m3.Manifold.cylinder(1.02 * head, 1.7 * radius, circular_segments=6)
    return make_thread(radius, depth, pitch, length) + below.translate((0.0, 0.0, -head))


def make_nut(radius, depth, pitch, height, clearance):
    """Makes the nut of a bolt with the same thread and a radial ``clearance``; it fits at whole turns of the bolt."""
    hexagon = m3.Manifold.cylinder(height, 1.7 * radius, circular_segments=6)
    # The cutter starts one pitch lower, in the same phase, so that its ends are outside the nut.
    cutter = make_thread(radius + clearance, depth, pitch, height + 2.0 * pitch)
    return hexagon - cutter.translate((0.0, 0.0, -pitch))


def make_gear(teeth, module, width, bore, backlash):
    """Makes a spur gear with involute teeth, one of them along x.

    The pitch circle has the radius teeth * module / 2, and those of two meshed gears touch. There, each tooth is half a
    pitch wide, less the backlash.
    """
    pitch_radius = 0.5 * teeth * module
    base_radius = pitch_radius * np.cos(PRESSURE_ANGLE)
    root_radius, outer_radius = pitch_radius - 1.25 * module, pitch_radius + module
    # Half the angle of a tooth at the pitch circle; ``offset`` adds the involute's angle up to there.
    half = (0.5 * np.pi * module - backlash) / (2.0 * pitch_radius)
    offset = half + np.tan(PRESSURE_ANGLE) - PRESSURE_ANGLE
    radii = np.linspace(max(base_radius, root_radius), outer_radius, 6)
    pressure = np.arccos(np.minimum(base_radius / radii, 1.0))
    flank = offset - (np.tan(pressure) - pressure)
    radii = np.concatenate([[root_radius], radii, radii[::-1], [root_radius]])
    angles = np.concatenate([[-flank[0]], -flank, flank[::-1], [flank[0]]])
    around = angles + 2.0 * np.pi / teeth * np.arange(teeth)[:, None]
    points = np.stack([radii * np.cos(around), radii * np.sin(around)], axis=-1).reshape(-1, 2)
    disc = m3.Manifold.extrude(m3.CrossSection([points]), width)
    hole = m3.Manifold.cylinder(3.0 * width, bore, circular_segments=32)
    return disc - hole.translate((0.0, 0.0, -width))
