"""The command line: ``voxshell``."""

from __future__ import annotations

import sys
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Annotated, NoReturn

from cyclopts import App, Parameter

import voxshell
from voxshell.cli.bench import bench
from voxshell.cli.build import build
from voxshell.cli.cache import cache
from voxshell.cli.ending import run
from voxshell.cli.info import info
from voxshell.cli.query import query
from voxshell.cli.simulate import simulate
from voxshell.cli.view import view
from voxshell.errors import MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Sequence


def _describe_default(value: object) -> str | None:
    """Return a default value as one would type it; None for flags and empty values."""
    if value is None or isinstance(value, bool) or value == ():
        return None
    return " ".join(map(str, value)) if isinstance(value, tuple) else str(value)


app = App(
    name="voxshell",
    help="""Collision of any mesh with any mesh, fast enough for haptics (1 kHz).

    For example, from a mesh in millimeters to falling bodies:

        voxshell info part.stl --scale 0.001 --advise
        voxshell build part.stl -o part.vxs --scale 0.001 --tolerance 0.0001
        voxshell query part.vxs plane --a-pose 0 0 0.01
        voxshell simulate scene.toml --out result
    """,
    help_epilogue=(
        "Lengths are in meters, times in seconds, masses in kilograms. Exit codes: 0 success, 1 failure,"
        " 2 wrong use (arguments, settings or input files), 130 stopped by Ctrl-C."
    ),
    version=voxshell.__version__,
    default_parameter=Parameter(show_default=_describe_default),
    suppress_keyboard_interrupt=False,
)
for _command in (build, info, query, simulate, bench, cache):
    app.command(_command)
app.command(view, usage="Usage: voxshell view [OPTIONS] BODY [OTHER]")
app.register_install_completion_command()


def _need_studies(*_: Annotated[str, Parameter(allow_leading_hyphen=True)]) -> NoReturn:
    raise MissingExtraError(
        "this command belongs to the studies, voxshell-studies, a package of its own that is on no index yet: in a "
        "clone of voxshell's repository, run pip install ./studies; or install its wheel, which lies beside "
        "voxshell's: pip install --find-links build/dist voxshell-studies"
    )


_extensions = entry_points(group="voxshell.commands")
for _extension in _extensions:
    _extension.load()(app)
if not _extensions:
    app.command(_need_studies, name="reproduce", show=False)
    simulate.command(_need_studies, name="drop", show=False)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit; the exit code is 0 only on success."""
    sys.exit(run(app, sys.argv[1:] if arguments is None else arguments))
