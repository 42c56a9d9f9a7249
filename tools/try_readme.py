#!/usr/bin/env python3
"""Runs the ten lines of README.md as they are printed, with the voxshell that is installed.

usage: tools/try_readme.py

The lines read part.stl in the current folder, in millimeters, and write replay.html there. If there is no
part.stl, this program makes a mug of 90 mm first.
"""

from __future__ import annotations

import re
from pathlib import Path

README = Path(__file__).resolve().parents[1] / "README.md"


def make_part(path: Path) -> None:
    """Writes a mug without a handle: 80 mm wide, 90 mm high, with a wall of 6 mm."""
    import trimesh

    profile = [(0, 0), (40, 0), (40, 90), (34, 90), (34, 6), (0, 6)]
    trimesh.creation.revolve(profile, sections=64).export(path)


def read_ten_lines(text: str) -> str:
    """The first Python block under the heading of the ten lines."""
    below = text[text.index("\n## Ten lines of Python\n") :]
    block = re.search(r"```python\n(.*?)```", below, re.DOTALL)
    assert block is not None
    return block[1]


def main() -> None:
    """Runs the lines in the current folder."""
    part = Path("part.stl")
    if not part.exists():
        make_part(part)
    exec(compile(read_ten_lines(README.read_text(encoding="utf-8")), "README.md", "exec"), {})
    print(f"watch {Path('replay.html').resolve()} in a browser")


if __name__ == "__main__":
    main()
