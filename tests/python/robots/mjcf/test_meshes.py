from __future__ import annotations

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.robots.mjcf.parts import open_part

GEOM = "<geom type='mesh' mesh='{}'/>"


@pytest.fixture
def find(read, tmp_path):
    """The mesh of a geom, where the model has some assets."""
    (tmp_path / "meshes").mkdir()
    trimesh.creation.box(bounds=[(0, 0, 0), (1, 2, 4)]).export(tmp_path / "meshes/box.stl")

    def find(assets: str, name: str, compiler: str = "meshdir='meshes'"):
        file = read(f"<compiler {compiler}/><asset>{assets}</asset>{GEOM.format(name)}")
        meshes = open_part(file, "").meshes
        return meshes, file.root.children[-1]

    return find


def test_a_mesh_is_called_as_its_file_if_it_has_no_name(find):
    meshes, geom = find("<mesh file='box.stl'/>", "box")
    np.testing.assert_allclose(np.ptp(meshes.read(geom).vertices, axis=0), (1, 2, 4))


def test_points_are_moved_then_turned_then_scaled(find):
    asset = "<mesh file='box.stl' refpos='1 0 0' refquat='1 0 0 1' scale='1 10 -1'/>"
    meshes, geom = find(asset, "box")
    mesh = meshes.read(geom)
    np.testing.assert_allclose(mesh.vertices.min(axis=0), (0, 0, -4), atol=1e-9)
    np.testing.assert_allclose(mesh.vertices.max(axis=0), (2, 10, 0), atol=1e-9)
    assert trimesh.Trimesh(*mesh).volume == pytest.approx(80)  # it is not inside out
    assert meshes.weigh(geom).mass == pytest.approx(80)


def test_folders_can_be_stripped(find):
    meshes, geom = find("<mesh file='somewhere/else/box.stl'/>", "box", "meshdir='meshes' strippath='true'")  # fmt: skip
    assert len(meshes.read(geom).faces) == 12


def test_vertices_in_the_model_have_their_hull_or_their_faces(find):
    corners = "0 0 0 1 0 0 0 1 0 0 0 1 0.1 0.1 0.1"
    meshes, geom = find(f"<mesh name='a' vertex='{corners}' scale='2 2 2'/>", "a")
    assert trimesh.Trimesh(*meshes.read(geom)).volume == pytest.approx(8 / 6)
    meshes, geom = find(f"<mesh name='a' vertex='{corners}' face='0 1 2'/>", "a")
    assert len(meshes.read(geom).faces) == 1


@pytest.mark.parametrize(
    ("asset", "message"),
    [
        (
            "<mesh name='a' file='none.stl'/>",
            "mesh 'a' has a file 'none.stl' that is missing",
        ),
        ("<mesh name='a' file='box.stl' scale='0 1 1'/>", "has a scale"),
        ("<mesh name='a' vertex='0 0 0 1'/>", "not a multiple of 3"),
        ("<mesh name='a' vertex='0 0 0 1 0 0'/>", "mesh 'a': vertices of mesh 'a': "),
        ("<mesh name='b' file='box.stl'/>", "<asset> has no such mesh"),
        ("<mesh name='a'/>", "a <mesh> without file"),
        ("<mesh name='a' builtin='sphere' params='1'/>", "mesh 'a' is made by MuJoCo (builtin"),
        ("<mesh name='a'><plugin plugin='mujoco.sdf.gear'/></mesh>", "mesh 'a' is made by MuJoCo"),
    ],
)
def test_what_is_wrong_with_a_mesh_is_said_with_its_line(find, asset, message):
    meshes, geom = find(asset, "a")
    with pytest.raises(vx.RobotError) as refusal:
        meshes.read(geom)
    assert message in str(refusal.value)
    assert "model.xml:1" in str(refusal.value)


def test_a_shell_of_a_mesh_is_asked_of_the_mesh(write):
    mesh = "<mesh name='a' vertex='0 0 0 1 0 0 0 1 0 0 0 1' inertia='{}'/>"
    body = "<worldbody><body><freejoint/><geom type='mesh' mesh='a' {}/></body></worldbody>"
    path = write(f"<asset>{mesh.format('legacy')}</asset>", body.format("shellinertia='true'"))
    with pytest.raises(vx.RobotError, match=r"model\.xml:1: .* give its <mesh> inertia=\"shell\""):
        vx.load_mjcf(vx.World(), path)
    path = write(f"<asset>{mesh.format('shell')}</asset>", body.format(""))
    area = 1.5 + 3**0.5 / 2
    assert vx.load_mjcf(vx.World(), path).bodies[0].mass == pytest.approx(1000 * area)
