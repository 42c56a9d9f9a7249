from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import trimesh


def run_program(*arguments):
    return subprocess.run(
        [sys.executable, "-c", "from voxshell.cli import main; main()", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=120,
        env={**os.environ, "COLUMNS": "80", "NO_COLOR": "1"},
    )


SMALL = ("--up", "z", "--size", "0.1", "--voxel-size", "0.005")
SMALL += ("--fine-points", "1000", "--coarse-points", "200")


@pytest.fixture(scope="module")
def dropped(tmp_path_factory, cone_path):
    """A small drop with all methods: what it printed, and the folder that it wrote."""
    out = tmp_path_factory.mktemp("drop") / "a" / "b"
    result = run_program(
        "simulate", "drop", cone_path, "--out", out, *SMALL, "--steps", 300, "--slow-steps", 60
    )
    return result, out


def test_drop_prints_a_table_and_writes_three_files(dropped):
    result, out = dropped
    assert result.returncode == 0, result.stderr
    assert sorted(p.name for p in out.iterdir()) == ["curves.png", "index.html", "results.json"]
    for label in ("VPS fine", "VPS coarse", "GImpact", "Convex hull", "Decomposition"):
        assert label in result.stdout
    assert "GImpact (60 steps)" in result.stdout
    assert max(map(len, result.stdout.splitlines()[:12])) <= 80
    assert result.stderr == "", "progress would fill logs"
    results = json.loads((out / "results.json").read_text())
    assert [m["steps"] for m in results["methods"]] == [300, 300, 300, 60, 300, 300, 300]


def test_page_plays_offline(dropped, play):
    _, out = dropped
    player = play(out / "index.html")
    # The bodies are green, red, blue and amber; the stage is not colored.
    player.wait(lambda p: int(np.sum(np.ptp(p, axis=2) > 60)) > 100, "no body is seen")
    assert "cone dropped 0.5 m at 200 Hz" in player.page.inner_text("#voxshell-heading")
    assert player.complaints == []
    assert player.fetched == [(out / "index.html").as_uri()]


def test_json_is_all_that_stdout_holds(voxshell, tmp_path, cone_path):
    result = voxshell(
        *("simulate", "drop", cone_path, "--out", tmp_path, *SMALL),
        *("--steps", 260, "--methods", "vps-fine", "hull", "--json"),
    )
    assert result.code == 0, result.err
    rows = result.json
    assert [row["key"] for row in rows] == ["vps-fine", "hull"]
    assert rows[0]["ratio"] == 1.0


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (["missing.stl"], "missing.stl"),
        (["--steps", "0"], "steps"),
        (["--size", "-1"], "size"),
        (["--rate", "0"], "rate"),
        (["--voxel-size", "1e-7"], "voxel size"),
        (["--methods", "magic"], "magic"),
    ],
)
def test_bad_input_is_an_error_that_names_it(voxshell, tmp_path, arguments, part):
    result = voxshell("simulate", "drop", *arguments, "--out", tmp_path / "out")
    assert result.code != 0
    assert list(tmp_path.iterdir()) == []
    said = " ".join((result.out + result.err).split())
    assert part in said
    assert "Traceback" not in said


def test_mesh_without_area_is_refused_with_its_path(voxshell, tmp_path):
    path = tmp_path / "line.stl"
    corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]
    trimesh.Trimesh(corners, [[0, 1, 2]], process=False).export(path)
    result = voxshell("simulate", "drop", path, "--out", tmp_path / "out", *SMALL)
    assert result.code == 2
    said = result.err.replace("\n", "")
    assert "area" in said
    assert "line.stl" in said


def test_help_teaches(voxshell):
    result = voxshell("simulate", "drop", "--help")
    assert result.code == 0
    for word in ("--fine-points", "part.stl", "results.json", "meters"):
        assert word in result.out
    assert "simulate" in voxshell("--help").out


@pytest.mark.parametrize(
    ("problem", "ending"), [(OSError, (1, "disk full")), (KeyboardInterrupt, (130, "stopped"))]
)
def test_nothing_is_left_of_what_was_not_finished(
    tmp_path, cone_path, monkeypatch, capsys, problem, ending
):
    from voxshell.cli import main
    from voxshell_studies.report import drop

    def fail(*_):
        raise problem("disk full")

    monkeypatch.setattr(drop, "draw_curves", fail)
    command = ["simulate", "drop", str(cone_path), *SMALL, "--steps", "260", "--methods", "hull"]
    older = tmp_path / "older"
    older.mkdir()
    for name in ("results.json", "curves.png", "index.html"):
        (older / name).write_text("older")
    for out in (tmp_path / "new" / "folder", older):
        with pytest.raises(SystemExit) as ended:
            main([*command, "--out", str(out)])
        said = capsys.readouterr().err
        assert (ended.value.code, ending[1] in said) == (ending[0], True), said
        assert ".unfinished" not in said
    assert list(tmp_path.iterdir()) == [older]
    assert [path.read_text() for path in older.iterdir()] == ["older"] * 3


def test_ctrl_c_ends_with_130_and_no_folder(tmp_path, cone_path):
    process = subprocess.Popen(
        [
            *(Path(sys.executable).with_name("voxshell"), "simulate", "drop", cone_path),
            *("--out", tmp_path / "out", "--steps", "10000000", *SMALL),
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    time.sleep(4.0)
    process.send_signal(signal.SIGINT)
    try:
        _, errors = process.communicate(timeout=30)
    finally:
        process.kill()
    assert process.returncode == 130
    assert "Traceback" not in errors
    assert list(tmp_path.iterdir()) == []
