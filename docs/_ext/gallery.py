"""The directive ``gallery``: every example of ``examples/python``, run, with what it printed and made."""

from __future__ import annotations

import ast
import shutil
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from docutils import nodes
from sphinx.errors import ExtensionError
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

if TYPE_CHECKING:
    from sphinx.application import Sphinx

EXAMPLES = Path(__file__).resolve().parents[2] / "examples/python"
_logger = logging.getLogger(__name__)


def list_examples() -> list[Path]:
    """The numbered programs, in their order."""
    return sorted(EXAMPLES.glob("[0-9][0-9]_*.py"))


class Gallery(SphinxDirective):
    """Runs each example in its quick form unless it has not changed since it last ran."""

    def run(self) -> list[nodes.Node]:
        """A section an example: what it is about, pictures, output, program."""
        self.env.note_reread()  # there may be new examples
        return [self._tell(path) for path in list_examples()]

    def _tell(self, path: Path) -> nodes.section:
        self.env.note_dependency(str(path))
        out = Path(self.env.app.outdir) / "gallery" / path.stem
        printed = _run(path, out)
        source = path.read_text(encoding="utf-8")
        title, _, text = (ast.get_docstring(ast.parse(source)) or "").partition("\n")
        section = nodes.section(ids=[nodes.make_id(path.stem)], names=[path.stem])
        section += nodes.title("", f"{path.stem[:2]}. {title.rstrip('.')}")
        for paragraph in text.strip().split("\n\n"):
            pieces = paragraph.replace("\n", " ").split("`")
            section += nodes.paragraph(
                "",
                "",
                *(
                    nodes.literal("", piece) if number % 2 else nodes.Text(piece)
                    for number, piece in enumerate(pieces)
                ),
            )
        relative = f"gallery/{path.stem}"
        pictures = "".join(
            f'<p><img class="gallery-picture" src="{relative}/{kind}.png" alt="{title} ({kind})"></p>'
            for kind in ("picture", "plot")
        )
        replays = sorted(out.glob("*.html"), key=lambda page: page.stem != "replay")
        if replays:
            links = (f'<a href="{relative}/{page.name}">{page.stem}</a>' for page in replays)
            pictures += f"<p>To look at from all sides: {', '.join(links)}</p>"
        section += nodes.raw("", pictures, format="html")
        command = f"$ .venv/bin/python examples/python/{path.name} --quick\n{printed}"
        section += nodes.literal_block(command, command, language="text")
        section += nodes.raw("", "<details><summary>The program</summary>", format="html")
        section += nodes.literal_block(source, source, language="python")
        section += nodes.raw("", "</details>", format="html")
        return section


def _run(path: Path, out: Path) -> str:
    """What the example prints; its files go to ``out``."""
    log = out / "printed.txt"
    newest = max(file.stat().st_mtime for file in EXAMPLES.glob("*.py"))
    if log.is_file() and log.stat().st_mtime >= newest:
        return log.read_text(encoding="utf-8")
    _logger.info("running %s", path.name)
    shutil.rmtree(out, ignore_errors=True)
    done = subprocess.run(
        [sys.executable, str(path), "--quick", "--out", str(out)], capture_output=True, text=True
    )
    if done.returncode != 0:
        raise ExtensionError(f"{path.name} failed:\n{done.stderr}")
    for made in ("picture.png", "plot.png", "replay.html"):
        if not (out / made).is_file():
            raise ExtensionError(f"{path.name} made no {made}")
    log.write_text(done.stdout, encoding="utf-8")
    return done.stdout


def setup(app: Sphinx) -> dict[str, bool]:
    """Registers the directive."""
    app.add_directive("gallery", Gallery)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
