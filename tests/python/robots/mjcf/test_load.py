from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx

PENDULUM = """<worldbody><body name="bob" pos="0 0 2" euler="0 20 0"><joint name="pivot" axis="0 1 0"/>
  <geom type="capsule" fromto="0 0 0 0 0 -0.5" size="0.02"/></body></worldbody>"""


def test_a_pendulum_swings_in_its_time(write):
    """A rod of 0.5 m with round ends, by 20 degrees to each side."""
    world = vx.World()
    robot = vx.load_mjcf(world, write(PENDULUM))
    angles = []
    world.step(1000, lambda _: angles.append(robot.positions["pivot"]))
    start = np.radians(20)
    crossings = np.flatnonzero(np.diff(np.sign(np.array(angles) + start)) != 0) * world.time_step
    period = 2 * np.diff(crossings).mean()
    rod, ends = np.pi * 0.02**2 * 0.5, 4 / 3 * np.pi * 0.02**3
    moment = rod * (0.25 / 3 + 0.02**2 / 4) + ends * (0.4 * 0.02**2 + 0.25 / 2 * 1.0)
    exact = 2 * np.pi * np.sqrt(moment / ((rod + ends) * 9.81 * 0.25)) * (1 + start**2 / 16)
    assert period == pytest.approx(exact, rel=5e-3)


@pytest.mark.parametrize("mesh_as", ["model", "hull"])
def test_meshes_become_models_or_hulls(write, tmp_path, mesh_as):
    trimesh.creation.box((0.2, 0.2, 0.2)).export(tmp_path / "box.stl")
    body = (
        "<worldbody><body><freejoint/><geom type='mesh' mesh='box' pos='1 0 0'/></body></worldbody>"
    )
    path = write("<asset><mesh file='box.stl'/></asset>", body)
    [body] = vx.load_mjcf(vx.World(), path, mesh_as=mesh_as, resolution=20).bodies
    assert isinstance(body.shape, vx.Model if mesh_as == "model" else vx.ConvexHull)
    assert body.mass == pytest.approx(8.0)
    np.testing.assert_allclose(body.bounds.mean(axis=0), (1, 0, 0), atol=1e-6)


def test_models_may_have_a_tolerance(write, tmp_path):
    trimesh.creation.box((0.2, 0.2, 0.2)).export(tmp_path / "box.stl")
    path = write(
        "<asset><mesh file='box.stl'/></asset>"
        "<worldbody><body><freejoint/><geom type='mesh' mesh='box'/></body></worldbody>"
    )
    [body] = vx.load_mjcf(vx.World(), path, tolerance=0.0003).bodies
    assert body.shape.tolerance == pytest.approx(0.0003)
    [body] = vx.load_mjcf(vx.World(), path).bodies
    assert body.shape.tolerance is None
    assert body.shape.field.voxel_size == pytest.approx(0.002)


def test_a_urdf_file_is_called_one(tmp_path):
    path = tmp_path / "robot.xml"
    path.write_text('<robot name="r"><link name="a"/></robot>')
    with pytest.raises(vx.RobotError, match="not a <mujoco>: load URDF files with load_urdf"):
        vx.load_mjcf(vx.World(), path)


def test_wrong_calls_are_refused(write):
    path = write(PENDULUM)
    with pytest.raises(vx.SettingsError, match="'model' or 'hull', not 'box'"):
        vx.load_mjcf(vx.World(), path, mesh_as="box")
    with pytest.raises(vx.SettingsError, match="friction"):
        vx.load_mjcf(vx.World(), path, friction=-1.0)
    with pytest.raises(vx.PoseError):
        vx.load_mjcf(vx.World(), path, pose=np.zeros((4, 4)))
    with pytest.raises(vx.InputTypeError, match="world must be a World"):
        vx.load_mjcf(None, path)
    with pytest.raises(vx.MissingFileError, match=r"cannot read none\.xml: it does not exist"):
        vx.load_mjcf(vx.World(), "none.xml")


def test_a_robot_can_be_removed(write):
    world = vx.World()
    vx.load_mjcf(
        world, write(PENDULUM, "<worldbody><geom type='plane' size='1 1 1'/></worldbody>")
    ).remove()
    assert world.bodies == ()
    assert world.joints == ()


def test_a_mesh_is_not_called_damaged_xml(tmp_path):
    path = tmp_path / "part.stl"
    path.write_bytes(b"solid part")
    with pytest.raises(
        vx.RobotError, match=r"it is a mesh, not an MJCF file; pass it to voxshell\.Mo"
    ):
        vx.load_mjcf(vx.World(), path)
