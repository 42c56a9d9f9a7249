#!/usr/bin/env python3
"""Checks that every source file that decides something has a test file of its name beside it.

usage: tools/check_tests_mirror.py [ROOT]

    core/src/LAYER/NAME.cpp          tests/cpp/core/LAYER/NAME_test.cpp
    bullet/src/NAME.cpp              tests/cpp/bullet/NAME_test.cpp
    python/voxshell/ROOM/NAME.py     tests/python/ROOM/test_NAME.py
    studies/voxshell_studies/NAME.py tests/python/studies/test_NAME.py

Folders within these have their tests in folders of the same names.

A file decides something if it has a branch or a loop. Files that are tested by way of others stand in
tests/without_own_tests.txt, which may only shrink. Prints one line for each file that is neither tested nor
listed, and for each line of the list that is out of date, and exits 1 if there is one.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

from check_command import run_check

LISTED = "tests/without_own_tests.txt"
# Folder of sources -> folder of their tests.
CPP_MIRRORS = {"core/src": "tests/cpp/core", "bullet/src": "tests/cpp/bullet"}
PYTHON_MIRRORS = {
    "python/voxshell": "tests/python",
    "studies/voxshell_studies": "tests/python/studies",
}

COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
CPP_DECISION = re.compile(r"\b(if|for|while|switch)\b|\s\?\s")
PYTHON_DECISIONS = (
    ast.If,
    ast.IfExp,
    ast.For,
    ast.While,
    ast.Match,
    ast.Try,
    ast.BoolOp,
    ast.comprehension,
)


def check(root: Path) -> list[str]:
    """What is neither tested nor listed, and what is listed without need."""
    path = root / LISTED
    listed = [
        line
        for line in (path.read_text(encoding="utf-8").splitlines() if path.exists() else ())
        if line and not line.startswith("#")
    ]
    missing = dict(find_untested(root))
    found = [
        f"{source}:1: has no test file of its own: write {test}"
        for source, test in missing.items()
        if source not in listed
    ]
    for source in listed:
        if source not in missing:
            why = "has one" if (root / source).exists() else "is gone"
            found.append(f"{LISTED}:1: {source} {why}; remove its line")
    return found


def find_untested(root: Path) -> Iterator[tuple[str, str]]:
    """(source, the test that it has not), by name."""
    for sources, tests in CPP_MIRRORS.items():
        for path in sorted((root / sources).rglob("*.cpp")):
            place = path.relative_to(root / sources)
            test = Path(tests, place.parent, f"{path.stem}_test.cpp")
            if CPP_DECISION.search(COMMENT.sub("", path.read_text(encoding="utf-8"))):
                yield from _missing(root, path, test)
    for sources, tests in PYTHON_MIRRORS.items():
        for path in sorted((root / sources).rglob("*.py")):
            place = path.relative_to(root / sources)
            test = Path(tests, place.parent, f"test_{path.stem}.py")
            decides = _decides(ast.parse(path.read_text(encoding="utf-8")))
            if decides and path.name != "__init__.py":
                yield from _missing(root, path, test)


def _decides(tree: ast.Module) -> bool:
    """Whether Python code has a branch or a loop, beside those for types alone."""
    for node in ast.walk(tree):
        if isinstance(node, PYTHON_DECISIONS) and not (
            isinstance(node, ast.If)
            and isinstance(node.test, ast.Name)
            and node.test.id == "TYPE_CHECKING"
        ):
            return True
    return False


def _missing(root: Path, source: Path, test: Path) -> Iterator[tuple[str, str]]:
    if not (root / test).exists():
        yield source.relative_to(root).as_posix(), test.as_posix()


def main(arguments: list[str]) -> int:
    """The command line; returns the exit code."""
    return run_check(check, arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
