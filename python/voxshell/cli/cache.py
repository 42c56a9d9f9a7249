"""``voxshell cache``: the models in the cache on the disk."""

from __future__ import annotations

import json
import time
from dataclasses import asdict
from typing import Annotated

from cyclopts import App, Parameter
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from voxshell.errors import FileAccessError
from voxshell.model.cache import ModelCache, open_cache

cache = App(
    name="cache",
    help="""List or remove the models that voxshell keeps on the disk.

    VOXSHELL_CACHE_DIR sets their folder, and VOXSHELL_CACHE_SIZE their total size, such as 500MB.
    For example:

        voxshell cache list
        voxshell cache clear
    """,
)

Json = Annotated[bool, Parameter(name="--json", negative="")]


@cache.command(name="list")
def list_models(*, json_only: Json = False) -> None:
    """List the models, the most recently used first.

    Args:
        json_only: Print JSON: the key, the size in bytes, the time of last use (seconds since 1970)
            and the name of the mesh.
    """
    entries = _open().entries()
    if json_only:
        print(json.dumps([asdict(entry) for entry in entries]))
        return
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    table.add_column("model", no_wrap=True)
    table.add_column("built from", overflow="fold")
    table.add_column("MB", justify="right", no_wrap=True)
    table.add_column("last used", no_wrap=True)
    for entry in entries:
        used = time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(entry.used))
        name = escape(entry.name) or "-"
        table.add_row(entry.key[:16], name, f"{entry.size / 1e6:.1f}", used)
    console = Console(highlight=False)
    if entries:
        console.print(table)
    console.print(_describe_size())


@cache.command
def size(*, json_only: Json = False) -> None:
    """Print the total size of the models, and its limit.

    Args:
        json_only: Print JSON: models, size and capacity in bytes.
    """
    kept = _open()
    if json_only:
        entries = kept.entries()
        total = sum(entry.size for entry in entries)
        print(json.dumps({"models": len(entries), "size": total, "capacity": kept.capacity}))
        return
    print(_describe_size())


@cache.command
def clear() -> None:
    """Remove all models. Those in use stay in memory."""
    removed = _open().clear()
    print(f"removed {removed} model{'' if removed == 1 else 's'}")


@cache.command
def path() -> None:
    """Print the folder that the models are in."""
    print(_open().folder)


def _open() -> ModelCache:
    kept = open_cache()
    if kept.folder is None:
        raise FileAccessError("no home directory; set VOXSHELL_CACHE_DIR to a folder for models")
    return kept


def _describe_size() -> str:
    kept = _open()
    entries = kept.entries()
    total = sum(entry.size for entry in entries)
    return (
        f"{len(entries)} model{'' if len(entries) == 1 else 's'}, {total / 1e6:.1f} MB of at most "
        f"{kept.capacity / 1e6:g} MB, in {kept.folder}"
    )
