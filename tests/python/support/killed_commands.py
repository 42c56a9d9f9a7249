"""Commands that are killed at some moment, and run again."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import trimesh
from write_faults import LITTER, SCENE, TINY

SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
PROGRAM = "import sys; from voxshell_program import main; main()"
CACHE = """
import sys, trimesh, voxshell as vx
from voxshell.model import cache
cache.WORTH_SECONDS = 0.0
for resolution in range(4, 20):
    vx.Model.from_mesh(trimesh.load_mesh(sys.argv[1]), resolution=resolution)
"""


def list_commands(place: Path) -> dict[str, Callable[[Path], list[object]]]:
    """Commands by name, which write into a folder; files that they read are made in `place`."""
    mesh, scene, settings = place / "ball.stl", place / "scene.toml", place / "tiny.toml"
    trimesh.creation.icosphere(4, 0.1).export(mesh)
    scene.write_text(SCENE)
    settings.write_text(TINY)
    program = [sys.executable, "-c", PROGRAM]
    reproduce = ["reproduce", "slope", "--quick", "--settings", settings]
    return {
        "build": lambda folder: [
            *(*program, "build", mesh, "-o", folder / "ball.vxs", "--resolution", 60)
        ],
        "simulate": lambda folder: [*program, "simulate", scene, "--out", folder / "out"],
        "reproduce": lambda folder: [*program, *reproduce, "--out", folder / "out"],
        "cache": lambda folder: [sys.executable, "-c", CACHE, mesh],
    }


def run(command: list[object], folder: Path) -> None:
    """Runs a command to its end.

    Raises:
        AssertionError: It fails, or leaves something unfinished in the folder or in the cache below it.
    """
    ended = subprocess.run(**_arguments(command, folder), timeout=300)
    assert ended.returncode == 0, ended.stderr
    left = [path for path in folder.rglob("*") if LITTER.fullmatch(path.name)]
    assert not left, f"{left} left"


def kill(command: list[object], folder: Path, seconds: float, number: int) -> bool:
    """Starts a command and sends it a signal after a while; returns whether it had not ended before.

    Raises:
        AssertionError: It says more than a line of error, or its workers stay.
    """
    with subprocess.Popen(**_arguments(command, folder), start_new_session=True) as process:
        with suppress(subprocess.TimeoutExpired):
            process.wait(seconds)
        lived = process.poll() is None
        if lived:
            process.send_signal(number)
        _, errors = process.communicate(timeout=60)
        assert "Traceback" not in errors or command[2] == CACHE, errors
        patience = time.monotonic() + 30.0
        with suppress(ProcessLookupError):
            while True:
                os.killpg(process.pid, 0)
                assert time.monotonic() < patience, "workers outlive the command"
                time.sleep(0.01)
    return lived


def _arguments(command: list[object], folder: Path) -> dict:
    settings = {"VOXSHELL_CACHE_DIR": str(folder / "cache"), "VOXSHELL_CACHE_SIZE": "1GB"}
    return {
        "args": [str(word) for word in command],
        "env": {**os.environ, **settings},
        "stdout": subprocess.PIPE,
        "stderr": subprocess.PIPE,
        "text": True,
    }
