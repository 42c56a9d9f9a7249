"""What commands do when whoever reads their output goes away, as in ``voxshell info part.stl | true``, or it is full."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys

import pytest


@pytest.mark.parametrize("command", ["--help", "info {mesh}", "query {mesh} {mesh} --json"])
def test_closed_output_ends_a_command_quietly(command, cone_path):
    reads, writes = os.pipe()
    os.close(reads)
    with os.fdopen(writes, "wb") as output:
        arguments = command.format(mesh=cone_path).split()
        program = [sys.executable, "-c", "from voxshell.cli import main; main()", *arguments]
        ended = subprocess.run(program, stdout=output, stderr=subprocess.PIPE, text=True)
    assert ended.returncode == 1
    assert "Error" not in ended.stderr
    assert "error" not in ended.stderr


def test_a_full_disk_under_the_output_is_named():
    """The line gave the system's reason alone."""
    with open("/dev/full", "w") as output:
        program = [sys.executable, "-c", "from voxshell.cli import main; main()", "cache", "path"]
        ended = subprocess.run(program, stdout=output, stderr=subprocess.PIPE, text=True)
    assert ended.returncode == 1
    assert ended.stderr == "error: cannot write to standard output: No space left on device\n"


@pytest.mark.parametrize("streams", [">&-", "2>&-", "<&-", ">&- 2>&- <&-"])
def test_streams_that_are_closed_from_the_start_discard_what_is_printed(
    streams, cone_path, tmp_path
):
    code = "from voxshell.cli import main; main()"
    build = [
        "build",
        str(cone_path),
        "-o",
        str(tmp_path / "cone.vxs"),
        "--scale",
        "0.001",
        "--resolution",
        "20",
    ]
    for arguments in (build, ["info", str(tmp_path / "cone.vxs")], ["--help"]):
        program = shlex.join([sys.executable, "-c", code, *arguments])
        ended = subprocess.run(f"{program} {streams}", shell=True, capture_output=True, text=True)
        assert (ended.returncode, ended.stderr) == (0, "")
