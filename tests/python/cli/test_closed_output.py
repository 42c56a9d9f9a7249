"""What commands do when whoever reads their output goes away, as in ``voxshell info part.stl | true``, or it is full."""

from __future__ import annotations

import os
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
