from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import urllib.request

import pytest


def test_a_page_is_exported(voxshell, cone_model_path, tmp_path):
    page = tmp_path / "cone.html"
    ended = voxshell("view", cone_model_path, "plane", "--show", "slice", "--export", page)
    assert (ended.code, ended.out) == (0, f"wrote {page}\n")
    assert "<title>cone.vxs</title>" in page.read_text(encoding="utf-8")


def test_a_file_name_that_is_not_unicode_is_shown_with_question_marks(
    voxshell, cone_model_path, tmp_path
):
    body = os.fsdecode(os.fsencode(tmp_path) + b"/n\xff\xfe.vxs")
    shutil.copyfile(cone_model_path, body)
    page = tmp_path / "cone.html"
    ended = voxshell("view", body, "--export", page)
    assert (ended.code, ended.err) == (0, "")
    assert "<title>n??.vxs</title>" in page.read_text(encoding="utf-8")


def test_a_page_is_served_until_ctrl_c(cone_model_path):
    code = "from voxshell.cli import main; import sys; main(sys.argv[1:])"
    command = [sys.executable, "-c", code, "view", str(cone_model_path), "--port", "0"]
    served = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert served.stdout is not None
    address = served.stdout.readline().split()[0]
    with urllib.request.urlopen(address) as answer:
        assert b"<html" in answer.read().lower()
    os.kill(served.pid, signal.SIGINT)
    assert served.wait(timeout=30) == 130
    served.communicate()


def test_without_viser_no_mesh_is_read(voxshell, monkeypatch):
    monkeypatch.setitem(sys.modules, "viser", None)
    ended = voxshell("view", "missing.stl")
    assert ended.code == 1
    assert "pip install 'voxshell[viewer]'" in " ".join(ended.err.split())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [(["sphere:0.1"], "has no field and no points"), (["missing.stl"], "does not exist")],
)
def test_what_cannot_be_shown_is_refused(voxshell, arguments, message):
    ended = voxshell("view", *arguments)
    assert ended.code == 2
    assert message in " ".join(ended.err.split())


def test_a_port_that_does_not_exist_is_refused(voxshell, cone_model_path):
    ended = voxshell("view", cone_model_path, "--port", "99999")
    assert ended.code == 2
    assert "port must be from 0 to 65535, not 99999" in ended.err
