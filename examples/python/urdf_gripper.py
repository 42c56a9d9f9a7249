"""A robot from a URDF file takes a mug by its wall, one finger inside, and carries it aside.

python examples/python/urdf_gripper.py --out DIR writes the robot and its meshes, and replay.html.
It needs voxshell[urdf,viewer] and manifold3d.
"""

import argparse
from pathlib import Path

import numpy as np
import trimesh
import voxshell as vx
from trimesh.creation import box, cylinder, torus
from trimesh.transformations import rotation_matrix

TURN = 0.6  # radians from the robot's x axis to the mug
WALL = 0.037  # metres from the mug's axis to the middle of its wall, 6 mm thick
LINKS = {  # name: (mesh in its link's frame, metres)
    "column": cylinder(0.05, 0.36).apply_translation((0, 0, 0.18)),
    "boom": box(bounds=[(-0.05, -0.025, -0.02), (0.36, 0.025, 0.02)]),
    "wrist": box(bounds=[(-0.06, -0.03, -0.02), (0.06, 0.03, 0.02)]),
    "outer": box(bounds=[(-0.006, -0.015, -0.08), (0.006, 0.015, 0)]),
    "inner": box(bounds=[(-0.006, -0.015, -0.08), (0.006, 0.015, 0)]),
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
    """The URDF file and its meshes; masses are those of the meshes at 1000 kg/m3."""
    links = ""
    for name, mesh in LINKS.items():
        mesh.export(folder / f"{name}.stl")
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = 1000.0 * mesh.moment_inertia
        links += f"""
  <link name="{name}">
    <inertial><origin xyz="{" ".join(map(str, mesh.center_mass))}"/><mass value="{1000 * mesh.volume}"/>
      <inertia ixx="{xx}" ixy="{xy}" ixz="{xz}" iyy="{yy}" iyz="{yz}" izz="{zz}"/></inertial>
    <collision><geometry><mesh filename="{name}.stl"/></geometry></collision></link>"""
    path = folder / "gripper.urdf"
    path.write_text(f'<robot name="gripper">{links}{JOINTS}\n</robot>\n')
    return path


def make_mug() -> trimesh.Trimesh:
    """90 mm high, standing on its origin, with a handle towards +y."""
    outside = cylinder(0.04, 0.09, sections=64).apply_translation((0, 0, 0.045))
    inside = cylinder(0.034, 0.09, sections=64).apply_translation((0, 0, 0.051))
    handle = torus(0.025, 0.005).apply_transform(rotation_matrix(np.pi / 2, (0, 1, 0)))
    handle.apply_translation((0, 0.045, 0.045))
    return trimesh.boolean.difference([trimesh.boolean.union([outside, handle]), inside])


def build(folder: Path) -> tuple[vx.World, vx.Robot, vx.Body]:
    """The robot, and the mug on the ground in front of it."""
    world = vx.World(time_step=1 / 1000)  # light links and firm grips want short steps
    world.add(vx.Plane(), mass=0, name="ground")
    robot = vx.load_urdf(world, write_robot(folder), voxel_size=0.002, friction=0.9)
    pose = rotation_matrix(TURN, (0, 0, 1))
    pose[:3, 3] = pose[:3, :3] @ (0.263 + WALL, 0, 0.0002)
    mug = vx.Model.from_mesh(make_mug(), voxel_size=0.002)
    return world, robot, world.add(mug, mass=0.25, pose=pose, friction=0.9, name="mug")


def take(world: vx.World, robot: vx.Robot, *, close: float = 0.024) -> None:
    """Turns to the mug, takes it, lifts it and holds it for a second."""
    for seconds, targets in (
        (1.5, {"turn": TURN, "lift": 0.0, "grip": 0.0}),
        (1.0, {"lift": -0.2}),
        (0.8, {"grip": close}),
        (1.5, {"lift": -0.05}),
    ):
        robot.set_targets(targets)
        world.step(round(seconds / world.time_step))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True)
    out = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    world, robot, _ = build(out)
    recorder = world.record(every=20)
    take(world, robot)
    for targets in ({"turn": -TURN}, {"lift": -0.19}, {"grip": 0.0}):
        robot.set_targets(targets)
        world.step(1800)
    print(recorder.save_html(out / "replay.html", title="A gripper and a mug"))
