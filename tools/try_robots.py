#!/usr/bin/env python3
"""Loads every robot in some folders, and writes a table of the results.

usage: tools/try_robots.py [--format mjcf] [--mesh-as model] [--steps N] [--write PAGE] FOLDER...

The program searches each FOLDER for URDF files, or for MJCF files. If `pip install --target FOLDER` filled the folder, the
table names the package and version of each file; otherwise it names the first subfolder. A robot that
loads then moves freely for some steps, which finds robots that diverge. The program prints a line for
each file, and exits with 1 if a file neither loads nor is refused with a voxshell error.
"""

from __future__ import annotations

import argparse
import concurrent.futures
import csv
import json
import os
import re
import subprocess
import sys
import warnings
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from importlib.metadata import distributions
from pathlib import Path
from typing import Literal

TIME_LIMIT = 600.0
"""Seconds for one batch of files."""

BATCH = 20
"""Number of files that one process loads in turn: starting a process takes as long as loading a robot."""

MANY = 100
"""From this number on, files in sibling folders share a row of the table if all of them load."""

FORMATS = {"urdf": ".urdf", "mjcf": ".xml"}
"""Endings of the files of each format."""

MJCF_ROOT = re.compile(rb"\s*(<\?.*?\?>\s*|<!--.*?-->\s*)*<mujoco\b", re.DOTALL)

HEADS = {
    "urdf": """# Robots that were tested

This page lists what `vx.load_urdf` does with every URDF file of the packages below; [Robots](robots.md) explains how to use it.
Each robot that loads then moves freely for {steps} steps. Some files leave out masses, inertias, limits or collisions, have
joints that cannot begin at 0, or have elements that are not read. They load with a `RobotWarning`, which states what voxshell
used instead. The last column quotes the error of a refused file. The meshes were loaded {kind}. These commands write the page:

```
pip install --no-deps --target robots {packages}
{command}
```

""",
    "mjcf": """# MJCF files that were tested

This page lists what `vx.load_mjcf` does with every MJCF file of the packages below; [Models of MuJoCo](mjcf.md) explains how to
use it. Each model that loads then moves freely for {steps} steps. Files with elements that are not simulated load with a
warning. The last column quotes the error of a refused file. Most of the refused files are parts that other files include, or
name files that are not in the package; MuJoCo refuses `xarm7_gripper.xml`, too. The meshes were loaded {kind}. These commands
write the page:

```
pip install --no-deps --target robots {packages}
{command}
```

""",
}
"""Beginnings of the pages, docs/robots-tested.md and docs/mjcf-tested.md."""


@dataclass(frozen=True)
class Outcome:
    """The result for a file.

    Attributes:
        result: "loads", "refused", or "fails" if the error is not voxshell's or the process dies.
        reason: The text of the error; empty if it loads.
        warned: Whether the file left something out.
        links: Their number; 0 if it does not load.
        joints: The number of those that move.
    """

    result: Literal["loads", "refused", "fails"]
    reason: str = ""
    warned: bool = False
    links: int = 0
    joints: int = 0


def try_robot(path: str, kind: str, mesh_as: Literal["model", "hull"], steps: int) -> Outcome:
    """Loads one file into a world of its own."""
    import voxshell as vx

    world = vx.World()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            load = vx.load_urdf if kind == "urdf" else vx.load_mjcf
            robot = load(world, path, mesh_as=mesh_as)
            world.step(steps)
        except vx.VoxshellError as error:
            return Outcome("refused", f"{type(error).__name__}: {error}")
        except Exception as error:  # a defect, whatever it is
            return Outcome("fails", f"{type(error).__name__}: {error}")
    return Outcome(
        "loads",
        warned=any(issubclass(it.category, vx.RobotWarning) for it in caught),
        links=len(robot.links),
        joints=len(robot.joints) + len(robot.ball_joints),
    )


def try_apart(paths: list[Path], kind: str, mesh_as: str, steps: int) -> list[Outcome]:
    """Loads several files in other processes; a process that dies fails only the file that killed it."""
    outcomes: list[Outcome] = []
    while len(outcomes) < len(paths):
        command = [sys.executable, __file__, "--batch", "--format", kind]
        command += ["--mesh-as", mesh_as, "--steps", str(steps)]
        command += map(str, paths[len(outcomes) :])
        try:
            done = subprocess.run(command, capture_output=True, timeout=TIME_LIMIT)
            said, reason = done.stdout, f"the process ends with {done.returncode}"
        except subprocess.TimeoutExpired as late:
            said, reason = late.stdout or b"", f"takes more than {TIME_LIMIT:g} s"
        outcomes += [
            Outcome(**json.loads(line)) for line in said.splitlines(True) if _is_whole(line)
        ]
        if len(outcomes) < len(paths):
            outcomes.append(Outcome("fails", reason))
    return outcomes


def _is_whole(line: bytes) -> bool:
    """Whether it is an outcome, and the process lived to write all of it."""
    return line.startswith(b"{") and line.endswith(b"}\n")


def find_robots(folder: Path, kind: str = "urdf") -> Iterator[tuple[str, Path]]:
    """The files of a format below a folder, each with the name of its package."""
    suffix = FORMATS[kind]
    owners = {
        # pip counts shared files from another folder than the one that it puts them into, where some
        # versions of `package.files` miss them.
        Path(
            *(part for part in Path(name).parts if part != "..")
        ): f"{package.metadata['Name']} {package.version}"
        for package in distributions(path=[str(folder)])
        for name, *_ in filter(None, csv.reader((package.read_text("RECORD") or "").splitlines()))
        if name.endswith(suffix)
    }
    for path in sorted(folder.rglob(f"*{suffix}")):
        if path.is_file() and (kind == "urdf" or MJCF_ROOT.match(path.read_bytes()[:100_000])):
            below = path.relative_to(folder)
            yield owners.get(below, below.parts[0]), path


def make_table(outcomes: dict[tuple[str, Path], Outcome]) -> str:
    """A summary by package, and a row for each file or folder of many that all load."""
    by_package: dict[str, dict[Path, Outcome]] = defaultdict(dict)
    for (package, path), outcome in outcomes.items():
        by_package[package][path] = outcome
    lines = ["| package | files | load | with a warning | refused |", "|---|---|---|---|---|"]
    for package, found in by_package.items():
        lines.append(f"| {package} | {_count(found.values())} |")
    lines.append(f"| all | {_count(outcomes.values())} |")
    lines += ["", "| package | file | links | joints that move | result | reason of refusal |"]
    lines += ["|---|---|---|---|---|---|"]
    for package, found in by_package.items():
        root = Path(os.path.commonpath([path.parent for path in found]))
        for name, outcome in _join_many(found, root):
            reason = outcome.reason.replace(f"{root}{os.sep}", "")
            result = "loads, with a warning" if outcome.warned else outcome.result
            counts = f"{outcome.links} | {outcome.joints}" if outcome.result == "loads" else " | "
            lines.append(f"| {package} | {name} | {counts} | {result} | {_escape(reason)} |")
    return "\n".join(lines) + "\n"


def _count(outcomes: Iterable[Outcome]) -> str:
    found = list(outcomes)
    loaded = [it for it in found if it.result == "loads"]
    warned = sum(it.warned for it in loaded)
    return f"{len(found)} | {len(loaded)} | {warned} | {len(found) - len(loaded)}"


def _join_many(found: dict[Path, Outcome], root: Path) -> Iterator[tuple[str, Outcome]]:
    """The rows of a package: what a file is called, and what became of it."""
    groups: dict[tuple[Path, Outcome], list[Path]] = defaultdict(list)
    for path, outcome in found.items():
        groups[path.parent.parent, outcome].append(path)
    for (folder, outcome), paths in groups.items():
        if len(paths) >= MANY and outcome.result == "loads":
            name = (folder.relative_to(root) / "*" / f"*{paths[0].suffix}").as_posix()
            yield f"{_escape(name)} ({len(paths)} files)", outcome
            continue
        for path in paths:
            yield path.relative_to(root).as_posix(), outcome


def _escape(text: str) -> str:
    """As Markdown's tables and mathematics leave it alone."""
    for sign, written in (("\\", "\\\\"), ("|", "\\|"), ("<", "&lt;"), ("$", "\\$"), ("*", "\\*")):
        text = text.replace(sign, written)
    return text.replace("\n", " ")


def make_page(
    outcomes: dict[tuple[str, Path], Outcome], kind: str, command: str, mesh_as: str, steps: int
) -> str:
    """The page of the documentation."""
    packages = sorted({package.replace(" ", "==") for package, _ in outcomes})
    head = HEADS[kind].format(
        steps=steps,
        kind="as convex hulls" if mesh_as == "hull" else "as models",
        packages=" ".join(packages),
        command=command,
    )
    return head + make_table(outcomes)


def main(arguments: list[str] | None = None) -> int:
    """The command line; returns the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER", help="where to search")
    parser.add_argument("--format", choices=tuple(FORMATS), default="urdf", dest="kind")
    parser.add_argument(
        "--mesh-as", choices=("model", "hull"), default="hull", help="hull is faster"
    )
    parser.add_argument("--steps", type=int, default=10, help="for which each robot moves")
    parser.add_argument("--write", type=Path, metavar="PAGE", help="the page to write")
    parser.add_argument("--batch", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args(arguments)
    if given.batch:
        for path in given.folders:
            outcome = try_robot(str(path), given.kind, given.mesh_as, given.steps)
            print(json.dumps(asdict(outcome)), flush=True)
        return 0
    robots = [it for folder in given.folders for it in find_robots(folder, given.kind)]
    if not robots:
        print(f"no {given.kind.upper()} file below {', '.join(map(str, given.folders))}")
        return 1
    outcomes: dict[tuple[str, Path], Outcome] = {}
    batches = [robots[at : at + BATCH] for at in range(0, len(robots), BATCH)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        tried = pool.map(
            lambda batch: try_apart(
                [path for _, path in batch], given.kind, given.mesh_as, given.steps
            ),
            batches,
        )
        for batch, found in zip(batches, tried, strict=True):
            for robot, outcome in zip(batch, found, strict=True):
                outcomes[robot] = outcome
                print(f"{outcome.result}: {robot[1]} {outcome.reason}".rstrip(), flush=True)
    loaded = sum(it.result == "loads" for it in outcomes.values())
    print(f"{loaded} of {len(outcomes)} files load")
    if given.write:
        options = "" if given.kind == "urdf" else f"--format {given.kind} "
        options += f"--mesh-as {given.mesh_as} --steps {given.steps} --write {given.write}"
        command = f".venv/bin/python tools/try_robots.py {options} robots"
        given.write.write_text(make_page(outcomes, given.kind, command, given.mesh_as, given.steps))
    return int(any(it.result == "fails" for it in outcomes.values()))


if __name__ == "__main__":
    sys.exit(main())
