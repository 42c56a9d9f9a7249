from __future__ import annotations

import os
import pty
import signal
import subprocess
import sys
import time
from contextlib import suppress

import pytest
import trimesh
import voxshell as vx

SETTINGS = ("--scale", "0.001", "--voxel-size", "0.004", "--target-points", "500")


def test_model_is_the_one_that_the_package_builds(voxshell, cone_path, tmp_path):
    file = tmp_path / "cone.vxs"
    ended = voxshell("build", cone_path, "-o", file, *SETTINGS)
    assert ended.code == 0, ended.err
    expected = vx.Model.from_mesh(cone_path, scale=0.001, voxel_size=0.004, target_points=500)
    expected.save(tmp_path / "expected.vxs")
    assert file.read_bytes() == (tmp_path / "expected.vxs").read_bytes()
    assert f"{len(expected.shell)} points" in ended.out
    assert max(map(len, ended.out.splitlines()[:-1])) <= 80
    assert ended.err == "", "progress would fill logs"


def test_json_tells_of_the_model(voxshell, cone_path, tmp_path):
    file = tmp_path / "cone.vxs"
    told = voxshell("build", cone_path, "-o", file, *SETTINGS, "--json").json
    model = vx.Model.load(file)
    assert (told["points"], told["voxel_size"]) == (len(model.shell), 0.004)
    assert told["file_bytes"] == file.stat().st_size
    assert told["seconds"] > 0.0


def test_faults_are_warned_of_without_a_place_in_the_code(voxshell, tmp_path):
    box = trimesh.creation.box()
    trimesh.Trimesh(box.vertices, box.faces[:-1]).export(tmp_path / "open.ply")
    ended = voxshell("build", tmp_path / "open.ply", "-o", tmp_path / "m.vxs", "--resolution", 20)
    assert ended.code == 0
    [warning] = [line for line in ended.err.splitlines() if line.startswith("warning: ")]
    assert "3 open edges" in warning
    assert "; repair the mesh, or pass --sign winding to silence this warning" in warning
    assert ".py" not in ended.err
    quiet = ("--sign", "winding", "--json")
    ended = voxshell(
        "build", tmp_path / "open.ply", "-o", tmp_path / "m.vxs", "--resolution", 20, *quiet
    )
    assert (ended.code, ended.err) == (0, "")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_folder_that_may_not_be_written_is_a_failure(voxshell, cone_path, tmp_path):
    tmp_path.chmod(0o500)
    assert voxshell("build", cone_path, "-o", tmp_path / "cone.vxs", *SETTINGS).code == 1


def test_full_disk_is_a_failure_and_leaves_nothing(voxshell, cone_path, tmp_path, monkeypatch):
    def fail(self, path):
        raise vx.FileAccessError(f"{path}: no space left on device")

    monkeypatch.setattr(vx.Model, "save", fail)
    ended = voxshell("build", cone_path, "-o", tmp_path / "cone.vxs", *SETTINGS)
    assert ended.code == 1
    assert "no space left" in ended.err
    assert list(tmp_path.iterdir()) == []


def test_ctrl_c_stops_a_build_and_leaves_nothing(bunny_path, tmp_path):
    screen, terminal = pty.openpty()
    process = subprocess.Popen(
        [
            *(sys.executable, "-c", "from voxshell.cli import main; main()", "build"),
            *(str(bunny_path), "-o", str(tmp_path / "m.vxs"), "--resolution", "1500"),
        ],
        stdout=subprocess.DEVNULL,
        stderr=terminal,
        env={**os.environ, "TERM": "xterm"},
    )
    os.close(terminal)
    said = ""
    try:
        # Progress is drawn: the core is at work.
        while "build bunny.obj" not in said:
            said += os.read(screen, 4096).decode()
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        with suppress(OSError):  # that nobody holds the terminal any more
            while text := os.read(screen, 4096):
                said += text.decode()
        assert process.wait(timeout=30) == 130
    finally:
        process.kill()
        process.wait()
        os.close(screen)
    assert "Traceback" not in said
    assert "stopped" in said
    assert list(tmp_path.iterdir()) == []
