from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path

import pytest
import voxshell as vx
from voxshell.base.input_files import check_exists, read_needed_file, read_small_file
from voxshell.scenes.scene_file import read_scene

ENTRANCES: dict[str, Callable[[str], object]] = {
    "part.stl": vx.Model.from_mesh,
    "part.unknown": vx.Model.from_mesh,
    "model.vxs": vx.Model.load,
    "added.obj": lambda path: vx.World().add(path),
    "added.vxs": lambda path: vx.World().add(path),
    "robot.urdf": lambda path: vx.load_urdf(vx.World(), path),
    "model.xml": lambda path: vx.load_mjcf(vx.World(), path),
    "scene.toml": lambda path: read_scene(Path(path)),
}
"""Every function that reads a file, by the name of a file that does not exist."""


def test_a_file_of_the_largest_size_is_read_whole(tmp_path: Path):
    path = tmp_path / "scene.toml"
    path.write_bytes(b"abc")
    assert read_small_file(path, 3) == read_small_file(str(path), 4) == b"abc"


def test_what_cannot_be_read_is_named(tmp_path: Path):
    large, pipe = tmp_path / "large", tmp_path / "pipe"
    large.write_bytes(b"abcd")
    os.mkfifo(pipe)
    for path, told in (
        (tmp_path, "cannot read scene file .* it is a folder"),
        (pipe, "not a regular file"),
        (large, "has 4 bytes; at most 3 are read"),
    ):
        with pytest.raises(vx.SettingsError, match=told) as caught:
            read_small_file(path, 3, "scene file")
        assert str(path) in str(caught.value)
    with pytest.raises(vx.FileAccessError, match="cannot read "):
        read_small_file("a\0b", 3)


def test_a_file_that_is_needed_is_a_wrong_argument_if_it_cannot_be_read(tmp_path: Path):
    loop = tmp_path / "loop"
    loop.symlink_to("loop")
    with pytest.raises(vx.FileAccessError, match="loop: Too many levels of symbolic links"):
        read_small_file(loop, 3)
    with pytest.raises(vx.SettingsError, match="loop: Too many levels of symbolic links"):
        read_needed_file(loop, 3)
    with pytest.raises(vx.MissingFileError):
        read_needed_file(tmp_path / "missing", 3)


@pytest.mark.parametrize("name", ENTRANCES)
@pytest.mark.parametrize(
    "place", ["", "folder/", "file/"], ids=["beside", "no folder", "in a file"]
)
def test_a_missing_file_is_the_same_error_at_every_entrance(tmp_path: Path, name: str, place: str):
    (tmp_path / "file").write_text("not a folder")
    path = f"{tmp_path}/{place}{name}"
    message = re.escape(f"cannot read {path}: it does not exist")
    with pytest.raises(vx.MissingFileError, match=f"^{message}$") as caught:
        ENTRANCES[name](path)
    assert isinstance(caught.value, FileNotFoundError)
    assert isinstance(caught.value, vx.FileAccessError)


def test_a_missing_file_names_the_current_folder_and_a_similar_file(tmp_path: Path, monkeypatch):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "part.stl").write_text("")
    monkeypatch.chdir(tmp_path)
    parts, absolute = os.path.join("parts", ""), str(tmp_path / "parts" / "")
    for path, advice in (
        ("parts/part.stp", f"; the current folder is {tmp_path}; did you mean {parts}part.stl?"),
        (f"{absolute}/Part.stl", f"; did you mean {absolute}/part.stl?"),
        ("parts/gear.obj", f"; the current folder is {tmp_path}"),
        ("pars/part.stl", f"; the current folder is {tmp_path}"),
    ):
        message = re.escape(f"cannot read {path}: it does not exist{advice}")
        with pytest.raises(vx.MissingFileError, match=f"^{message}$"):
            vx.Model.from_mesh(path)


def test_what_exists_or_is_no_name_is_left_to_its_reader(tmp_path: Path):
    (tmp_path / "loop").symlink_to("loop")
    for path in (tmp_path, tmp_path / "loop", "a\0b", tmp_path / ("a" * 1000)):
        check_exists(path)


def test_a_link_to_nothing_does_not_exist(tmp_path: Path):
    (tmp_path / "link.stl").symlink_to("nowhere.stl")
    with pytest.raises(vx.MissingFileError, match=r"link\.stl: it does not exist"):
        check_exists(os.fsencode(tmp_path / "link.stl"))


@pytest.mark.parametrize("name", ENTRANCES)
def test_addresses_are_told_from_missing_files(name: str):
    with pytest.raises(
        vx.MissingFileError, match=f"{name}: it is a URL; download it, and pass the path"
    ):
        ENTRANCES[name](f"https://example.com/{name}")


def test_an_empty_path_is_called_empty():
    with pytest.raises(vx.MissingFileError, match=r"^cannot read '': the path is empty$"):
        vx.Model.from_mesh("")
