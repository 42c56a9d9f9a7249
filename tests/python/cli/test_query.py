from __future__ import annotations

import re

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.cli.pose_input import make_pose

TURNED = (0.001, 0.002, 0.045, 0.5, 0.5, 0.5, 0.5)


@pytest.fixture(scope="module")
def cone(cone_model_path):
    return vx.Model.load(cone_model_path)


def test_quaternions_are_those_of_trimesh():
    rng = np.random.default_rng(3)
    for _ in range(20):
        w, x, y, z = trimesh.transformations.random_quaternion(rng.random(3))
        expected = trimesh.transformations.quaternion_matrix([w, x, y, z])
        expected[:3, 3] = 1, 2, 3
        np.testing.assert_allclose(make_pose([1, 2, 3, x, y, z, w], "pose"), expected, atol=1e-12)


def test_answers_are_those_of_the_package(voxshell, cone, cone_model_path):
    ended = voxshell(
        *("query", cone_model_path, cone_model_path, "--pose", *TURNED, "--a-pose", 0, 0, "-0.001"),
        *("--ask", "contacts", "collide", "distance", "wrench", "--stiffness", "1e6", "--json"),
    )
    assert ended.code == 0, ended.err
    [told] = ended.json
    poses = (make_pose([0, 0, -0.001], "a"), make_pose(TURNED, "b"))
    expected = vx.contacts(cone, cone, *poses)
    assert len(expected) > 3
    assert told["contacts"]["ids"] == expected.ids.tolist()
    assert told["contacts"]["depths"] == expected.depths.tolist()
    assert told["contacts"]["normals"] == expected.normals.tolist()
    assert told["collide"] is True
    assert told["distance"]["distance"] == vx.distance(cone, cone, *poses).distance
    assert told["wrench"]["force"] == vx.wrench(cone, cone, *poses, stiffness=1e6).force.tolist()


@pytest.mark.parametrize("form", ["csv", "csv with heading", "matrices", "rows"])
def test_poses_come_from_files(voxshell, cone, cone_model_path, tmp_path, form):
    rows = [(0.0, 0.0, height) for height in (0.02, 0.048, 0.06)]
    path = tmp_path / ("poses.csv" if form.startswith("csv") else "poses.npy")
    if form.startswith("csv"):
        heading = "x, y, z\n" if "heading" in form else ""
        path.write_text(heading + "".join(f"{x}, {y}, {z}\n" for x, y, z in rows))
    else:
        matrices = np.array([make_pose(row, "row") for row in rows])
        np.save(path, matrices if form == "matrices" else np.array(rows))
    ended = voxshell("query", cone_model_path, cone_model_path, "--poses", path, "--json")
    assert ended.code == 0, ended.err
    expected = [len(vx.contacts(cone, cone, None, make_pose(row, "row"))) for row in rows]
    assert [answer["contacts"]["count"] for answer in ended.json] == expected
    assert [answer["collide"] for answer in ended.json] == [True, True, False]


def test_shapes_in_words_and_meshes(voxshell, cone_path):
    settings = ("--scale", "0.001", "--voxel-size", "0.002", "--json")
    for text, shape in (
        ("plane", vx.Plane()),
        ("plane:0,0,1,-0.01", vx.Plane((0, 0, 1), -0.01)),
        ("sphere:0.04", vx.Sphere(0.04)),
        ("box:0.02,0.02,0.04", vx.Box((0.02, 0.02, 0.04))),
        ("capsule:0.01,0.1", vx.Capsule(0.01, 0.1)),
    ):
        [told] = voxshell("query", cone_path, text, *settings).json
        model = vx.Model.from_mesh(cone_path, scale=0.001, voxel_size=0.002)
        assert told["distance"]["distance"] == vx.distance(model, shape).distance, text


def test_tables_fit_a_terminal(voxshell, cone_model_path):
    ask = ("--ask", "contacts", "collide", "distance", "wrench", "--stiffness", "1e6")
    for pose in ((0.001, 0.002, 0.0453), (0.0, 0.0, 9.0)):
        ended = voxshell("query", cone_model_path, cone_model_path, "--pose", *pose, *ask)
        assert ended.code == 0, ended.err
        assert max(map(len, ended.out.splitlines())) <= 80
        assert ("yes" in ended.out) == (pose[2] < 1.0)


def test_tables_show_no_leftovers_of_rounding(voxshell, cone_model_path):
    ended = voxshell("query", cone_model_path, "plane", "--a-pose", 0, 0, -0.0003)
    assert "on b" in ended.out
    assert not re.search(r"e-\d\d|-0\.000\b", ended.out), ended.out


@pytest.mark.parametrize(
    ("command", "bodies"), [("query", ["sphere:0.1"]), ("bench", []), ("view", ["plane"])]
)
def test_options_for_meshes_are_refused_where_there_is_no_mesh(
    voxshell, cone_model_path, command, bodies
):
    sizes = ("--voxel-size", 0.01, "--scale", 0.001)
    ended = voxshell(command, cone_model_path, *bodies, *sizes)
    assert ended.code == 2
    told = " ".join(ended.err.split())
    assert "--voxel-size, --scale: options for meshes have no effect" in told
    assert "leave them out, or pass a mesh" in told
