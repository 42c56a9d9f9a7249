"""Files that fuzzing or users found: those of the folder `found`."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from .case import Case

FOLDER = Path(__file__).parent / "found"


def list_cases() -> Iterator[Case]:
    for path in sorted(FOLDER.iterdir()):
        if path.name != "README.md":
            entrance, _, name = path.name.partition(".")
            yield Case(f"found, {name}", entrance, path.name, partial(shutil.copy, path))
