"""The command line of a check that prints one line for each fault."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path


def run_check(check: Callable[[Path], list[str]], arguments: list[str]) -> int:
    """Prints what a check finds below the first argument, else below the repository's root; returns the exit code."""
    root = Path(arguments[0]) if arguments else Path(__file__).resolve().parent.parent
    lines = check(root)
    for line in lines:
        print(line)
    return 1 if lines else 0
