"""The table of robots: what it finds in folders, and what it writes of each file."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
import try_robots

ROOT = Path(__file__).resolve().parents[3]
LINK = """<link name="a"><inertial><mass value="1"/><inertia ixx="{}" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>
  </inertial><collision><geometry><sphere radius="0.1"/></geometry></collision></link>"""
GOOD = f'<robot name="good">{LINK.format(1)}</robot>'
PENDULUM = (
    f'<robot name="pendulum"><link name="base"/>{LINK.format(0)}<joint name="x" type="continuous">'
    '<parent link="base"/><child link="a"/></joint></robot>'
)
BAD = '<robot name="bad"></robot>'


def write(folder: Path, **texts: str) -> None:
    folder.mkdir(parents=True)
    for name, text in texts.items():
        (folder / f"{name}.urdf").write_text(text)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    folder = tmp_path / "robots"
    write(folder / "arms", good=GOOD, pendulum=PENDULUM)
    write(folder / "legs" / "deep", bad=BAD)
    return folder


def test_the_page_says_what_became_of_each_file(folder, tmp_path, capsys):
    page = tmp_path / "robots-tested.md"
    assert try_robots.main([str(folder), "--steps", "2", "--write", str(page)]) == 0
    lines = page.read_text().splitlines()
    assert "| arms | 2 | 2 | 1 | 0 |" in lines
    assert "| legs | 1 | 0 | 0 | 1 |" in lines
    assert "| all | 3 | 2 | 1 | 1 |" in lines
    assert "| arms | good.urdf | 1 | 0 | loads |  |" in lines
    assert "| arms | pendulum.urdf | 2 | 1 | loads, with a warning |  |" in lines
    assert (
        "| legs | bad.urdf |  |  | refused | RobotError: bad.urdf: it has no &lt;link> |" in lines
    )
    assert str(tmp_path) not in page.read_text().rsplit("```", 1)[1]
    kept = (ROOT / "docs/robots-tested.md").read_text().split("freely for", 1)[0]
    assert page.read_text().startswith(kept)
    assert "2 of 3 files load" in capsys.readouterr().out


def test_models_of_mujoco_are_found_by_their_root(tmp_path):
    folder = tmp_path / "models"
    folder.mkdir()
    model = "<mujoco><worldbody><body><joint/><geom size='1'/></body></worldbody></mujoco>"
    (folder / "good.xml").write_text(f"<?xml version='1.0'?>\n<!-- a ball -->\n{model}")
    (folder / "part.xml").write_text("<mujocoinclude/>")
    (folder / "other.xml").write_text("<robot><mujoco/></robot>")
    (folder / "bad.xml").write_text("<mujoco/>")
    page = tmp_path / "mjcf-tested.md"
    arguments = [str(folder), "--format", "mjcf", "--steps", "2", "--write", str(page)]
    assert try_robots.main(arguments) == 0
    lines = page.read_text().splitlines()
    assert "| all | 2 | 1 | 0 | 1 |" in lines
    assert any(line.endswith("| good.xml | 2 | 1 | loads |  |") for line in lines)
    assert "--format mjcf --mesh-as hull --steps 2" in page.read_text()
    kept = (ROOT / "docs/mjcf-tested.md").read_text().split("freely for", 1)[0]
    assert page.read_text().startswith(kept)


def test_files_of_an_installed_package_have_its_name_and_version(folder):
    facts = folder / "arms_of_all_kinds-1.2.dist-info"
    facts.mkdir()
    (facts / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: arms-of-all-kinds\nVersion: 1.2\n"
    )
    (facts / "RECORD").write_text("arms/good.urdf,,\n../../share/shared.urdf,,\n")
    write(folder / "share", shared=GOOD)
    found = {path.name: package for package, path in try_robots.find_robots(folder)}
    assert found == {
        "good.urdf": "arms-of-all-kinds 1.2",
        "pendulum.urdf": "arms",
        "bad.urdf": "legs",
        "shared.urdf": "arms-of-all-kinds 1.2",
    }


def test_many_files_that_load_alike_share_a_row():
    loads = try_robots.Outcome("loads", links=1)
    outcomes = {("toys 1", Path(f"/toys/all/{i:03}/toy.urdf")): loads for i in range(120)}
    outcomes["toys 1", Path("/toys/bad/bad.urdf")] = try_robots.Outcome("refused", "a | b")
    table = try_robots.make_table(outcomes)
    assert "| toys 1 | all/\\*/\\*.urdf (120 files) | 1 | 0 | loads |  |" in table
    assert "| toys 1 | bad/bad.urdf |  |  | refused | a \\| b |" in table
    assert table.count("\n") == 9


def test_a_file_that_ends_the_process_fails_and_the_next_is_tried(folder, tmp_path, monkeypatch):
    python = tmp_path / "python"
    python.write_text(
        "#!/bin/sh\nfor last; do :; done\n"
        'case "$*" in *good.urdf*) exit 3;; *) echo \'{"result": "loads", "links": 7}\';; esac\n'
    )
    os.chmod(python, 0o755)
    monkeypatch.setattr(try_robots.sys, "executable", str(python))
    paths = [folder / "arms/good.urdf", folder / "arms/pendulum.urdf"]
    first, second = try_robots.try_apart(paths, "urdf", "hull", 1)
    assert first == try_robots.Outcome("fails", "the process ends with 3")
    assert second == try_robots.Outcome("loads", links=7)


def test_a_folder_without_robots_is_said(tmp_path, capsys):
    assert try_robots.main([str(tmp_path)]) == 1
    assert f"no URDF file below {tmp_path}" in capsys.readouterr().out


@pytest.mark.parametrize("name", ["robots", "mjcf"])
def test_the_guides_state_the_counts_of_the_tables(name):
    guide = (ROOT / f"docs/{name}.md").read_text()
    stated = re.search(
        r"([\d,]+) of the ([\d,]+) \w+ files of (\d+) packages load, ([\d,]+) of", guide
    )
    assert stated is not None
    loaded, files, packages, warned = (int(text.replace(",", "")) for text in stated.groups())
    summary = (ROOT / f"docs/{name}-tested.md").read_text().split("| package | file | links")[0]
    rows = re.findall(r"^\| (.+) \| (\d+) \| (\d+) \| (\d+) \| (\d+) \|$", summary, re.M)
    assert len(rows) - 1 == packages
    assert rows[-1] == ("all", str(files), str(loaded), str(warned), str(files - loaded))
