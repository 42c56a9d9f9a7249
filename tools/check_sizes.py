#!/usr/bin/env python3
"""Checks that modules and functions of the Python packages can be read at a sitting.

usage: tools/check_sizes.py [ROOT]

Prints one line for each module of voxshell that is too long, and for each function of voxshell and of the
studies that is too long without its docstring, and exits 1 if there is one.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

from check_command import run_check

MOST_LINES_OF_A_MODULE = 420
MOST_LINES_OF_A_FUNCTION = 80
PRODUCT = "python/voxshell"
PACKAGES = (PRODUCT, "studies/voxshell_studies")


def check(root: Path) -> list[str]:
    """What is too long below `root`, by file and line."""
    return [line for package in PACKAGES for line in _check_package(root, package)]


def _check_package(root: Path, package: str) -> Iterator[str]:
    for path in sorted((root / package).rglob("*.py")):
        name = path.relative_to(root).as_posix()
        text = path.read_text(encoding="utf-8")
        count = len(text.splitlines())
        if package == PRODUCT and count > MOST_LINES_OF_A_MODULE:
            yield (
                f"{name}:1: has {count} lines, and at most {MOST_LINES_OF_A_MODULE} are easy to read; "
                "cut it where its subjects part"
            )
        for node in ast.walk(ast.parse(text, filename=name)):
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                count = _count_lines(node)
                if count > MOST_LINES_OF_A_FUNCTION:
                    yield (
                        f"{name}:{node.lineno}: {node.name} has {count} lines without its docstring, and at "
                        f"most {MOST_LINES_OF_A_FUNCTION} are easy to read; make steps of it functions"
                    )


def _count_lines(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """From `def` to the end, without the docstring."""
    last = function.end_lineno or function.lineno
    count = last - function.lineno + 1
    first = function.body[0]
    if ast.get_docstring(function, clean=False) is not None:
        count -= (first.end_lineno or first.lineno) - first.lineno + 1
    return count


def main(arguments: list[str]) -> int:
    """The command line; returns the exit code."""
    return run_check(check, arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
