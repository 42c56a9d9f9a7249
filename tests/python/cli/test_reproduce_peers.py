from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest
from voxshell.measuring.units import format_time


def reproduce_peers(*arguments):
    return subprocess.run(
        [sys.executable, "-c", "from voxshell.cli import main; main()", "reproduce", "peers"]
        + [str(argument) for argument in arguments],
        capture_output=True,
        text=True,
        timeout=120,
        env={**os.environ, "COLUMNS": "80", "NO_COLOR": "1"},
    )


@pytest.fixture(scope="module")
def settings(tmp_path_factory):
    path = tmp_path_factory.mktemp("settings") / "brief.toml"
    path.write_text("[peers]\ncase_seconds = 0.0\nrates = [20]\ndrop_seconds = 1.0\n")
    return path


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    return tmp_path_factory.mktemp("peers")


@pytest.fixture(scope="module")
def printed(settings, out):
    """coal and our models in Bullet, in brief."""
    return reproduce_peers(
        "--out", out, "--settings", settings, "--only", "coal", "voxshell-bullet-analytic"
    )


def test_tables_fit_a_terminal_and_files_are_written(printed, settings, out):
    assert printed.returncode == 0, printed.stderr
    for word in ("coal", "voxshell in", "plane 1.0", "pair 73.6", "413", "Dropped on the box"):
        assert word in printed.stdout, word
    tables = printed.stdout.splitlines()[:-1]  # a path stands last
    assert max(map(len, tables)) <= 80
    for name in ("peers.json", "cases.csv", "drops.csv", "peers.md", "rows", "logs"):
        assert (out / name).exists(), name
    page = (out / "peers.md").read_text()
    assert f"--settings {settings} --only coal voxshell-bullet-analytic\n" in page


def test_second_run_reads_what_the_first_measured(printed, settings, out):
    again = reproduce_peers(
        "--out", out, "--settings", settings, "--only", "coal", "voxshell-bullet-analytic", "--json"
    )
    assert again.returncode == 0, again.stderr
    data = json.loads(again.stdout)
    assert [row["key"] for row in data["peers"]] == ["voxshell-bullet-analytic", "coal"]
    assert [row["status"] for row in data["peers"]] == ["measured", "measured"]
    median = data["peers"][1]["cases"][0]["median"]
    assert format_time(median) in printed.stdout


@pytest.mark.parametrize(
    ("arguments", "table", "message"),
    [
        (("--only", "coral"), "", "unknown peer 'coral'; valid peers: voxshell, "),
        ((), "rate = [20]", "peers.rate: unknown setting; valid settings: case_seconds, rates"),
        ((), "rates = [0]", "peers.rates must be above 0, not 0"),
        ((), "time_limit = -1", "peers.time_limit must be above 0, not -1"),
    ],
)
def test_wrong_requests_are_errors_that_say_what_there_is(tmp_path, arguments, table, message):
    path = tmp_path / "settings.toml"
    path.write_text(f"[peers]\n{table}\n")
    result = reproduce_peers("--out", tmp_path / "out", "--settings", path, *arguments)
    assert result.returncode == 2
    assert message in " ".join(result.stderr.split())
    assert not (tmp_path / "out").exists()
