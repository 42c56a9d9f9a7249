from __future__ import annotations

import os
from pathlib import Path

import pytest
import voxshell as vx
from voxshell.base.input_files import read_small_file


def test_a_file_of_the_largest_size_is_read_whole(tmp_path: Path):
    path = tmp_path / "scene.toml"
    path.write_bytes(b"abc")
    assert read_small_file(path, 3) == read_small_file(str(path), 4) == b"abc"


def test_what_cannot_be_read_is_named(tmp_path: Path):
    large, pipe = tmp_path / "large", tmp_path / "pipe"
    large.write_bytes(b"abcd")
    os.mkfifo(pipe)
    for path, told in (
        (tmp_path / "none", "scene file does not exist: "),
        (tmp_path, "cannot read scene file .* it is a folder"),
        (pipe, "not a regular file"),
        (large, "has 4 bytes; at most 3 are read"),
    ):
        with pytest.raises(vx.SettingsError, match=told) as caught:
            read_small_file(path, 3, "scene file")
        assert str(path) in str(caught.value)
    with pytest.raises(vx.FileAccessError, match="cannot read "):
        read_small_file("a\0b", 3)
