#!/usr/bin/env python3
"""Runs clang-tidy on the libraries and the Python modules, on what changed since it last passed.

A source that is compiled for several builds of Bullet is analyzed once, as the first of them.

usage: tools/run_clang_tidy.py [--deep] CLANG_TIDY BUILD_DIR

--deep also follows the paths that a program can take (clang-analyzer), for four times as long.

BUILD_DIR is a finished Ninja build: it knows the compile commands and which headers each source
includes. The tests are not analyzed: they are compiled with all warnings, and run.

What passed is noted in ~/.cache/voxshell/clang-tidy, for all checkouts: by a hash of the source, of all headers that it
includes, the system's among them, of its compile command and of the settings.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shlex
import subprocess
import sys
import time
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ANALYZED = ("core/", "bullet/", "python/bindings/")
# A new version of the tool or of the settings asks for a new look.
SETTINGS = (".clang-tidy", "tools/constraints.txt", "tools/run_clang_tidy.py")
KEPT_DAYS = 60  # after which nobody has asked for what passed


def own_path(path: str, build: Path) -> str | None:
    """Path relative to the root if it is one of our sources, else None."""
    absolute = Path(os.path.normpath(build / path))
    if not absolute.is_relative_to(ROOT):
        return None
    name = absolute.relative_to(ROOT).as_posix()
    return name if name.startswith(ANALYZED) else None


def included_by_object(build: Path) -> dict[str, set[Path]]:
    """Files that went into each object, from Ninja's log of the build."""
    log = subprocess.run(
        ["ninja", "-C", str(build), "-t", "deps"], check=True, capture_output=True, text=True
    ).stdout
    files: dict[str, set[Path]] = defaultdict(set)
    target = ""
    for line in log.splitlines():
        if match := re.match(r"^(\S+): #deps ", line):
            target = match[1]
        elif line.startswith("    "):
            files[target].add(Path(os.path.normpath(build / line.strip())))
    return files


def commands_by_source(build: Path) -> dict[str, dict[str, str]]:
    """For each source, the first entry of the build's compile commands."""
    commands: dict[str, dict[str, str]] = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        if name := own_path(entry["file"], build):
            commands.setdefault(name, entry)
    return commands


@cache
def digest_of(file: Path) -> bytes:
    """A hash of name and content. Those of a checkout do not depend on where it is."""
    name = file.relative_to(ROOT) if file.is_relative_to(ROOT) else file
    return hashlib.sha256(f"{name}\0".encode() + file.read_bytes()).digest()


def keys_by_source(
    build: Path, commands: dict[str, dict[str, str]], checks: list[str]
) -> dict[str, str]:
    """For each source, a hash of all that decides what clang-tidy says about it."""
    included = included_by_object(build)
    keys: dict[str, str] = {}
    for name, entry in commands.items():
        words = shlex.split(entry["command"])
        command = entry["command"].replace(f"{ROOT}/", "")
        digest = hashlib.sha256("\0".join([command, *checks]).encode())
        files = {ROOT / file for file in (*SETTINGS, name)}
        files |= included[words[words.index("-o") + 1]]
        digest.update(b"".join(sorted(map(digest_of, files))))
        keys[name] = digest.hexdigest()
    return keys


def find_passed() -> Path:
    """The folder of empty files that are named by the keys of what passed."""
    caches = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    passed = caches / "voxshell/clang-tidy"
    passed.mkdir(parents=True, exist_ok=True)
    oldest = time.time() - KEPT_DAYS * 86_400
    for stamp in passed.iterdir():
        if stamp.stat().st_mtime < oldest:
            stamp.unlink(missing_ok=True)
    return passed


def main(arguments: list[str]) -> int:
    """The command line; returns the exit code."""
    checks = [] if "--deep" in arguments else ["--checks=-clang-analyzer-*"]
    clang_tidy, folder = (each for each in arguments if each != "--deep")
    build = (ROOT / folder).resolve()
    passed = find_passed()
    commands = commands_by_source(build)
    keys = keys_by_source(build, commands, checks)
    # clang-tidy analyzes a source once for each entry that it finds.
    database = build / "clang-tidy"
    database.mkdir(exist_ok=True)
    (database / "compile_commands.json").write_text(json.dumps(list(commands.values())))
    if not keys:
        print(f"{build}/compile_commands.json names none of our sources")
        return 1

    def analyze(name: str) -> bool:
        # Warnings are the compiler's: clang does not know all of them, and has others.
        result = subprocess.run(
            [
                *(clang_tidy, "-p", str(database), "--quiet", "--extra-arg=-Wno-everything"),
                *checks,
                str(ROOT / name),
            ],
            capture_output=True,
            text=True,
            check=False,
        )
        if result.returncode == 0:
            (passed / keys[name]).touch()
            return True
        complaints = result.stdout if "error:" in result.stdout else result.stdout + result.stderr
        print(complaints.replace(f"{ROOT}/", ""), end="", flush=True)
        return False

    changed = []
    for name, key in keys.items():
        if (passed / key).exists():
            (passed / key).touch()
        else:
            changed.append(name)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        good = list(pool.map(analyze, changed))
    return 0 if all(good) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
