from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest
import trimesh
import voxshell as vx


@pytest.fixture
def folder(tmp_path, monkeypatch):
    folder = tmp_path / "models"
    monkeypatch.setenv("VOXSHELL_CACHE_DIR", str(folder))
    monkeypatch.setenv("VOXSHELL_CACHE_SIZE", "1GB")
    return folder


@pytest.fixture
def two_models(folder, monkeypatch):
    monkeypatch.setattr("voxshell.model.cache.WORTH_SECONDS", 0.0)
    for resolution in (5, 6):
        vx.Model.from_mesh(trimesh.creation.box(), resolution=resolution)
    return sum(file.stat().st_size for file in folder.iterdir())


def voxshell_cache(*arguments):
    return subprocess.run(
        [sys.executable, "-c", "from voxshell.cli import main; main()", "cache", *arguments],
        capture_output=True,
        text=True,
        timeout=60,
        env={**os.environ, "COLUMNS": "80", "NO_COLOR": "1"},
    )


def test_path_is_where_the_environment_says(folder):
    result = voxshell_cache("path")
    assert (result.returncode, result.stdout) == (0, f"{folder}\n")


def test_list_and_size_say_what_is_there(folder, two_models):
    listed = voxshell_cache("list")
    assert listed.returncode == 0, listed.stderr
    assert "2 models" in listed.stdout
    for file in folder.iterdir():
        assert file.name[:16] in listed.stdout
    entries = json.loads(voxshell_cache("list", "--json").stdout)
    assert {f"{entry['key']}-{entry['seal']}.vxs" for entry in entries} == set(os.listdir(folder))
    assert entries[0]["used"] >= entries[1]["used"]
    sized = voxshell_cache("size")
    assert sized.stdout == (
        f"2 models, {two_models / 1e6:.1f} MB of at most 1000 MB, in {folder}\n"
    )
    expected = {"models": 2, "size": two_models, "capacity": 10**9}
    assert json.loads(voxshell_cache("size", "--json").stdout) == expected


def test_list_names_the_meshes(folder, tmp_path, monkeypatch):
    monkeypatch.setattr("voxshell.model.cache.WORTH_SECONDS", 0.0)
    path = tmp_path / "part.stl"
    trimesh.creation.box().export(path)
    vx.Model.from_mesh(path, resolution=5)
    assert "part.stl" in voxshell_cache("list").stdout
    assert [entry["name"] for entry in json.loads(voxshell_cache("list", "--json").stdout)] == [
        "part.stl"
    ]


def test_clear_removes_them(folder, two_models):
    assert voxshell_cache("clear").stdout == "removed 2 models\n"
    assert os.listdir(folder) == []
    assert voxshell_cache("clear").stdout == "removed 0 models\n"
    assert "0 models, 0.0 MB" in voxshell_cache("list").stdout


def test_a_wrong_size_is_an_error(folder, monkeypatch):
    monkeypatch.setenv("VOXSHELL_CACHE_SIZE", "much")
    result = voxshell_cache("size")
    assert result.returncode == 2
    assert "VOXSHELL_CACHE_SIZE must be a size" in result.stderr
