"""Ctrl-C at any moment of the program ``voxshell``: exit code 130, at most a short line, no file."""

from __future__ import annotations

import os
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

# Sent to program and workers, as a terminal does, at a moment of the first worker's start.
INTERRUPT_ALL = """
import os, signal, sys

WHEN = os.environ["INTERRUPT_AT"]
WORKER = "--multiprocessing-fork" in sys.orig_argv

def interrupt_all():
    try:
        os.close(os.open(os.environ["INTERRUPTED"], os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        return
    os.killpg(0, signal.SIGINT)

def imports(event, args):
    return event == "import" and args[0] == WHEN

def start(path, args, *others):
    worker = spawn(path, args, *others)
    if "--multiprocessing-fork" in args:
        interrupt_all()
    return worker

if WHEN == "has not been told what to do" and not WORKER:
    from multiprocessing import util

    spawn, util.spawnv_passfds = util.spawnv_passfds, start
elif WHEN == "begins" and WORKER:
    interrupt_all()
elif WORKER:
    sys.addaudithook(lambda event, args: imports(event, args) and interrupt_all())
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


@pytest.mark.parametrize(
    "command", ["reproduce rates --quick --jobs 2", "reproduce peers --quick --only coal"]
)
@pytest.mark.parametrize(
    "when",
    ["has not been told what to do", "begins", "multiprocessing.spawn", "numpy", "voxshell"],
)
def test_workers_say_nothing_of_an_interrupt_while_they_start(when, command, tmp_path):
    (tmp_path / "sitecustomize.py").write_text(INTERRUPT_ALL)
    told = tmp_path / "interrupted"
    changes = {"PYTHONPATH": str(tmp_path), "INTERRUPT_AT": when, "INTERRUPTED": str(told)}
    process = subprocess.Popen(
        [PROGRAM, *command.split(), "--out", tmp_path / "out"],
        env={**os.environ, **changes},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # A group of its own; in the background, tests may be started with interrupts ignored.
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    # Also until the last worker, which has the same standard error, is gone.
    output, errors = process.communicate()
    assert told.exists()
    *progress, last = errors.splitlines()
    assert (process.returncode, output, last) == (130, "", "stopped"), errors
    assert all(" left " in line for line in progress if line), errors


def test_interrupts_of_the_caller_stay_as_they_were(voxshell):
    handlers = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGALRM)]
    assert voxshell("cache", "path").code == 0
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGALRM)] == handlers
