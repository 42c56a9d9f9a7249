"""A mug of 90 mm: a cup with a handle, meters, standing along z."""

import manifold3d as m3
import numpy as np

HEIGHT, RADIUS, WALL = 0.09, 0.04, 0.005
GRIP, THICKNESS = 0.026, 0.005  # the handle's ring and the radius of its bar


def make_mug() -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles."""
    cup = m3.Manifold.cylinder(HEIGHT, RADIUS, circular_segments=96)
    cavity = m3.Manifold.cylinder(HEIGHT, RADIUS - WALL, circular_segments=96)
    turn = np.linspace(0.0, 2.0 * np.pi, 32, endpoint=False)
    bar = m3.CrossSection(
        [np.column_stack([GRIP + THICKNESS * np.cos(turn), THICKNESS * np.sin(turn)])]
    )
    ring = bar.revolve(64).rotate((90.0, 0.0, 0.0)).translate((RADIUS, 0.0, 0.5 * HEIGHT))
    mesh = (cup + ring - cavity.translate((0.0, 0.0, WALL))).to_mesh64()
    return np.array(mesh.vert_properties[:, :3]), np.array(mesh.tri_verts, dtype=np.uint32)
