"""The code that pages print, as it is printed."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
# Written by programs, which tests run anyhow.
WRITTEN_BY_PROGRAMS = {"peers.md", "reproduction.md", "bullet-pairs.md", "evidence.md"}


@dataclass(frozen=True)
class Block:
    """Code on a page.

    Attributes:
        page: Path within the repository.
        line: Where it begins, from 1.
        language: "python", "cpp", ... as the page says; "indented" where it stands four to the right.
        code: As printed, without the indentation.
    """

    page: str
    line: int
    language: str
    code: str

    def __str__(self) -> str:
        return f"{self.page}:{self.line}"


def list_pages() -> list[Path]:
    """All that people read and copy from, decisions apart."""
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
    return [page for page in pages if page.name not in WRITTEN_BY_PROGRAMS]


def read_blocks(page: Path) -> list[Block]:
    """A page's blocks, in their order."""
    name = page.relative_to(ROOT).as_posix() if page.is_relative_to(ROOT) else page.name
    blocks: list[Block] = []
    lines = page.read_text(encoding="utf-8").splitlines()
    number = 0
    while number < len(lines):
        begin = number
        fence = re.fullmatch(r"```(\S*).*", lines[number])
        if fence:
            number = lines.index("```", number + 1)
            code = "\n".join(lines[begin + 1 : number])
            blocks.append(Block(name, begin + 2, fence[1] or "text", code))
        elif lines[number].startswith("    ") and (number == 0 or not lines[number - 1].strip()):
            while number < len(lines) and lines[number].startswith("    "):
                number += 1
            code = "\n".join(line[4:] for line in lines[begin:number])
            blocks.append(Block(name, begin + 1, "indented", code))
        number += 1
    return blocks


def all_blocks(*languages: str) -> list[Block]:
    """Those of all pages in some languages."""
    return [
        block for page in list_pages() for block in read_blocks(page) if block.language in languages
    ]
