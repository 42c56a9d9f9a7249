"""Scene files that ask for much: what is wrong is said with file and line, at once."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path

import pytest
import trimesh
import voxshell as vx
from voxshell.scenes.scene_file import read_scene
from voxshell.scenes.scene_world import build_world

BODY = '[bodies.b{0}]\nshape = "box"\nhalf_extents = [1, 1, 1]\nposition = [{0}, 0, 1]\nmass = 1\n'
BODIES = "[scene]\n" + "".join(BODY.format(i) for i in range(400))
ONE = '[bodies.a]\nshape = "sphere"\nradius = 1\nmass = 1\n'

HOSTILE: dict[str, tuple[Callable[[], str], str]] = {
    "typo in the last of 400 bodies": (
        lambda: BODIES.replace("mass = 1\n", "mas = 1\n", 400).replace("mas = ", "mass = ", 399),
        r":2001: bodies.b399.mas: unknown setting",
    ),
    "key of 100,000 parts": (
        lambda: ONE + "x" + ".a" * 100_000 + " = 1\n",
        ":5: .* more than 100 parts",
    ),
    "quoted key of 100,000 parts": (
        lambda: ONE + "x = {'b'" + ".'a'" * 100_000 + " = 1}\n",
        ":5: .* more than 100 parts",
    ),
    "integer of 400 digits": (
        lambda: ONE + "friction = " + "9" * 400,
        ":5: bodies.a.friction must be a number from .* an integer of 1329 bits",
    ),
    "integer of 5000 digits": (lambda: ONE + "\nfriction = " + "9" * 5000, ":6: .*4300 digits"),
    "hexadecimal integer of 5000 digits": (
        lambda: ONE + "shape = 0x" + "f" * 5000,
        "not valid TOML: a key is given twice",
    ),
    "hexadecimal integer for a text": (
        lambda: "[bodies.a]\nshape = 0x" + "f" * 5000,
        ":2: bodies.a.shape must be 'plane', .* an integer of 20000 bits",
    ),
    "hexadecimal integers in a list": (
        lambda: "[bodies.a]\nshape = [0x" + "f" * 5000 + "]",
        ":2: bodies.a.shape must be 'plane', .* too many digits",
    ),
    "2000 nested arrays": (
        lambda: ONE + "color = " + "[" * 2000 + "]" * 2000,
        ":5: .* nested more than 100 deep",
    ),
    "2000 nested tables": (
        lambda: ONE + "color = " + "{a=" * 2000 + "1" + "}" * 2000,
        ":5: .* nested more than 100 deep",
    ),
    "a long text for a number": (
        lambda: ONE + f'friction = "{"x" * 100_000}"',
        r":5: bodies.a.friction must be a number, not 'x{79}\.\.\.",
    ),
    "600 kB": (
        lambda: ONE + "#" * 600_000,
        "600048 characters, and at most 500000 are read; shorten it, or split it",
    ),
    "3 MB": (lambda: ONE + "#" * 3_000_000, "has 3000048 bytes; at most 2000000 are read"),
    "100,000 tables": (
        lambda: "".join(f"[a{i}]\n" for i in range(100_000)),
        "888890 characters, and at most 500000 are read",
    ),
    "50,000 tables": (
        lambda: "".join(f"[a{i}]\n" for i in range(50_000)),
        ":1: a0: unknown table",
    ),
    "typo after 10,000 bodies": (
        lambda: (
            "".join(f'[bodies.b{i}]\nshape = "plane"\n' for i in range(10_000))
            + "[bodies.c]\nradios = 1"
        ),
        ":20002: bodies.c.radios: unknown setting",
    ),
    "a mesh that is not among 10,000": (
        lambda: (
            '[bodies.a]\nmesh = "b"\n[meshes]\n'
            + "".join(f'm{i} = {{file = "a.stl"}}\n' for i in range(10_000))
        ),
        r":2: bodies.a.mesh is 'b', but the scene has only the meshes m0, .*, m19, and 9980 more",
    ),
}


@pytest.mark.parametrize("what", HOSTILE)
def test_what_is_wrong_is_located_at_once(tmp_path: Path, what: str):
    """A typo took 11.6 s, a long key minutes, 70,000 bodies 40 s before they were checked; large
    integers and deep arrays ended in tracebacks."""
    make, message = HOSTILE[what]
    path = tmp_path / "scene.toml"
    path.write_text(make())
    start = time.process_time()
    with pytest.raises(vx.SettingsError, match=message) as caught:
        read_scene(path)
    assert time.process_time() - start < 2.0
    assert str(path) in str(caught.value)
    assert len(str(caught.value)) < 1000


def test_a_pipe_is_no_scene_and_keeps_nobody_waiting(tmp_path: Path):
    os.mkfifo(tmp_path / "scene.toml")
    with pytest.raises(vx.SettingsError, match="not a regular file"):
        read_scene(tmp_path / "scene.toml")


def test_a_byte_order_mark_is_skipped(tmp_path: Path):
    path = tmp_path / "scene.toml"
    path.write_bytes(b"\xef\xbb\xbf" + ONE.encode())
    assert list(read_scene(path).bodies) == ["a"]
    path.write_bytes(b"\xef\xbb\xbf" + ONE.replace("mass = 1", "mass = -1").encode())
    with pytest.raises(vx.SettingsError, match=r"scene\.toml:4: bodies\.a\.mass"):
        read_scene(path)


@pytest.mark.parametrize("studies", [True, False])
def test_a_mesh_is_answered_with_the_lines_of_a_scene_that_run(
    studies: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    found = ["studies"] if studies else []
    monkeypatch.setattr("voxshell.scenes.scene_file.entry_points", lambda group: found)
    mesh = tmp_path / 'a "part".stl'
    trimesh.creation.box((0.1, 0.1, 0.1)).export(mesh)
    with pytest.raises(vx.SettingsError) as raised:
        read_scene(mesh)
    told, _, scene_told = str(raised.value).partition("millimeters: ")
    lines = scene_told.split(" | ")
    assert ("voxshell simulate drop" in told) == studies
    assert "voxshell simulate scene.toml --out result" in told
    path = tmp_path / "scene.toml"
    path.write_text("\n".join(lines))
    scene = read_scene(path)
    assert len(lines) == 5
    world = build_world(scene, lambda *_: None)
    world.step(200)
    assert world.bodies[0].position[2] == pytest.approx(0.05, abs=0.001)


def test_a_mesh_that_is_too_large_for_a_scene_is_answered_with_the_lines_of_one(tmp_path: Path):
    mesh = tmp_path / "large.obj"
    mesh.write_text("v 0 0 0\n" * 300_000)
    with pytest.raises(
        vx.SettingsError, match=r"at most 2000000 are read; if it is a mesh, .*write"
    ):
        read_scene(mesh)
    scene = mesh.rename(tmp_path / "large.toml")
    with pytest.raises(vx.SettingsError, match=r"at most 2000000 are read$"):
        read_scene(scene)
