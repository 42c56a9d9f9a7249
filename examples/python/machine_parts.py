"""Bodies made with manifold3d: threads and gears. Meters; their axis is z, and they begin at z = 0."""

import manifold3d as m3
import numpy as np
import voxshell as vx

PRESSURE_ANGLE = np.radians(20.0)  # of gears


def as_mesh(solid):
    """The surface of a manifold3d.Manifold."""
    mesh = solid.to_mesh64()
    return vx.Mesh(mesh.vert_properties[:, :3], mesh.tri_verts.astype(np.uint32))


def make_thread(radius, depth, pitch, length, *, segments=64, sections=64):
    """A rod with a right-handed trapezoidal thread.

    A cut across it is a polar curve that turns once a pitch. So two threads whose radii differ by c are c apart along
    the radius everywhere.

    Args:
        radius: Outer.
        depth: Of the thread.
        pitch: A turn.
        length: Of the rod.
        segments: Edges of a turn.
        sections: Cuts a pitch.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, segments, endpoint=False)
    wave = np.clip(2.0 * np.abs(angles / np.pi - 1.0) - 0.5, 0.0, 1.0)
    radii = radius - depth * (1.0 - wave)
    cut = m3.CrossSection([np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])])
    turns = length / pitch
    return m3.Manifold.extrude(cut, length, round(sections * turns), 360.0 * turns)


def make_bolt(radius, depth, pitch, length, head):
    """A thread on a hexagonal head below, whose height is ``head``."""
    below = m3.Manifold.cylinder(1.02 * head, 1.7 * radius, circular_segments=6)
    return make_thread(radius, depth, pitch, length) + below.translate((0.0, 0.0, -head))


def make_nut(radius, depth, pitch, height, clearance):
    """The nut of the bolt with the same thread, at whole turns along its screw; ``clearance`` along the radius."""
    hexagon = m3.Manifold.cylinder(height, 1.7 * radius, circular_segments=6)
    # The cutter starts a pitch lower, in the same phase, so that its ends are outside the nut.
    cutter = make_thread(radius + clearance, depth, pitch, height + 2.0 * pitch)
    return hexagon - cutter.translate((0.0, 0.0, -pitch))


def make_gear(teeth, module, width, bore, backlash):
    """A spur gear with involute teeth, one of them along x.

    Two gears whose pitch circles, of radius teeth * module / 2, touch roll without slip where each tooth is half a pitch
    wide; here it is thinner by the backlash.
    """
    pitch_radius = 0.5 * teeth * module
    base_radius = pitch_radius * np.cos(PRESSURE_ANGLE)
    root_radius, outer_radius = pitch_radius - 1.25 * module, pitch_radius + module
    # Half a tooth's angle at the pitch circle, and what the involute adds on the way there.
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
