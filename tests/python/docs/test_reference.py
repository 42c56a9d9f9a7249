"""The references name everything that is public, once."""

from __future__ import annotations

import dataclasses
import re
from collections import Counter
from pathlib import Path

import pytest
import voxshell as vx
from voxshell.scenes.body_settings import BodySettings
from voxshell.scenes.joint_settings import JointSettings
from voxshell.scenes.scene_settings import MeshSettings, OutputSettings, WorldSettings

ROOT = Path(__file__).resolve().parents[3]
API = ROOT / "docs/api"


def test_every_public_name_is_in_the_python_reference():
    text = (API / "python.md").read_text()
    named = Counter(re.findall(r"^\.\. auto\w+:: voxshell\.(\w+)$", text, re.M))
    assert set(vx.__all__) == set(dir(vx))
    assert named == Counter(vx.__all__)


@pytest.mark.parametrize(
    "settings", [WorldSettings, OutputSettings, MeshSettings, BodySettings, JointSettings]
)
def test_every_key_of_scene_files_is_in_the_scenes_that_the_page_shows(settings):
    page = (ROOT / "docs/scenes.md").read_text()
    scenes = [
        ROOT / "docs" / name for name in re.findall(r"literalinclude\} (\S+\.toml)$", page, re.M)
    ]
    shown = "".join(path.read_text() for path in scenes)
    keys = {field.name for field in dataclasses.fields(settings)}
    assert {key for key in keys if re.search(rf"\b{key}\b", shown)} == keys


def test_every_public_header_is_in_the_cpp_reference():
    text = (API / "cpp.md").read_text()
    blocks = re.findall(r"^```\{cpp-headers\}\n(.*?)^```", text, re.M | re.S)
    named = Counter(line for block in blocks for line in block.split())
    folders = (ROOT / "core/include", ROOT / "bullet/include")
    headers = [
        path.relative_to(folder).as_posix()
        for folder in folders
        for path in folder.glob("voxshell/**/*.h")
    ]
    assert len(headers) > 20
    assert named == Counter(headers)
