"""The studies' commands for ``voxshell``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from voxshell_studies.cli.reproduce import reproduce
from voxshell_studies.cli.reproduce_peers import peers
from voxshell_studies.cli.simulate_drop import drop

if TYPE_CHECKING:
    from cyclopts import App

reproduce.command(peers)


def add_commands(app: App) -> None:
    """Add ``reproduce`` and ``simulate drop``; this is an entry point of ``voxshell.commands``."""
    app.command(reproduce)
    simulate = app["simulate"]
    usage = "voxshell simulate drop [OPTIONS] [MESH]"
    simulate.command(drop, usage=f"Usage: {usage}")
    simulate.usage = f"{simulate.usage}\n       {usage}"
