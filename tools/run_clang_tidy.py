#!/usr/bin/env python3
"""Runs clang-tidy on the libraries and the Python modules, on what changed since it last passed.

usage: tools/run_clang_tidy.py CLANG_TIDY BUILD_DIR

BUILD_DIR is a finished Ninja build: it knows the compile commands and which headers each source
includes. The tests are not analysed: they are compiled with all warnings, and run.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shlex
import subprocess
import sys
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ANALYSED = ("core/", "bullet/", "python/bindings/")
# A new version of the tool, of a third-party header or of the settings asks for a new look.
SETTINGS = (".clang-tidy", "tools/constraints.txt", "tools/run_clang_tidy.py")


def own_path(path: str, build: Path) -> str | None:
    """Path relative to the root if it is one of our sources, else None."""
    absolute = Path(os.path.normpath(build / path))
    if not absolute.is_relative_to(ROOT):
        return None
    name = absolute.relative_to(ROOT).as_posix()
    return name if name.startswith(ANALYSED) else None


def included_by_object(build: Path) -> dict[str, set[str]]:
    """Our own files that went into each object, from Ninja's log of the build."""
    log = subprocess.run(
        ["ninja", "-C", str(build), "-t", "deps"], check=True, capture_output=True, text=True
    ).stdout
    files: dict[str, set[str]] = defaultdict(set)
    target = ""
    for line in log.splitlines():
        if match := re.match(r"^(\S+): #deps ", line):
            target = match[1]
        elif line.startswith("    ") and (name := own_path(line.strip(), build)):
            files[target].add(name)
    return files


def keys_by_source(build: Path) -> dict[str, str]:
    """For each source, a hash of all that decides what clang-tidy says about it."""
    included = included_by_object(build)
    digests: dict[str, hashlib._Hash] = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        name = own_path(entry["file"], build)
        if name is None:
            continue
        digest = digests.setdefault(name, hashlib.sha256())
        command = shlex.split(entry["command"])
        digest.update(entry["command"].encode())
        for file in sorted({*SETTINGS, name, *included[command[command.index("-o") + 1]]}):
            digest.update(file.encode() + b"\0" + (ROOT / file).read_bytes())
    return {name: digest.hexdigest() for name, digest in digests.items()}


def main(arguments: list[str]) -> int:
    """The command line; returns the exit code."""
    clang_tidy, build = arguments[0], (ROOT / arguments[1]).resolve()
    passed = build / "clang-tidy-passed"
    passed.mkdir(exist_ok=True)
    keys = keys_by_source(build)
    if not keys:
        print(f"{build}/compile_commands.json names none of our sources")
        return 1
    for stamp in passed.iterdir():
        if stamp.name not in keys.values():
            stamp.unlink()

    def analyse(name: str) -> bool:
        # The compile commands are the compiler's: clang need not know all of its warnings.
        result = subprocess.run(
            [
                *(clang_tidy, "-p", str(build), "--quiet"),
                *("--extra-arg=-Wno-unknown-warning-option", str(ROOT / name)),
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

    changed = [name for name, key in keys.items() if not (passed / key).exists()]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        good = list(pool.map(analyse, changed))
    return 0 if all(good) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
