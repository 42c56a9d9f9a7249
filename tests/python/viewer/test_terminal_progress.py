from __future__ import annotations

import os
import pty
import subprocess
import sys

import pytest

CODE = """
from voxshell.viewer.terminal_progress import on_terminal
with on_terminal("draw [fall].mp4") as tell:
    tell("draw", 0.25)
    tell("draw", 0.5)
print("done")
"""


def environment() -> dict[str, str]:
    without = ("TTY_COMPATIBLE", "FORCE_COLOR", "NO_COLOR")
    return {name: value for name, value in os.environ.items() if name not in without} | {
        "TERM": "xterm"
    }


def test_a_log_gets_nothing():
    done = subprocess.run(
        [sys.executable, "-c", CODE], capture_output=True, text=True, check=True, env=environment()
    )
    assert (done.stdout, done.stderr) == ("done\n", "")


def test_a_terminal_gets_a_bar():
    ours, theirs = pty.openpty()
    with subprocess.Popen(
        [sys.executable, "-c", CODE],
        stdout=subprocess.PIPE,
        stderr=theirs,
        text=True,
        env=environment(),
    ) as process:
        os.close(theirs)
        said = b""
        while True:
            try:
                part = os.read(ours, 4096)
            except OSError:  # the other end is closed
                break
            if not part:
                break
            said += part
        assert process.stdout is not None
        assert process.stdout.read() == "done\n"
    os.close(ours)
    assert b"draw [fall].mp4" in said
    assert b"50 %" in said


def test_an_error_in_the_block_is_raised():
    from voxshell.viewer.terminal_progress import on_terminal

    with pytest.raises(ZeroDivisionError), on_terminal("draw"):
        raise ZeroDivisionError
