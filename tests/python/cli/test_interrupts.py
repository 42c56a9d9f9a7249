"""Ctrl-C at any moment of the program ``voxshell``: exit code 130, at most a short line, no file."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = Path(sys.executable).with_name("voxshell")

# Sent from within, as a module is about to be imported or as the program ends: at the same moment in
# every run.
INTERRUPT = """
import atexit, os, signal, sys

WHEN = os.environ["INTERRUPT_AT"]

def interrupt(*_):
    os.kill(os.getpid(), signal.SIGINT)

if "--multiprocessing-fork" in sys.orig_argv:
    pass
elif WHEN == "exit":
    atexit.register(interrupt)
else:
    sys.addaudithook(lambda event, args: event == "import" and args[0] == WHEN and interrupt())
"""


@pytest.fixture
def interrupted(tmp_path, monkeypatch):
    hook = tmp_path / "hook"
    hook.mkdir()
    (hook / "sitecustomize.py").write_text(INTERRUPT)
    folder = tmp_path / "work"
    folder.mkdir()
    monkeypatch.setenv("PYTHONPATH", str(hook))

    def run(when: str, command: str, **options) -> subprocess.CompletedProcess[str]:
        monkeypatch.setenv("INTERRUPT_AT", when)
        ended = subprocess.run(
            [PROGRAM, *command.split()], cwd=folder, capture_output=True, text=True, **options
        )
        assert [path for path in folder.rglob("*") if path.is_file()] == []
        return ended

    return run


@pytest.mark.parametrize(
    "when", ["voxshell", "numpy", "voxshell._core", "voxshell.cli", "cyclopts", "rich.console"]
)
def test_what_is_imported_first_may_be_interrupted(interrupted, when):
    ended = interrupted(when, "cache path")
    assert (ended.returncode, ended.stdout, ended.stderr) == (130, "", "")


@pytest.mark.parametrize(
    ("when", "command"),
    [
        ("trimesh", "info {mesh}"),
        ("scipy.spatial", "build {mesh} -o cone.vxs"),
        ("viser", "view {mesh} --export cone.html"),
        # Imported by trimesh, which goes on without what it cannot import.
        ("networkx", "reproduce peers --quick --only coal --out peers"),
    ],
)
def test_what_a_command_imports_may_be_interrupted(interrupted, when, command, cone_path):
    ended = interrupted(when, command.format(mesh=cone_path))
    *progress, last = ended.stderr.splitlines()
    assert (ended.returncode, ended.stdout, last) == (130, "", "stopped")
    assert all(" left " in line for line in progress if line)


def test_the_end_may_be_interrupted(interrupted):
    ended = interrupted("exit", "--version")
    assert (ended.returncode, ended.stderr) == (130, "")
    assert ended.stdout.strip()


def test_a_program_in_the_background_goes_on_ignoring_interrupts(interrupted):
    ended = interrupted(
        "cyclopts",
        "--version",
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN),
    )
    assert (ended.returncode, ended.stderr) == (0, "")


def test_interrupts_of_the_caller_stay_as_they_were(voxshell):
    handlers = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGALRM)]
    assert voxshell("cache", "path").code == 0
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGALRM)] == handlers
