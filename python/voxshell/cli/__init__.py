"""The command line: ``voxshell``."""

from __future__ import annotations

import sys

from cyclopts import App
from rich.console import Console

import voxshell
from voxshell.cli.cache import cache
from voxshell.cli.reproduce import reproduce
from voxshell.cli.reproduce_peers import peers
from voxshell.cli.simulate import simulate
from voxshell.errors import VoxshellError

app = App(
    name="voxshell",
    help="Collision of any mesh with any mesh at haptic rates, exactly as sampled.",
    version=voxshell.__version__,
)
app.command(simulate)
app.command(reproduce)
reproduce.command(peers)
app.command(cache)


def main() -> None:
    """Runs the command line; exits with 0 only on success."""
    errors = Console(stderr=True)
    try:
        app()
    except VoxshellError as error:
        errors.print(f"[bold red]error:[/] {error}", highlight=False)
        sys.exit(1)
    except OSError as error:
        errors.print(f"[bold red]error:[/] {error}", highlight=False)
        sys.exit(1)
    except KeyboardInterrupt:
        errors.print("stopped")
        sys.exit(130)
