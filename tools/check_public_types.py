#!/usr/bin/env python3
"""Checks that type checkers of users know all that is public: what `pyright --verifytypes` finds.

usage: tools/check_public_types.py

Prints a line for each thing whose type is unknown, or left to each checker to infer, and exits 1 if there
is one. The command line and the experiments are left out: nobody imports them.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

NOT_IMPORTED = ("voxshell.cli", "voxshell_studies")
FEWEST_SYMBOLS = 500


def main() -> int:
    """The command line; returns the exit code."""
    symbols = [
        symbol
        for symbol in _ask_for_symbols()
        if symbol["isExported"] and not symbol["name"].startswith(NOT_IMPORTED)
    ]
    if len(symbols) < FEWEST_SYMBOLS:
        print(f"only {len(symbols)} symbols were found: is voxshell installed in this environment?")
        return 1
    unknown = [symbol for symbol in symbols if not symbol["isTypeKnown"]]
    for symbol in unknown:
        why = "; ".join(one["message"].replace("\n", " ") for one in symbol["diagnostics"])
        print(f"{symbol['name']}: {why or 'uses a type that is not known'}")
    if not unknown:
        print(f"the types of all {len(symbols)} public symbols are known")
    return bool(unknown)


def _ask_for_symbols() -> list[dict[str, Any]]:
    programs = Path(sys.executable).parent
    # It looks at the packages of the first python on the path.
    path = f"{programs}{os.pathsep}{os.environ['PATH']}"
    command = [programs / "basedpyright", "--verifytypes", "voxshell", "--ignoreexternal"]
    told = subprocess.run(
        [*command, "--outputjson"], env={**os.environ, "PATH": path}, capture_output=True, text=True
    )
    return json.loads(told.stdout)["typeCompleteness"]["symbols"]


if __name__ == "__main__":
    sys.exit(main())
