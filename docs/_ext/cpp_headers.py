"""The directive ``cpp-headers``: public headers in full, without what every header has."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from docutils import nodes
from sphinx.util.docutils import SphinxDirective

if TYPE_CHECKING:
    from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = (ROOT / "core/include", ROOT / "bullet/include")


def list_headers() -> list[str]:
    """Every public header as it is included, ``voxshell/model.h``."""
    return sorted(
        path.relative_to(folder).as_posix()
        for folder in FOLDERS
        for path in folder.glob("voxshell/**/*.h")
    )


def find_header(name: str) -> Path:
    """Where a header lies.

    Raises:
        FileNotFoundError: There is no such public header.
    """
    for folder in FOLDERS:
        if (folder / name).is_file():
            return folder / name
    raise FileNotFoundError(f"no public header {name}")


def read_declarations(header: str) -> str:
    """What a header declares: all that is in its namespace."""
    inside = re.search(
        r"^namespace voxshell(?:::bullet)? \{\n(.*)^\}  // namespace", header, re.M | re.S
    )
    if inside is None:
        raise ValueError("a public header has one namespace, closed with a comment")
    return inside[1].strip("\n")


class CppHeaders(SphinxDirective):
    """Each line of the content names a header."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        """A section a header."""
        sections: list[nodes.Node] = []
        for name in self.content:
            path = find_header(name)
            self.env.note_dependency(str(path))
            section = nodes.section(ids=[nodes.make_id(name)], names=[name])
            section += nodes.title("", "", nodes.literal("", name))
            code = read_declarations(path.read_text(encoding="utf-8"))
            section += nodes.literal_block(code, code, language="cpp")
            sections.append(section)
        return sections


def setup(app: Sphinx) -> dict[str, bool]:
    """Registers the directive."""
    app.add_directive("cpp-headers", CppHeaders)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
