"""Closed bodies with known shapes, made with manifold3d. Millimetres are written as 1e-3."""

from __future__ import annotations

from pathlib import Path

import manifold3d as m3
import numpy as np
import trimesh

DEGREES_A_TURN = 360.0


def as_arrays(solid: m3.Manifold) -> tuple[np.ndarray, np.ndarray]:
    """Vertices, (n, 3) float64, and triangles, (m, 3), for voxshell and coal."""
    mesh = solid.to_mesh64()
    return np.array(mesh.vert_properties[:, :3]), np.array(mesh.tri_verts, dtype=np.uint32)


def simplified_bunny(path: Path, length: float, tolerance: float) -> m3.Manifold:
    """The Stanford bunny, `length` along its longest side, about the centre of its bounds."""
    mesh = trimesh.load_mesh(path, process=False)
    mesh.merge_vertices()
    mesh.apply_translation(-mesh.bounds.mean(axis=0))
    mesh.apply_scale(length / mesh.extents.max())
    solid = m3.Manifold(
        m3.Mesh64(
            np.asarray(mesh.vertices, dtype=np.float64), np.asarray(mesh.faces, dtype=np.uint64)
        )
    )
    assert solid.status() == m3.Error.NoError
    return solid.simplify(tolerance)


def box(extents: tuple[float, float, float]) -> m3.Manifold:
    return m3.Manifold.cube(extents, center=True)


def ball(radius: float, segments: int = 48) -> m3.Manifold:
    return m3.Manifold.sphere(radius, segments)


def threaded_rod(
    radius: float, thread_depth: float, pitch: float, length: float, segments: int = 32
) -> m3.Manifold:
    """A right-handed trapezoidal thread about z from z = 0; `radius` is the outer one.

    A cut across a one-start thread is a polar curve that turns once a pitch. Two rods of equal
    pitch, segments and thread depth whose radii differ by c are c apart along the radius
    everywhere: each cut is the other one's moved out by c.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, segments, endpoint=False)
    wave = np.clip(2.0 * np.abs(angles / np.pi - 1.0) - 0.5, 0.0, 1.0)
    radii = radius - thread_depth * (1.0 - wave)
    section = m3.CrossSection([np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])])
    turns = length / pitch
    return m3.Manifold.extrude(
        section, length, n_divisions=round(12 * turns), twist_degrees=DEGREES_A_TURN * turns
    )


def bolt(
    radius: float, thread_depth: float, pitch: float, length: float, head_height: float
) -> m3.Manifold:
    """A thread from z = 0 up, on a hexagonal head below."""
    head = m3.Manifold.cylinder(1.02 * head_height, 1.7 * radius, circular_segments=6).translate(
        (0.0, 0.0, -head_height)
    )
    return threaded_rod(radius, thread_depth, pitch, length) + head


def nut(
    radius: float, thread_depth: float, pitch: float, height: float, clearance: float
) -> m3.Manifold:
    """Of the bolt with the same numbers, `clearance` from its thread along the radius.

    From z = 0 up; it fits a bolt in the same pose, and at whole turns along its screw.
    """
    hexagon = m3.Manifold.cylinder(height, 1.7 * radius, circular_segments=6)
    # The cutter starts a pitch lower, in the same phase, so that its ends are outside the nut.
    cutter = threaded_rod(radius + clearance, thread_depth, pitch, height + 2.0 * pitch)
    return hexagon - cutter.translate((0.0, 0.0, -pitch))


def gear(
    teeth: int, module: float, width: float, bore: float, backlash: float = 0.0
) -> m3.Manifold:
    """A spur gear about z with involute flanks (pressure angle 20 degrees), a tooth along x.

    Its pitch radius is teeth * module / 2. Teeth are thinner by `backlash` along the pitch circle.
    """
    pressure = np.radians(20.0)
    pitch_radius = 0.5 * teeth * module
    base_radius = pitch_radius * np.cos(pressure)
    root_radius, outer_radius = pitch_radius - 1.25 * module, pitch_radius + module
    # Half a tooth's angle at the pitch circle, and what the involute adds on the way there.
    half = (0.5 * np.pi * module - backlash) / (2.0 * pitch_radius)
    offset = half + np.tan(pressure) - pressure
    radii = np.linspace(max(base_radius, root_radius), outer_radius, 6)
    flank_pressure = np.arccos(np.minimum(base_radius / radii, 1.0))
    flank = offset - (np.tan(flank_pressure) - flank_pressure)
    points = []
    for tooth in range(teeth):
        middle = 2.0 * np.pi * tooth / teeth
        profile = [
            (root_radius, -flank[0]),
            *zip(radii, -flank, strict=True),
            *zip(radii[::-1], flank[::-1], strict=True),
            (root_radius, flank[0]),
        ]
        points += [
            (radius * np.cos(middle + angle), radius * np.sin(middle + angle))
            for radius, angle in profile
        ]
    disc = m3.Manifold.extrude(m3.CrossSection([np.array(points)]), width)
    hole = m3.Manifold.cylinder(3.0 * width, bore, circular_segments=32)
    return disc - hole.translate((0.0, 0.0, -width))
