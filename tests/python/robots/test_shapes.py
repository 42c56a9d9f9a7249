from __future__ import annotations

import warnings

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.model.meshes import read_mesh
from voxshell.robots.description import (
    Collision,
    LinkDescription,
    MeshArrays,
    Primitive,
    RobotDescription,
)
from voxshell.robots.lumps import find_lumps
from voxshell.robots.shapes import MeshSettings, Shaper


def shape_of(*collisions: Collision, **settings):
    link = LinkDescription("a", "robot.xml:7", collisions, None, None)
    robot = RobotDescription("robot.xml", "robot", {"a": np.eye(4)}, {"a": link})
    options = MeshSettings(**{"voxel_size": None, "resolution": 20, "mesh_as": "model", **settings})
    return Shaper(robot, options).shape_of(find_lumps(robot)["a"])


def solid(kind, *sizes, z=0.0):
    return Collision(Primitive(kind, sizes), vx.pose((0, 0, z)))


def test_one_primitive_in_its_place_is_itself_and_others_are_a_compound():
    assert shape_of() is None
    assert isinstance(shape_of(solid("box", 1, 2, 3)), vx.Box)
    assert isinstance(shape_of(solid("sphere", 1)), vx.Sphere)
    assert isinstance(shape_of(solid("cylinder", 1, 2)), vx.Cylinder)
    assert isinstance(shape_of(solid("capsule", 1, 2)), vx.Capsule)
    assert isinstance(shape_of(solid("plane")), vx.Plane)
    moved = shape_of(solid("box", 1, 2, 3, z=1))
    assert isinstance(moved, vx.Compound)
    assert moved.parts[0][1][2, 3] == 1.0
    assert len(shape_of(solid("box", 1, 2, 3), solid("sphere", 1)).parts) == 2


@pytest.mark.parametrize(("mesh_as", "kind"), [("model", vx.Model), ("hull", vx.ConvexHull)])
def test_ellipsoids_and_meshes_become_models_or_hulls(mesh_as, kind):
    round_one = shape_of(solid("ellipsoid", 1, 2, 3), mesh_as=mesh_as)
    assert isinstance(round_one, kind)
    np.testing.assert_allclose(np.ptp(round_one.mesh.vertices, axis=0), (2, 4, 6), rtol=1e-3)
    box = MeshArrays("box", read_mesh(trimesh.creation.box()))
    placed = shape_of(Collision(box, vx.pose((5, 0, 0))), mesh_as=mesh_as)
    assert isinstance(placed, kind)
    np.testing.assert_allclose(placed.mesh.vertices.mean(axis=0), (5, 0, 0), atol=1e-6)


def test_a_mesh_without_a_volume_is_refused_by_link_and_line():
    line = MeshArrays("line", read_mesh(([(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)], [(0, 1, 2), (1, 3, 2)])))  # fmt: skip
    with pytest.raises(vx.RobotError, match=r"robot\.xml:7: link 'a': line: .*give it a thickness"):
        shape_of(Collision(line, np.eye(4)), mesh_as="hull")


def test_open_meshes_become_solids_or_sheets_as_told():
    shallow = trimesh.creation.box((1.0, 1.0, 0.3))
    shallow.update_faces(~(shallow.face_normals[:, 2] > 0.9))  # without its lid
    tray = Collision(MeshArrays("tray", read_mesh(shallow)), np.eye(4))
    inside = [(0.0, 0.0, 0.0)]
    assert shape_of(tray, open="solid").field.sample(inside) < -0.1
    assert shape_of(tray, open="sheet").field.sample(inside) > 0.05
    thick = shape_of(tray, open="sheet", sheet_thickness=0.2)
    assert thick.field.sample([(0.0, 0.0, -0.15)]) == pytest.approx(-0.1, abs=0.03)
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0.0)])
    flat = Collision(MeshArrays("flat", read_mesh((corners, [(0, 1, 2)]))), np.eye(4))
    for mesh_as in ("model", "hull"):
        made = shape_of(flat, mesh_as=mesh_as, sheet_thickness=0.02)
        assert np.ptp(made.mesh.vertices[:, 2]) == pytest.approx(0.02, abs=1e-3)


@pytest.mark.parametrize(
    "wrong",
    [
        {"mesh_as": "box"}, {"voxel_size": -1.0}, {"resolution": 1}, {"resolution": 2.5},
        {"open": "closed"}, {"sheet_thickness": 0.0}, {"sheet_thickness": 0.01, "open": "solid"},
    ],
)  # fmt: skip
def test_settings_are_checked(wrong):
    with pytest.raises(vx.VoxshellError, match=next(iter(wrong))):
        shape_of(**wrong)


def test_a_long_mesh_without_a_scale_is_doubted_once(tmp_path):
    path = tmp_path / "part.stl"
    trimesh.creation.box((80, 60, 20)).export(path)
    mesh = '<collision><geometry><mesh filename="part.stl"/></geometry></collision>'
    robot = tmp_path / "robot.urdf"
    robot.write_text(f'<robot name="r"><link name="a">{mesh}{mesh}</link></robot>')
    with pytest.warns(
        vx.MeshWarning, match=r'80 m long.*scale="0\.001 0\.001 0\.001" in the robot'
    ) as said:
        vx.load_urdf(vx.World(), robot, mesh_as="hull")
    assert len(said) == 1
    robot.write_text(robot.read_text().replace('.stl"', '.stl" scale="1 1 1"'))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        vx.load_urdf(vx.World(), robot, mesh_as="hull")
    model = tmp_path / "model.xml"
    body = '<body><freejoint/><geom type="mesh" mesh="part"/></body>'
    model.write_text(
        f'<mujoco><asset><mesh file="part.stl"/></asset><worldbody>{body}</worldbody></mujoco>'
    )
    with pytest.warns(vx.MeshWarning, match="80 m long"):
        vx.load_mjcf(vx.World(), model, mesh_as="hull")
