"""The references name everything that is public, once."""

from __future__ import annotations

import dataclasses
import re
from collections import Counter
from pathlib import Path

import list_reference
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


def test_the_tables_of_the_python_reference_are_those_of_the_present_names():
    page = list_reference.PAGE.read_text(encoding="utf-8")
    assert list_reference.complete(page) == page, (
        "the tables of docs/api/python.md are out of date: run "
        "`.venv/bin/python tools/list_reference.py --write` and commit the page"
    )


def test_every_public_name_has_a_summary_in_the_python_reference():
    page = list_reference.PAGE.read_text(encoding="utf-8")
    rows = re.findall(r"^\| `([\w.]+)` \| (.*?) \| (.*?) \|$", page, re.M)
    named = Counter(name for name, _, _ in rows if "." not in name)
    assert named == Counter(vx.__all__)
    for name, summary, members in rows:
        assert summary.endswith("."), name
        assert ":`" not in summary + members, name
    members = {name: members for name, _, members in rows}
    assert "`set_velocities()`" in members["Robot"]
    assert "`gravity`" in members["World"]
    assert "`load_mjcf`" not in members["World"]  # an absent name, with a hint
    assert members["wrench"].startswith("`a`, `b`, `a_pose`")


def test_tables_are_renewed(monkeypatch, tmp_path, capsys):
    block = "```{eval-rst}\n.. autofunction:: voxshell.pose\n```\n"
    page = tmp_path / "python.md"
    page.write_text(f"# Python\n\n{block}")
    monkeypatch.setattr(list_reference, "PAGE", page)
    assert list_reference.main(["--write"]) == 0
    text = page.read_text()
    assert "| `pose` | Make a pose from" in text
    assert text.endswith(f"<!-- end of names -->\n\n{block}")
    assert list_reference.main([]) == 0
    assert capsys.readouterr().out == text
    assert list_reference.main(["--renew"]) == 2


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
