"""Recordings as glTF, read back by hand, by trimesh and by pygltflib.

``./dev`` does not install pygltflib. The test that needs it is skipped without it; install it with
``pip install pygltflib``.
"""

from __future__ import annotations

import json
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh
from recorded_fall import FRAMES, TIME_STEP, come_later, turn_and_fall
from voxshell.recording import BodyTrack, ContactTrack, Recording


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
    path = recording.save_gltf(tmp_path / "fall.glb", contacts=False)
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
    scene = trimesh.load(recording.save_gltf(tmp_path / "fall.glb", up=up, contacts=False))
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


def test_contacts_and_forces_are_where_they_were_recorded_and_of_size_zero_elsewhere(
    tmp_path: Path,
):
    recording = turn_and_fall()
    document, binary = read_glb(recording.save_gltf(tmp_path / "fall.glb"))
    (animation,) = document["animations"]
    assert document["nodes"][0]["children"] == list(range(1, len(document["nodes"])))
    states: dict[int, dict[str, np.ndarray]] = {}
    for number, node in enumerate(document["nodes"]):
        if node["name"].startswith(("contact", "force")):
            states[number] = {
                key: np.tile(node[key], (FRAMES, 1)) for key in ("translation", "rotation", "scale")
            }
    for channel in animation["channels"]:
        if channel["target"]["node"] not in states:
            continue
        sampler = animation["samplers"][channel["sampler"]]
        assert sampler["interpolation"] == "STEP"
        times = values_of(document, binary, sampler["input"])[:, 0]
        values = values_of(document, binary, sampler["output"])
        last = np.searchsorted(times, np.arange(FRAMES) * TIME_STEP + 1e-6) - 1
        states[channel["target"]["node"]][channel["target"]["path"]] = values[last]
    balls = [s for number, s in states.items() if "contact" in document["nodes"][number]["name"]]
    assert len(balls) > 1, "balls of several depths"
    sizes = np.array([state["scale"][:, 0] for state in balls])
    assert (sizes.sum(axis=0) == 1.0).all(), "one in each frame, of the color of its depth"
    shown = balls[0]["translation"] * 0.0
    for state in balls:
        shown += state["translation"] * state["scale"]
    assert shown == pytest.approx(recording.contacts.points, abs=1e-6)
    (arrow,) = (s for number, s in states.items() if "force" in document["nodes"][number]["name"])
    assert arrow["translation"] == pytest.approx(recording.contacts.points, abs=1e-6)
    assert arrow["scale"][:, 0] == pytest.approx(
        arrow["scale"][-1, 0] * np.linspace(0.5, 1, FRAMES)
    )
    turn = trimesh.transformations.quaternion_matrix(np.roll(arrow["rotation"][0], 1))
    assert turn[:3, 2] == pytest.approx([0.0, 0.0, 1.0], abs=1e-6)


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
    names = [node.name for node in document.nodes]
    assert names[:4] == ["recording", "ball", "a ball/2", "Boden ü"]
    assert set(names[4:]) == {"contact 1", "force 1"}
    assert document.animations[0].channels[0].target.path == "translation"


def test_a_recording_in_which_nothing_moves_has_no_animation(tmp_path: Path):
    ball = trimesh.creation.icosphere(subdivisions=1, radius=0.1)
    body = BodyTrack("ball", ball.vertices, ball.faces, None, np.eye(4)[None])
    document, _ = read_glb(
        Recording(0.1, (body,), ContactTrack.empty(1)).save_gltf(tmp_path / "still.glb")
    )
    assert "animations" not in document


def test_vertices_of_no_face_have_a_normal_of_unit_length(tmp_path: Path):
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.1)
    vertices = np.concatenate([ball.vertices, [[0.0, 0.0, 0.0]]])
    body = BodyTrack("ball", vertices, ball.faces, None, np.eye(4)[None])
    path = Recording(0.1, (body,), ContactTrack.empty(1)).save_gltf(tmp_path / "ball.glb")
    document, binary = read_glb(path)
    attributes = document["meshes"][0]["primitives"][0]["attributes"]
    normals = values_of(document, binary, attributes["NORMAL"])
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0, abs=1e-6)


def test_round_bodies_are_written_without_scipy_and_without_a_word(tmp_path):
    # trimesh logs a traceback where it does without scipy, which is no dependency.
    code = f"""
import sys
sys.modules["scipy"] = None
import voxshell as vx
world = vx.World()
world.add(vx.Sphere(0.1))
world.record().recording().save_gltf({str(tmp_path / "ball.glb")!r})
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout + done.stderr == ""
    assert (tmp_path / "ball.glb").stat().st_size > 1000


def test_a_body_that_comes_later_has_no_size_before(tmp_path: Path):
    document, binary = read_glb(come_later(20).save_gltf(tmp_path / "late.glb"))
    (animation,) = document["animations"]
    (channel,) = (each for each in animation["channels"] if each["target"]["path"] == "scale")
    node = document["nodes"][channel["target"]["node"]]
    assert (node["name"], node["scale"]) == ("ball", [0.0] * 3)
    sampler = animation["samplers"][channel["sampler"]]
    assert sampler["interpolation"] == "STEP"
    times = values_of(document, binary, sampler["input"])[:, 0]
    assert times == pytest.approx([0.0, 20 * TIME_STEP])
    assert values_of(document, binary, sampler["output"]).tolist() == [[0.0] * 3, [1.0] * 3]
