from __future__ import annotations

import csv
import importlib.util
import json
import signal
import subprocess
import sys
import urllib.request
from pathlib import Path

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.cli import progress, scene_report

EXAMPLES = Path(__file__).parents[3] / "examples" / "scenes"

SCENE = """
[scene]
title = "A cone and a ball"
duration = 0.5
rate = 100
[outputs]
every = 5
contacts = "csv"
[meshes.cone]
file = "cone.stl"
scale = 0.001
voxel_size = 0.003
[bodies.ground]
shape = "plane"
[bodies.cone]
mesh = "cone"
mass = 0.2
position = [0, 0, 0.1]
rotation_vector = [0, 0, 1.5707963267948966]
friction = 0.7
restitution = 0.3
[bodies.ball]
shape = "sphere"
radius = 0.02
mass = 0.05
position = [0.2, 0, 0.05]
linear_velocity = [0.5, 0, 0]
color = [200, 30, 30]
"""


@pytest.fixture(scope="module")
def scene_path(tmp_path_factory, cone_path):
    folder = tmp_path_factory.mktemp("scene")
    (folder / "cone.stl").write_bytes(cone_path.read_bytes())
    (folder / "scene.toml").write_text(SCENE)
    return folder / "scene.toml"


def simulate_by_hand(folder: Path) -> vx.World:
    """The same scene with the package alone."""
    world = vx.World(time_step=1 / 100)
    world.add(vx.Plane(), mass=0, name="ground")
    pose = np.eye(4)
    pose[:2, :2] = [[0, -1], [1, 0]]
    pose[2, 3] = 0.1
    cone = vx.Model.from_mesh(folder / "cone.stl", scale=0.001, voxel_size=0.003)
    world.add(cone, mass=0.2, pose=pose, friction=0.7, restitution=0.3, name="cone")
    pose = np.eye(4)
    pose[:3, 3] = 0.2, 0, 0.05
    ball = world.add(vx.Sphere(0.02), mass=0.05, pose=pose, name="ball")
    ball.linear_velocity = 0.5, 0, 0
    world.step(50)
    return world


def test_scene_ends_as_the_same_world_does(voxshell, scene_path, tmp_path):
    from pyarrow import parquet

    out = tmp_path / "a" / "b"
    ended = voxshell("simulate", scene_path, "--out", out)
    assert ended.code == 0, ended.err
    names = sorted(path.name for path in out.iterdir())
    assert names == ["contacts.csv", "index.html", "plot.png", "poses.parquet", "results.json"]
    assert max(map(len, ended.out.splitlines()[:8])) <= 80
    world = simulate_by_hand(scene_path.parent)
    poses = parquet.read_table(out / "poses.parquet").to_pydict()
    assert len(poses["time"]) == 11 * 3
    assert poses["time"][-1] == pytest.approx(0.5)
    assert poses["body"][-3:] == ["ground", "cone", "ball"]
    for body, row in zip(world.bodies, range(-3, 0), strict=True):
        end = [poses[axis][row] for axis in "xyz"]
        np.testing.assert_allclose(end, body.pose[:3, 3], atol=1e-9)
        speed = [poses[f"v{axis}"][row] for axis in "xyz"]
        np.testing.assert_allclose(speed, body.linear_velocity, atol=1e-9)
    with (out / "contacts.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if float(row["time"]) > 0.49]
    assert len(rows) == len(world.contacts()) > 3
    found = sorted(float(row["depth"]) for row in rows)
    np.testing.assert_allclose(found, np.sort(world.contacts()["depth"]), atol=1e-9)
    assert {row["body_a"] for row in rows} | {row["body_b"] for row in rows} == {
        *("ground", "cone", "ball")
    }


def test_json_is_what_is_written(voxshell, scene_path, tmp_path):
    ended = voxshell("simulate", scene_path, "--out", tmp_path, "--json")
    assert ended.code == 0
    written = json.loads((tmp_path / "results.json").read_text())
    assert ended.json == written
    assert [row["body"] for row in written["bodies"]] == ["ground", "cone", "ball"]
    assert written["settings"]["bodies"]["cone"]["friction"] == 0.7


@pytest.mark.parametrize(("problem", "code"), [(OSError, 1), (KeyboardInterrupt, 130)])
def test_nothing_is_left_of_what_was_not_finished(
    voxshell, scene_path, tmp_path, monkeypatch, problem, code
):
    def fail(*_):
        raise problem("disk full")

    monkeypatch.setattr(scene_report, "_draw", fail)
    ended = voxshell("simulate", scene_path, "--out", tmp_path / "new")
    assert ended.code == code
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "results.json").write_text("older")
    voxshell("simulate", scene_path, "--out", tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["results.json"]
    assert (tmp_path / "results.json").read_text() == "older"


def test_what_is_not_installed_is_said_before_the_work(voxshell, scene_path, tmp_path, monkeypatch):
    from importlib import util

    find = util.find_spec
    monkeypatch.setattr(util, "find_spec", lambda name: None if name == "viser" else find(name))
    ended = voxshell("simulate", scene_path, "--out", tmp_path / "out")
    assert ended.code == 1
    assert "pip install 'voxshell[viewer]'" in ended.err
    assert "build" not in ended.err


@pytest.mark.parametrize(
    ("form", "library", "extra"), [("mp4", "pyvista", "video"), ("usda", "pxr", "usd")]
)
def test_an_export_that_is_not_installed_is_said_before_the_work(
    voxshell, scene_path, tmp_path, monkeypatch, form, library, extra
):
    from importlib import util

    monkeypatch.setattr(util, "find_spec", lambda name: None if name == library else name)
    ended = voxshell("simulate", scene_path, "--out", tmp_path / "out", "--export", form)
    assert ended.code == 1
    assert f"need {library}: pip install 'voxshell[{extra}]'" in " ".join(ended.err.split())


def test_exports_are_written_beside_the_other_outputs(voxshell, scene_path, tmp_path):
    ended = voxshell("simulate", scene_path, "--out", tmp_path, "--export", "glb")
    assert ended.code == 0, ended.err
    scene = trimesh.load(tmp_path / "recording.glb")
    assert {"ground", "cone", "ball"} <= set(scene.graph.nodes)
    assert (tmp_path / "index.html").exists()
    ended = voxshell("simulate", scene_path, "--out", tmp_path, "--export", "obj")
    assert ended.code == 2
    assert "glb" in ended.err


def test_a_video_moves_the_progress_of_its_scene(voxshell, scene_path, tmp_path, monkeypatch):
    told = []

    def draw(recording, path, *, title, progress):  # as Recording.save_video
        path.write_bytes(b"video")
        progress("draw", 0.5)

    monkeypatch.setattr(vx.Recording, "save_video", draw)
    monkeypatch.setattr(scene_report, "check_extras", lambda scene: None)
    monkeypatch.setattr(progress.Track, "update", lambda self, *state: told.append(state))
    ended = voxshell("simulate", scene_path, "--out", tmp_path, "--export", "mp4", "glb")
    assert ended.code == 0, ended.err
    assert told[told.index(("recording.mp4", 0.7)) + 1] == ("recording.mp4", pytest.approx(0.775))


def test_a_watched_scene_waits_for_somebody_until_ctrl_c(scene_path, tmp_path):
    code = "from voxshell.cli import main; import sys; main(sys.argv[1:])"
    command = [sys.executable, "-c", code, "simulate", str(scene_path), "--watch"]
    with subprocess.Popen(
        [*command, "--out", str(tmp_path / "out")], stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stderr is not None
        address = next(line for line in process.stderr if "http://" in line).split()[0]
        with urllib.request.urlopen(address) as answer:
            assert b"<html" in answer.read().lower()
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=60) == 130
    assert not (tmp_path / "out").exists()


JOINTS = """
[scene]
duration = 1.0
gravity = [0, 0, 0]
[outputs]
replay = false
plot = false
poses = "none"
contacts = "none"
[bodies.base]
shape = "box"
half_extents = [0.1, 0.1, 0.1]
mass = 0
[bodies.cart]
shape = "cylinder"
radius = 0.05
length = 0.1
position = [0.5, 0, 0]
rotation_vector = [1, 0, 0]
[bodies.arm]
shape = "capsule"
radius = 0.02
length = 0.2
position = [0, 0, 0.5]
[bodies.head]
shape = "cone"
radius = 0.05
height = 0.1
position = [0, 0, 0.7]
[joints.rail]
kind = "slider"
parent = "base"
child = "cart"
axis = [1, 0, 0]
limits = [-0.2, 0.3]
target_position = 0.25
max_force = 100
[joints.shoulder]
kind = "hinge"
child = "arm"
position = [0, 0, 0.4]
axis = [0, 1, 0]
target_velocity = 0.5
max_force = 100
[joints.neck]
kind = "fixed"
parent = "arm"
child = "head"
"""


def test_joints_hold_and_drive(voxshell, tmp_path):
    (tmp_path / "scene.toml").write_text(JOINTS)
    ended = voxshell("simulate", tmp_path / "scene.toml", "--out", tmp_path / "out", "--json")
    assert ended.code == 0, ended.err
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["results.json"]
    rail, shoulder = ended.json["joints"]
    assert rail["position"] == pytest.approx(0.25, abs=1e-3)
    assert shoulder["position"] == pytest.approx(0.5, abs=0.02)
    ends = {row["body"]: np.array(row["position"]) for row in ended.json["bodies"]}
    np.testing.assert_allclose(ends["cart"], [0.75, 0, 0], atol=1e-3)
    # Arm and head turn about y through (0, 0, 0.4).
    angle = shoulder["position"]
    for name, reach in (("arm", 0.1), ("head", 0.3)):
        expected = [reach * np.sin(angle), 0.0, 0.4 + reach * np.cos(angle)]
        np.testing.assert_allclose(ends[name], expected, atol=5e-3)


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_examples_run(voxshell, bunny_path, tmp_path, path):
    text = path.read_text()
    assert ("bunny.obj" in text) == (str(bunny_path) in text)
    (tmp_path / path.name).write_text(text.replace("duration = 2.0", "duration = 0.3"))
    ended = voxshell("simulate", tmp_path / path.name, "--out", tmp_path / "out")
    assert ended.code == 0, ended.err
    assert (tmp_path / "out" / "index.html").stat().st_size > 100_000


def test_all_missing_extras_are_named_at_once(voxshell, scene_path, tmp_path, monkeypatch):
    missing = {"viser", "matplotlib", "pyarrow", "pyvista", "imageio", "imageio_ffmpeg"}
    find_spec = importlib.util.find_spec
    monkeypatch.setattr(
        "importlib.util.find_spec",
        lambda name, *rest: None if name in missing else find_spec(name, *rest),
    )
    ended = voxshell("simulate", scene_path, "--out", tmp_path / "out", "--export", "gif")
    assert ended.code == 1
    said = " ".join(ended.err.split())
    assert (
        "need viser, matplotlib, pyarrow, pyvista, imageio, imageio_ffmpeg: pip install 'voxshell[viewer,report,video]'"
        in said
    )
    assert not (tmp_path / "out").exists()
