#!/usr/bin/env python3
"""Loads every robot of some packages, and writes the table of docs/robots.md.

usage: tools/robots.py [--write] [--mesh-as model] [NAME...]

Downloads the packages (500 MB) into build/robots once. Each robot is loaded in a process of its own, by
default with convex hulls, which takes minutes; with models it takes hours the first time. NAMEs restrict it to
files whose path has one of them.
"""

from __future__ import annotations

import argparse
import concurrent.futures
import json
import os
import subprocess
import sys
import time
import warnings
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs/robots.md"
PACKAGES = {
    "pybullet": "3.2.7",
    "example-robot-data": "6.0.0",
    "rtb-data": "2.0.0",
    "airo-models": "0.0.12",
}
"""Packages on PyPI that carry URDF files, and their versions."""

TIME_LIMIT = 300.0
"""Seconds for one robot."""

HEAD = """# Robots

`vx.load_urdf` was tried on every URDF file of these packages: {packages}. {loaded} of {all} files load; {warned}
of them with a `RobotWarning`, because they leave out masses, inertias or limits. The others have the fault that
the table names. Meshes were loaded {kind}. This command makes the page again:

```
.venv/bin/python tools/robots.py --write
```

| file | links | joints that move | result | seconds |
|---|---|---|---|---|
"""


def download(folder: Path) -> list[Path]:
    """The URDF files of all packages, without the 1000 random objects of pybullet."""
    files: list[Path] = []
    for name, version in PACKAGES.items():
        target = folder / name
        if not target.is_dir():
            wheels = folder / "wheels"
            command = [sys.executable, "-m", "pip", "download", "--no-deps", "--only-binary=:all:"]
            command += ["--quiet", "--dest", str(wheels), f"{name}=={version}"]
            subprocess.run(command, check=True)
            (wheel,) = wheels.glob(f"{name.replace('-', '_')}-{version}-*.whl")
            unfinished = folder / f"{name}.unfinished"
            with zipfile.ZipFile(wheel) as archive:
                archive.extractall(unfinished)
            unfinished.rename(target)
        files += (it for it in sorted(target.rglob("*.urdf")) if "random_urdfs" not in it.parts)
    return files


def load(path: str, mesh_as: str) -> dict[str, object]:
    """What became of one file."""
    import voxshell as vx

    start = time.perf_counter()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            robot = vx.load_urdf(vx.World(), path, mesh_as=mesh_as)  # pyright: ignore[reportArgumentType]
        except vx.VoxshellError as error:
            return {"refused": f"{type(error).__name__}: {error}"}
    return {
        "links": len(robot.links),
        "joints": len(robot.joints) + len(robot.ball_joints),
        "warned": any(issubclass(it.category, vx.RobotWarning) for it in caught),
        "seconds": time.perf_counter() - start,
    }


def load_apart(path: Path, mesh_as: str) -> dict[str, object]:
    """The same in a process of its own."""
    command = [sys.executable, __file__, "--one", str(path), "--mesh-as", mesh_as]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=TIME_LIMIT)
    except subprocess.TimeoutExpired:
        return {"refused": f"it takes more than {TIME_LIMIT:g} s"}
    if done.returncode != 0:
        return {"refused": f"crash: {(done.stderr.splitlines() or [''])[-1]}"}
    return json.loads(done.stdout)


def make_row(name: str, path: Path, found: dict[str, object]) -> str:
    """A row of the table."""
    if "refused" in found:
        reason = str(found["refused"]).replace(str(path.parent) + os.sep, "").replace("|", "\\|")
        reason = reason.replace(str(ROOT / "build/robots") + os.sep, "")
        reason = reason.replace("<", "&lt;").replace("$", "\\$")
        return f"| {name} | | | **refused**: {reason} | |"
    result = "loads, with a warning" if found["warned"] else "loads"
    return f"| {name} | {found['links']} | {found['joints']} | {result} | {found['seconds']:.1f} |"


def main() -> int:
    """Runs it; 1 if a file crashed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--mesh-as", choices=("model", "hull"), default="hull")
    parser.add_argument("--one", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one:
        print(json.dumps(load(arguments.one, arguments.mesh_as)))
        return 0
    folder = ROOT / "build/robots"
    files = [
        it
        for it in download(folder)
        if not arguments.names or any(name in str(it) for name in arguments.names)
    ]
    rows, results = [], []
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        found_all = pool.map(lambda it: load_apart(it, arguments.mesh_as), files)
        for path, found in zip(files, found_all, strict=True):
            shown = path.relative_to(folder).as_posix()
            shown = shown.replace("cmeel.prefix/share/example-robot-data/robots/", "")
            results.append(found)
            rows.append(make_row(shown, path, found))
            print(rows[-1], flush=True)
    loaded = [it for it in results if "refused" not in it]
    print(f"{len(loaded)} of {len(results)} load")
    if arguments.write:
        head = HEAD.format(
            packages=", ".join(f"{name} {version}" for name, version in PACKAGES.items()),
            loaded=len(loaded),
            all=len(results),
            warned=sum(bool(it["warned"]) for it in loaded),
            kind="as convex hulls" if arguments.mesh_as == "hull" else "as models",
        )
        PAGE.write_text(head + "\n".join(rows) + "\n")
    return int(any(str(it.get("refused", "")).startswith("crash") for it in results))


if __name__ == "__main__":
    sys.exit(main())
