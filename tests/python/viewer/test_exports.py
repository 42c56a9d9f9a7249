"""Recordings as files for other programs, read back by those programs' libraries.

What reads USD (usd-core), glTF (pygltflib) and videos (imageio, imageio-ffmpeg, pyvista) is not among the packages that
``./dev`` installs. Tests that need one are skipped without it; install them all with
``pip install usd-core pygltflib imageio imageio-ffmpeg pyvista``.
"""

from __future__ import annotations

import importlib
import json
import math
import struct
from pathlib import Path

import numpy as np
import pytest
import trimesh
import voxshell as vx
from trimesh.transformations import rotation_matrix
from voxshell.recording import BodyTrack, ContactTrack, Recording
from voxshell.viewer.quaternions import as_steady, rotations_as_wxyz

FRAMES, TIME_STEP = 61, 1 / 60


def turn_and_fall() -> Recording:
    """A ball that moves a meter along x and turns one and a half times about z, two alike beside it, and a ground."""
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.1)
    poses = np.array(
        [rotation_matrix(3.0 * math.pi * i / (FRAMES - 1), (0, 0, 1)) for i in range(FRAMES)]
    )
    poses[:, 0, 3] = np.linspace(0.0, 1.0, FRAMES)
    poses[:, 2, 3] = 0.1
    beside = poses.copy()
    beside[:, 1, 3] += 0.5
    ground = trimesh.creation.box((4.0, 4.0, 0.2))
    under = np.tile(np.eye(4), (FRAMES, 1, 1))
    under[:, 2, 3] = -0.1
    frames = [([[x, 0, 0]], [[0, 0, 1]], [0.001 * x + 0.001]) for x in poses[:, 0, 3]]
    return Recording(
        TIME_STEP,
        (
            BodyTrack("ball", ball.vertices, ball.faces, (255, 0, 0), poses),
            BodyTrack("a ball/2", ball.vertices, ball.faces, None, beside),
            BodyTrack("Boden ü", ground.vertices, ground.faces, None, under),
        ),
        ContactTrack.from_frames(frames),
    )


def read_glb(path: Path) -> tuple[dict, bytes]:
    content = path.read_bytes()
    magic, version, length = struct.unpack("<III", content[:12])
    assert (magic, version, length) == (0x46546C67, 2, len(content))
    size, kind = struct.unpack("<II", content[12:20])
    assert kind == 0x4E4F534A
    document = json.loads(content[20 : 20 + size])
    size_2, kind = struct.unpack("<II", content[20 + size : 28 + size])
    assert kind == 0x004E4942
    binary = content[28 + size :]
    assert len(binary) == size_2 == document["buffers"][0]["byteLength"]
    return document, binary


def values_of(document: dict, binary: bytes, number: int) -> np.ndarray:
    accessor = document["accessors"][number]
    view = document["bufferViews"][accessor["bufferView"]]
    width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
    kind = {5126: "<f4", 5125: "<u4"}[accessor["componentType"]]
    start = view["byteOffset"]
    return np.frombuffer(binary[start : start + view["byteLength"]], kind).reshape(-1, width)


def test_an_animation_moves_nodes_as_the_recording_moves_bodies(tmp_path: Path):
    recording = turn_and_fall()
    path = recording.save_gltf(tmp_path / "fall.glb")
    document, binary = read_glb(path)
    (animation,) = document["animations"]
    assert len(animation["channels"]) == 4  # the ground stays
    for channel in animation["channels"]:
        sampler = animation["samplers"][channel["sampler"]]
        times = values_of(document, binary, sampler["input"])[:, 0]
        assert times == pytest.approx(np.arange(FRAMES) * TIME_STEP)
        node = document["nodes"][channel["target"]["node"]]
        body = next(each for each in recording.bodies if each.name == node["name"])
        values = values_of(document, binary, sampler["output"])
        if channel["target"]["path"] == "translation":
            assert values == pytest.approx(body.poses[:, :3, 3], abs=1e-6)
            continue
        for value, pose in zip(values, body.poses, strict=True):
            matrix = trimesh.transformations.quaternion_matrix(np.roll(value, 1))
            assert matrix[:3, :3] == pytest.approx(pose[:3, :3], abs=1e-6)
        # Between two keys, programs go the short way.
        assert np.einsum("ij,ij->i", values[1:], values[:-1]).min() > 0.9


@pytest.mark.parametrize("up", ["+z", "-y", "+x"])
def test_trimesh_reads_the_first_frame_with_y_up(tmp_path: Path, up: str):
    recording = turn_and_fall()
    scene = trimesh.load(recording.save_gltf(tmp_path / "fall.glb", up=up))
    heights = scene.to_geometry().vertices[:, 1]
    axis = "xyz".index(up[1])
    sign = 1.0 if up[0] == "+" else -1.0
    wanted = np.concatenate(
        [
            sign * (body.vertices @ body.poses[0, :3, :3].T + body.poses[0, :3, 3])[:, axis]
            for body in recording.bodies
        ]
    )
    assert (heights.min(), heights.max()) == pytest.approx((wanted.min(), wanted.max()), abs=1e-6)
    assert len(scene.to_geometry().faces) == sum(len(body.faces) for body in recording.bodies)


def test_bodies_of_one_shape_share_their_arrays(tmp_path: Path):
    document, _ = read_glb(turn_and_fall().save_gltf(tmp_path / "fall.glb"))
    first, second = (mesh["primitives"][0] for mesh in document["meshes"][:2])
    assert first["attributes"] == second["attributes"]
    assert first["material"] != second["material"]
    assert document["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] == [
        1.0,
        0.0,
        0.0,
        1.0,
    ]


def test_pygltflib_reads_the_file(tmp_path: Path):
    library = pytest.importorskip("pygltflib", reason="needs pygltflib")
    document = library.GLTF2().load(turn_and_fall().save_gltf(tmp_path / "fall.glb"))
    assert [node.name for node in document.nodes] == ["recording", "ball", "a ball/2", "Boden ü"]
    assert document.animations[0].channels[0].target.path == "translation"


def test_a_recording_in_which_nothing_moves_has_no_animation(tmp_path: Path):
    ball = trimesh.creation.icosphere(subdivisions=1, radius=0.1)
    body = BodyTrack("ball", ball.vertices, ball.faces, None, np.eye(4)[None])
    document, _ = read_glb(
        Recording(0.1, (body,), ContactTrack.empty(1)).save_gltf(tmp_path / "still.glb")
    )
    assert "animations" not in document


def test_signs_of_quaternions_do_not_jump():
    turns = [rotation_matrix(angle, (1, 2, 3))[:3, :3] for angle in np.linspace(0.0, 9.0, 50)]
    steady = as_steady(rotations_as_wxyz(np.array(turns)))
    assert np.einsum("ij,ij->i", steady[1:], steady[:-1]).min() > 0.9


@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usd"])
def test_usd_reads_what_was_recorded(tmp_path: Path, suffix: str):
    pytest.importorskip("pxr", reason="needs usd-core")
    usd, geometry = (importlib.import_module(f"pxr.{name}") for name in ("Usd", "UsdGeom"))
    recording = turn_and_fall()
    stage = usd.Stage.Open(str(recording.save_usd(tmp_path / f"fall{suffix}")))
    assert geometry.GetStageUpAxis(stage) == "Z"
    assert geometry.GetStageMetersPerUnit(stage) == 1.0
    assert stage.GetTimeCodesPerSecond() == pytest.approx(1.0 / TIME_STEP)
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (0.0, FRAMES - 1.0)
    meshes = [prim for prim in stage.Traverse() if prim.IsA(geometry.Mesh)]
    assert len(meshes) == 3
    for prim, body in zip(meshes, recording.bodies, strict=True):
        mesh = geometry.Mesh(prim)
        assert np.array(mesh.GetPointsAttr().Get()) == pytest.approx(body.vertices, abs=1e-6)
        assert len(mesh.GetFaceVertexCountsAttr().Get()) == len(body.faces)
        for frame in (0, 20, FRAMES - 1):
            # USD's matrices are for rows of points.
            matrix = np.array(mesh.ComputeLocalToWorldTransform(frame)).T
            assert matrix == pytest.approx(body.poses[frame], abs=1e-6)
    assert (suffix == ".usda") == (tmp_path / f"fall{suffix}").read_bytes().startswith(b"#usda")


# imageio leaves the pipes to ffmpeg to the garbage collector.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("suffix", [".mp4", ".gif"])
def test_a_video_shows_the_ball_going_right_and_its_contacts(tmp_path: Path, suffix: str):
    for name in ("pyvista", "imageio", "imageio_ffmpeg"):
        pytest.importorskip(name, reason="needs pyvista, imageio and imageio-ffmpeg")
    imageio = importlib.import_module("imageio.v2")
    path = turn_and_fall().save_video(
        tmp_path / f"fall{suffix}", size=(320, 200), frames_per_second=10, title="fall"
    )
    with imageio.get_reader(path) as reader:
        pictures = np.array([picture[..., :3] for picture in reader], dtype=np.int64)
        pause = reader.get_meta_data()["duration"] / (len(pictures) if suffix == ".mp4" else 1000)
    assert pictures.shape == (11, 200, 320, 3)
    assert pause == pytest.approx(0.1, abs=0.005)
    red = (pictures[..., 0] > 130) & (pictures[..., 1:].max(axis=-1) < 90)
    columns = [np.median(np.nonzero(each)[1]) for each in red]
    assert red.sum(axis=(1, 2)).min() > 30
    assert columns[-1] > columns[0] + 30
    assert list(tmp_path.iterdir()) == [path]


def test_a_video_of_an_odd_size_is_refused(tmp_path: Path):
    with pytest.raises(
        vx.SettingsError, match="two even numbers of pixels, not 321 x 200; try 322 x 200"
    ):
        turn_and_fall().save_video(tmp_path / "fall.mp4", size=(321, 200))


@pytest.mark.parametrize(
    ("method", "name", "message"),
    [
        (
            "save_html",
            "fall.png",
            r"ends in .html or .htm, but 'fall.png' ends in '.png'; try 'fall.html'",
        ),
        ("save_html", "fall", r"'fall' ends without a suffix; try 'fall.html'"),
        ("save_video", "fall.avi", r"a video needs a file name that ends in .mp4 or .gif"),
        (
            "save_gltf",
            "fall.gltf",
            r"ends in .glb, but 'fall.gltf' ends in '.gltf'; try 'fall.glb'",
        ),
        ("save_usd", "fall.usdz", r"ends in .usdc or .usda or .usd, but"),
    ],
)
def test_a_name_that_says_something_else_is_refused(
    tmp_path: Path, method: str, name: str, message: str
):
    with pytest.raises(vx.SettingsError, match=message):
        getattr(turn_and_fall(), method)(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("method", "name", "missing", "command"),
    [
        ("save_usd", "fall.usda", "pxr.Gf", r"pip install 'voxshell\[usd\]'"),
        ("save_video", "fall.mp4", "imageio_ffmpeg", r"pip install 'voxshell\[video\]'"),
        ("save_video", "fall.gif", "pyvista", r"pip install 'voxshell\[video\]'"),
    ],
)
def test_an_export_without_its_library_says_what_to_install(
    tmp_path: Path, monkeypatch, method: str, name: str, missing: str, command: str
):
    find = importlib.import_module

    def fail(asked: str):
        if asked == missing:
            raise ImportError(f"No module named {missing!r}")
        return find("json") if asked.startswith(("pxr", "imageio", "pyvista")) else find(asked)

    monkeypatch.setattr("voxshell.viewer.usd.import_module", fail)
    monkeypatch.setattr("voxshell.viewer.video.import_module", fail)
    with pytest.raises(vx.MissingExtraError, match=command):
        getattr(turn_and_fall(), method)(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_usd_knows_two_axes(tmp_path: Path):
    with pytest.raises(vx.SettingsError, match=r"up is '\+z' or '\+y', not '\+x'"):
        turn_and_fall().save_usd(tmp_path / "fall.usda", up="+x")
