"""The command line: ``voxshell``."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from cyclopts import App

import voxshell
from voxshell.cli.ending import run

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
# Each is imported when it is used: none waits for what another needs.
for _name, _place, _help in (
    ("build", "build:build", "Make a mesh ready to collide, and keep it in a file."),
    ("info", "info:info", "Tell about a mesh or a model; advise on voxel sizes."),
    ("query", "query:query", "Ask how two bodies touch: contacts, yes or no, distance, force."),
    ("simulate", "simulate:simulate", "Simulate a scene and write down what happened."),
    ("bench", "bench:bench", "Time queries of a mesh on this machine."),
    ("reproduce", "reproduce:reproduce", "Re-run the experiments of the thesis' section 5.3."),
    ("cache", "cache:cache", "Models that are kept on the disk: list or remove them."),
):
    app.command(f"voxshell.cli.{_place}", name=_name, help=_help)
app.register_install_completion_command()


def main(arguments: Sequence[str] | None = None) -> None:
    """Runs the command line; exits with 0 only on success."""
    sys.exit(run(app, sys.argv[1:] if arguments is None else arguments))
