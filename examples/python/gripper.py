"""A robot arm with two fingers, as a URDF file with its meshes, and a mug."""

from pathlib import Path

import numpy as np
import trimesh
from trimesh.creation import box, cylinder, revolve, torus
from trimesh.transformations import rotation_matrix

WALL = 0.037  # meters from the mug's axis to the middle of its wall, which is 6 mm thick


def block(x, y, z):
    """Makes a box from its two bounds along each axis, in meters."""
    return box(bounds=np.transpose((x, y, z)))


def rod(radius, low, high, x=0.0):
    """Makes an upright cylinder between two heights."""
    return cylinder(radius, high - low, sections=48).apply_translation((x, 0, 0.5 * (low + high)))


COLUMN = (
    (0, 0),
    (0.09, 0),
    (0.09, 0.012),
    (0.05, 0.03),
    (0.04, 0.33),
    (0.055, 0.345),
    (0.055, 0.36),
)
BEAM = block((0, 0.263), (-0.022, 0.022), (-0.016, 0.016))
FINGER, KNUCKLE = block((-0.006, 0.006), (-0.015, 0.015), (-0.08, 0)), ((-0.02, 0.02), (-0.016, 0))
LINKS = {  # name: (meshes in its link's frame, meters; color)
    "column": ([revolve((*COLUMN, (0, 0.36)), sections=64)], "0.35 0.39 0.45 1"),
    "boom": ([rod(0.055, -0.02, 0.03), BEAM, rod(0.032, -0.026, 0.026, 0.263)], "0.90 0.91 0.92 1"),
    "wrist": (
        [
            block((-0.06, 0.06), (-0.026, 0.026), (-0.02, 0.01)),
            rod(0.03, 0.01, 0.02),
            rod(0.013, 0.02, 0.3),
        ],
        "0.36 0.55 0.81 1",
    ),
    "outer": ([FINGER, block((-0.018, 0.006), *KNUCKLE)], "0.27 0.31 0.37 1"),
    "inner": ([FINGER, block((-0.006, 0.018), *KNUCKLE)], "0.27 0.31 0.37 1"),
}
JOINTS = """
  <joint name="turn" type="revolute"><parent link="column"/><child link="boom"/>
    <origin xyz="0 0 0.38"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="50" velocity="1"/><dynamics damping="0.1"/></joint>
  <joint name="lift" type="prismatic"><parent link="boom"/><child link="wrist"/>
    <origin xyz="0.263 0 -0.05"/><axis xyz="0 0 1"/>
    <limit lower="-0.3" upper="0" effort="200" velocity="0.3"/></joint>
  <joint name="grip" type="prismatic"><parent link="wrist"/><child link="outer"/>
    <origin xyz="-0.03 0 -0.02"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.024" effort="20" velocity="0.05"/></joint>
  <joint name="follower" type="prismatic"><parent link="wrist"/><child link="inner"/>
    <origin xyz="0.03 0 -0.02"/><axis xyz="-1 0 0"/><mimic joint="grip"/>
    <limit lower="0" upper="0.024" effort="20" velocity="0.05"/></joint>"""


def write_robot(folder: Path) -> Path:
    """Writes the URDF file and its meshes, with their masses at 1000 kg/m3."""
    links = ""
    for name, (parts, color) in LINKS.items():
        mesh = trimesh.boolean.union(parts)
        mesh.export(folder / f"{name}.stl")
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = 1000.0 * mesh.moment_inertia
        links += f"""
  <link name="{name}">
    <inertial><origin xyz="{" ".join(map(str, mesh.center_mass))}"/><mass value="{1000 * mesh.volume}"/>
      <inertia ixx="{xx}" ixy="{xy}" ixz="{xz}" iyy="{yy}" iyz="{yz}" izz="{zz}"/></inertial>
    <visual><geometry><mesh filename="{name}.stl"/></geometry>
      <material name="{name}"><color rgba="{color}"/></material></visual>
    <collision><geometry><mesh filename="{name}.stl"/></geometry></collision></link>"""
    path = folder / "gripper.urdf"
    path.write_text(f'<robot name="gripper">{links}{JOINTS}\n</robot>\n')
    return path


def make_mug() -> trimesh.Trimesh:
    """Makes a mug 90 mm high that stands on its origin, with a handle toward +y."""
    outside = cylinder(0.04, 0.09, sections=64).apply_translation((0, 0, 0.045))
    inside = cylinder(0.034, 0.09, sections=64).apply_translation((0, 0, 0.051))
    handle = torus(0.025, 0.005).apply_transform(rotation_matrix(np.pi / 2, (0, 1, 0)))
    handle.apply_translation((0, 0.045, 0.045))
    return trimesh.boolean.difference([trimesh.boolean.union([outside, handle]), inside])
