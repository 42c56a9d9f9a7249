#!/usr/bin/env python3
"""Does what a new user does first, and prints how long each step takes.

usage: tools/first_minutes.py [--wheels DIR] [PYTHON...]

With each PYTHON, by default the one that runs this, and in a new environment in a temporary folder: installs the
wheel of DIR, by default build/dist, with the extra for replays; runs the ten lines of README.md on a mesh; watches
a world live, as far as the page and its first data; installs the extra for videos, and writes one. Prints a Markdown
table. pip takes what it keeps in its cache; PIP_NO_CACHE_DIR=1 makes it download everything. Fails if a step does.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TEN_LINES = "ten lines on a mesh: model, contacts, drop, replay"
WATCH = """
import urllib.request, voxshell as vx
world = vx.World()
world.add(vx.Plane(), mass=0)
world.add(vx.Model.from_mesh("part.stl", scale=0.001), mass=0.2, pose=(0, 0, 0.1))
with world.view(port=0) as view:
    world.step(20)
    page = urllib.request.urlopen(view.address).read()
assert len(page) > 100_000, len(page)
"""
FILM = """
import imageio.v2, voxshell as vx
world = vx.World()
world.add(vx.Plane(), mass=0)
world.add(vx.Model.from_mesh("part.stl", scale=0.001), mass=0.2, pose=(0, 0, 0.1))
recorder = world.record()
world.step(400)
recorder.recording().save_video("drop.mp4")
assert sum(1 for _ in imageio.v2.get_reader("drop.mp4")) >= 59
"""


def main(arguments: list[str]) -> int:
    """The command line; returns the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--wheels", type=Path, default=ROOT / "build/dist")
    parser.add_argument("pythons", nargs="*", metavar="PYTHON", default=[sys.executable])
    options = parser.parse_args(arguments)
    columns = {}
    for python in options.pythons:
        version = "import sys; print('Python %d.%d' % sys.version_info[:2])"
        name = subprocess.check_output([python, "-c", version], text=True).strip()
        with tempfile.TemporaryDirectory() as folder:
            columns[name] = time_steps(python, options.wheels.resolve(), Path(folder).resolve())
    print("\n".join(format_table(columns)))
    return 0


def format_table(columns: dict[str, dict[str, float]]) -> list[str]:
    """Lines of a Markdown table: a column with the seconds of each step, and sums up to the ten lines and in all."""

    def row(step: str, seconds: Iterable[float]) -> str:
        return "| ".join([f"| {step} ", *(f"{each:.0f} s " for each in seconds)]) + "|"

    took = list(columns.values())
    lines = [f"| step | {' | '.join(columns)} |", "|---" * (1 + len(columns)) + "|"]
    for number, step in enumerate(took[0], 1):
        lines.append(row(step, [each[step] for each in took]))
        if step == TEN_LINES:
            lines.append(row("so far", [sum(list(each.values())[:number]) for each in took]))
    return [*lines, row("all", [sum(each.values()) for each in took])]


def time_steps(python: str, wheels: Path, folder: Path) -> dict[str, float]:
    """Seconds of each step."""
    inside = str(folder / "env/bin/python")
    install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--find-links"]
    commands = {
        "make an environment": [python, "-m", "venv", str(folder / "env")],
        "install voxshell[viewer]": [inside, *install, str(wheels), "voxshell[viewer]"],
        TEN_LINES: [inside, "-I", str(ROOT / "tools/try_readme.py")],
        "a live view: its page and first data": [inside, "-I", "-c", WATCH],
        "install voxshell[video]": [inside, *install, str(wheels), "voxshell[video]"],
        "a video of two seconds": [inside, "-I", "-c", FILM],
    }
    # Nothing of this checkout, and no models built before.
    environment = {"PATH": os.defpath, "HOME": str(folder), "LANG": "C.UTF-8"}
    installing = {
        name: value
        for name, value in os.environ.items()
        if name.startswith("PIP_") or name.lower().endswith("_proxy")
    }
    took = {}
    for step, command in commands.items():
        # pip keeps its downloads in the user's folder.
        own = {"HOME": str(Path.home()), **installing} if "pip" in command else {}
        print(f"{step} ...", file=sys.stderr, flush=True)
        start = time.perf_counter()
        subprocess.run(
            command, check=True, cwd=folder, env=environment | own, stdout=subprocess.DEVNULL
        )
        took[step] = time.perf_counter() - start
    return took


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
