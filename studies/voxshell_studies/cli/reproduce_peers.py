"""``voxshell reproduce peers``: comparison of voxshell with other libraries."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table
from voxshell.base.outputs import check_output_folder
from voxshell.cli.progress import Track, open_progress
from voxshell.errors import SettingsError
from voxshell.measuring.files import finite

from voxshell_studies.peers import report
from voxshell_studies.peers.cases import QUICK, PeersSettings
from voxshell_studies.peers.roster import PEERS

if TYPE_CHECKING:
    from collections.abc import Iterable

    from voxshell_studies.peers.comparison import Comparison


_NAME_WIDTH = 12
"""Width of the column of names, characters."""


def peers(
    *,
    out: Path = Path("reproduction/peers"),
    quick: Annotated[bool, Parameter(negative="")] = False,
    settings: Path | None = None,
    only: Annotated[tuple[str, ...], Parameter(consume_multiple=True, negative="")] = (),
    json_only: Annotated[bool, Parameter(name="--json", negative="")] = False,
) -> None:
    """Compare contacts, depths and drops of voxshell, Bullet, MuJoCo, ODE, coal, fcl and Drake.

    Each peer runs in its own process. If a peer is not installed, crashes or hangs, its row says
    so. Finished rows are not measured again.

    For example:

        voxshell reproduce peers --quick --only voxshell coal

    Args:
        out: The folder to write to.
        quick: Measure for a shorter time, with fewer drops, and without the convex decomposition
            unless an earlier run has kept it.
        settings: A TOML file; the keys of its table [peers] override settings.
        only: Keys of the peers to measure, such as voxshell coal mujoco-hull; all by default.
        json_only: Print only JSON: the results.
    """
    from voxshell_studies.peers.comparison import compare
    from voxshell_studies.settings import override, read_settings_file

    tables = {} if settings is None else read_settings_file(settings)
    chosen: PeersSettings = override(
        QUICK if quick else PeersSettings(), tables.get("peers", {}), "peers"
    )
    check_output_folder(out)
    known = [peer.key for peer in PEERS]
    for key in only:
        if key not in known:
            raise SettingsError(f"unknown peer {key!r}; valid peers: {', '.join(known)}")
    progress = open_progress(Console(quiet=json_only, stderr=True))
    tracks: dict[str, Track] = {}

    def show(name: str, stage: str, fraction: float) -> None:
        if name not in tracks:
            tracks[name] = Track(progress, progress.add_task(name, total=1.0, stage=""))
        tracks[name].update(stage, fraction)

    with progress:
        comparison = compare(
            chosen,
            out,
            peers=tuple(peer for peer in PEERS if not only or peer.key in only),
            skip_slow=quick,
            progress=show,
        )
    words = ["voxshell reproduce peers", *(["--quick"] if quick else [])]
    words += [] if settings is None else [f"--settings {settings}"]
    command = " ".join(words + (["--only", *only] if only else []))
    report.write_results(out, comparison, command)
    if json_only:
        print(json.dumps(finite(report.describe(comparison))))
        return
    console = Console(highlight=False)
    for table in make_tables(comparison):
        console.print(table)
    for label, what, why in report.list_problems(comparison):
        console.print(f"  [yellow]{escape(label)}[/], {escape(what)}: {escape(why)}")
    console.print(f"  {out / 'peers.md'}, peers.json, cases.csv, drops.csv", soft_wrap=True)


def make_tables(comparison: Comparison) -> Iterable[Table]:
    """Contacts with times and depths, then the drops."""
    measured = [peer for peer in comparison.peers if peer.cases or peer.drops]
    labels = [case.label for case in comparison.cases]
    table = _new_table(
        "Median time of a query; least time as a multiple of the first row's", ["peer", *labels]
    )
    for peer in measured:
        cells = (report.format_times(comparison, peer, case) for case in comparison.cases)
        table.add_row(escape(peer.label), *cells)
    yield table
    table = _new_table(
        "Contacts, and how far the deepest depth is off the true one, mm",
        ["peer", "ready, s", *labels],
    )
    for peer in measured:
        cells = (report.format_error(comparison, peer, case) for case in comparison.cases)
        table.add_row(escape(peer.label), report.format_preparation(peer), *cells)
    yield table
    dropping = [peer for peer in measured if peer.drops]
    if not dropping:
        return
    rates = comparison.settings.rates
    colors = {"rests": "green", "moves": "yellow"} | dict.fromkeys(
        ("sinks", "through", "off", "unstable"), "red"
    )
    for ground in report.GROUNDS:
        table = _new_table(
            f"Dropped on the {ground}; height of the lowest vertex at the end, mm",
            ["peer", *(f"{rate:g} Hz" for rate in rates)],
        )
        for peer in dropping:
            cells = []
            for rate in rates:
                drop = report.find_drop(peer, ground, rate)
                text = escape(report.format_drop(drop)).replace(" ", "\n")
                color = colors.get(drop.outcome if drop is not None else "")
                cells.append(f"[{color}]{text}[/]" if color else text)
            table.add_row(escape(peer.label), *cells)
        yield table


def _new_table(title: str, headings: list[str]) -> Table:
    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    for index, heading in enumerate(headings):
        table.add_column(
            heading, justify="right" if index else "left", min_width=0 if index else _NAME_WIDTH
        )
    return table
