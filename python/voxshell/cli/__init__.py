"""The command line: ``voxshell``."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from cyclopts import App

import voxshell
from voxshell.cli.bench import bench
from voxshell.cli.build import build
from voxshell.cli.cache import cache
from voxshell.cli.ending import run
from voxshell.cli.info import info
from voxshell.cli.query import query
from voxshell.cli.reproduce import reproduce
from voxshell.cli.reproduce_peers import peers
from voxshell.cli.simulate import simulate
from voxshell.cli.view import view

if TYPE_CHECKING:
    from collections.abc import Sequence

app = App(
    name="voxshell",
    help="Collision of any mesh with any mesh at haptic rates, exactly as sampled.",
    help_epilogue=(
        "Lengths are in metres, times in seconds, masses in kilograms. Exit codes: 0 success, 1 failure,"
        " 2 wrong use (arguments, settings or input files), 130 stopped by Ctrl-C."
    ),
    version=voxshell.__version__,
    suppress_keyboard_interrupt=False,
)
for _command in (build, info, query, view, simulate, bench, reproduce, cache):
    app.command(_command)
reproduce.command(peers)
app.register_install_completion_command()


def main(arguments: Sequence[str] | None = None) -> None:
    """Runs the command line; exits with 0 only on success."""
    sys.exit(run(app, sys.argv[1:] if arguments is None else arguments))
