"""Reports of the comparison: data as JSON and CSV, tables as Markdown."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import TYPE_CHECKING

from voxshell.base.outputs import make_folder, write_text
from voxshell.measuring.files import write_csv, write_json
from voxshell.measuring.units import format_time

from voxshell_studies.part import plain
from voxshell_studies.peers.cases import (
    BOX_HALF_EXTENTS,
    DROP_HEIGHT,
    LENGTH,
    POSES,
    SHIFT,
    TURN,
)
from voxshell_studies.peers.measure import REST_SPEED, REST_SPIN, SUNK
from voxshell_studies.peers.roster import REFERENCE

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from voxshell_studies.peers.comparison import Comparison
    from voxshell_studies.peers.protocol import Case, CaseResult, DropResult, PeerResult

GROUNDS = ("plane", "box")


def write_results(out: Path, comparison: Comparison, command: str) -> None:
    """Write ``peers.json``, ``cases.csv``, ``drops.csv`` and ``peers.md``."""
    make_folder(out)
    write_json(out / "peers.json", describe(comparison) | {"command": command})
    _write_csv(out / "cases.csv", list_cases(comparison))
    _write_csv(out / "drops.csv", list_drops(comparison))
    write_text(out / "peers.md", write_markdown(comparison, command))


def describe(comparison: Comparison) -> dict[str, object]:
    """Return all results for JSON, in seconds, meters, m/s and rad/s."""
    return {
        "experiment": "peers",
        "units": "seconds, meters, m/s, rad/s",
        "settings": plain(comparison.settings),
        "environment": comparison.environment,
        "truth_problem": comparison.truth_problem,
        "cases": [
            {
                "key": case.key,
                "label": case.label,
                "other": case.other,
                "depth": comparison.true_depth(case),
                "pose": case.poses[0].tolist(),
                "other_pose": case.other_pose.tolist(),
                "truth": asdict(comparison.truths[case.key])
                if case.key in comparison.truths
                else None,
            }
            for case in comparison.cases
        ],
        "peers": [asdict(peer) for peer in comparison.peers],
        "results": list_cases(comparison),
    }


def list_cases(comparison: Comparison) -> list[dict[str, object]]:
    """Return rows by peer and case: times, their ratio to ours, contacts, depth and error."""
    rows = []
    for peer in comparison.peers:
        for case in comparison.cases:
            result = find_case(peer, case)
            if result is None:
                continue
            depth = result.depth
            rows.append(
                {
                    "peer": peer.key,
                    "case": case.key,
                    "median": result.median,
                    "p99": result.p99,
                    "least": result.least,
                    "ratio": compute_ratio(comparison, case, result),
                    "queries": result.queries,
                    "contacts": result.contacts,
                    "depth": depth,
                    "true_depth": comparison.true_depth(case),
                    "depth_error": None if depth is None else depth - comparison.true_depth(case),
                    "problem": result.problem,
                }
            )
    return rows


def list_drops(comparison: Comparison) -> list[dict[str, object]]:
    """Return a row for each peer, ground and rate."""
    return [{"peer": peer.key, **asdict(drop)} for peer in comparison.peers for drop in peer.drops]


def find_case(peer: PeerResult, case: Case) -> CaseResult | None:
    """Return the peer's result in a case; None if it was not queried."""
    return next((result for result in peer.cases if result.case == case.key), None)


def find_drop(peer: PeerResult, ground: str, rate: float) -> DropResult | None:
    """Return the peer's outcome of a drop; None if it did not drop."""
    return next((d for d in peer.drops if (d.other, d.rate) == (ground, rate)), None)


def compute_ratio(comparison: Comparison, case: Case, result: CaseResult) -> float:
    """Return the fastest time as a multiple of voxshell's contacts on voxels; NaN without it."""
    ours = next((peer for peer in comparison.peers if peer.key == REFERENCE), None)
    reference = None if ours is None else find_case(ours, case)
    return math.nan if reference is None else result.least / reference.least


# ---- cells ---------------------------------------------------------------------------------------


def format_times(
    comparison: Comparison, peer: PeerResult, case: Case, *, with_p99: bool = False
) -> str:
    """Return the median, perhaps p99, and the fastest as a multiple of ours: "16.1 µs 1.0x"."""
    result = find_case(peer, case)
    if result is None:
        return "-"
    if result.problem:
        return "error"
    ratio = compute_ratio(comparison, case, result)
    times = format_time(result.median) + (f" / {format_time(result.p99)}" if with_p99 else "")
    return times + (f" {format_ratio(ratio)}" if math.isfinite(ratio) else "")


def format_ratio(ratio: float) -> str:
    """Return a ratio with two significant digits, as "12x" (slower) or "1/13" (faster).

    Example:
        >>> [format_ratio(ratio) for ratio in (0.0754, 0.5, 1.0, 12.3, 1234.0)]
        ['1/13', '1/2.0', '1.0x', '12x', '1234x']
    """
    number = ratio if ratio >= 0.95 else 1.0 / ratio
    digits = 1 if number < 9.95 else 0
    return f"{number:.{digits}f}x" if ratio >= 0.95 else f"1/{number:.{digits}f}"


def format_depth(comparison: Comparison, peer: PeerResult, case: Case) -> str:
    """Return contacts, largest depth and its error: "94: 0.98 (-0.02)"."""
    result = find_case(peer, case)
    if result is None:
        return "-"
    if result.problem:
        return result.problem[:60]
    if result.contacts == 0:
        return "0: no contact"
    if result.depth is None:
        return f"{result.contacts}: none given"
    error = 1e3 * (result.depth - comparison.true_depth(case))
    # Avoid "-0.00".
    return f"{result.contacts}: {1e3 * result.depth:.2f} ({round(error, 2) + 0.0:+.2f})"


def format_error(comparison: Comparison, peer: PeerResult, case: Case) -> str:
    """Return contacts and the error of the largest depth, millimeters: "94 -0.02"."""
    result = find_case(peer, case)
    if result is None:
        return "-"
    if result.problem:
        return "error"
    if result.contacts == 0 or result.depth is None:
        return f"{result.contacts} -"
    error = 1e3 * (result.depth - comparison.true_depth(case))
    return f"{result.contacts} {round(error, 2) + 0.0:+.2f}"


def format_drop(drop: DropResult | None) -> str:
    """Return the result, and the height of the lowest vertex, millimeters: "rests -0.10"."""
    if drop is None:
        return "-"
    if drop.problem:
        return "error"
    if drop.outcome in ("through", "off", "unstable"):
        return drop.outcome
    return f"{drop.outcome} {round(1e3 * drop.rest_height, 1) + 0.0:+.1f}"


def format_preparation(peer: PeerResult) -> str:
    """Return seconds, with those of the decomposition: "247 + 0.2"."""
    if not math.isfinite(peer.preparation):
        return "-"
    parts = peer.settings.get("decomposition_seconds")
    before = f"{parts:.0f} + " if isinstance(parts, float) else ""
    return f"{before}{peer.preparation:.1f}"


def describe_truth(comparison: Comparison) -> str:
    """Return the origin of the true depths."""
    if comparison.truth_problem:
        return (
            f"computed once with libigl when the poses were made (not available in this run: "
            f"{comparison.truth_problem})"
        )
    version = next(iter(comparison.truths.values())).version
    return f"computed by libigl {version} at all vertices and face centers of both meshes"


def describe_load(peers: list[PeerResult]) -> str:
    """Return a sentence on the load: above the number of cores, other work competed."""
    loads = [peer.load for peer in peers]
    if not loads:
        return "nothing measured"
    return (
        f"load average {min(loads):.1f} to {max(loads):.1f} (a load above the number of cores means "
        "that other programs competed)"
    )


# ---- Markdown ------------------------------------------------------------------------------------


def write_markdown(comparison: Comparison, command: str) -> str:
    """Return the page: the setup, the tables, the settings of each engine."""
    measured = [peer for peer in comparison.peers if peer.cases or peer.drops]
    lines = [
        "# Comparison with other engines",
        *_describe_setup(comparison, measured, command),
        *_tabulate_times(comparison, measured),
        *_tabulate_depths(comparison, measured),
        *_tabulate_drops(comparison, [peer for peer in measured if peer.drops]),
        *_tabulate_settings(measured),
        *_tabulate_problems(comparison),
    ]
    return "\n".join(lines) + "\n"


def _describe_setup(comparison: Comparison, measured: list[PeerResult], command: str) -> list[str]:
    environment = comparison.environment
    depths = (
        f"{case.label.split()[0]} {1e3 * comparison.true_depth(case):.2f}"
        for case in comparison.cases
    )
    return [
        "",
        "This page compares voxshell with the libraries that people would otherwise use. The command",
        "",
        f"    {command}",
        "",
        f"wrote it at commit {environment['commit']}, on {environment['cores']} cores of "
        f"{environment['cpu']}, {environment['system']}, Python {environment['python']}, "
        f"{describe_load(measured)}. To install the other engines, run `pip install "
        "voxshell-studies[peers]`, or in a checkout `.venv/bin/pip install -c tools/constraints.txt -r "
        "tools/requirements-peers.txt`. For ODE, run `apt install libode8`. Each engine runs in a "
        "process of its own, with the settings below. If an engine is missing, fails or hangs, its row "
        "says so.",
        "",
        f"The body is the Stanford bunny, {LENGTH:g} m long. The true depths in millimeters, "
        f"{describe_truth(comparison)}, are: {', '.join(depths)}.",
    ]


def _tabulate_times(comparison: Comparison, peers: list[PeerResult]) -> list[str]:
    cases = comparison.cases
    return [
        "",
        "## Times",
        "",
        f"{POSES} poses that differ by at most {1e3 * SHIFT:g} mm and {1e3 * TURN:g} mrad are queried "
        f"repeatedly for {comparison.settings.case_seconds:g} s. A cell has three figures:",
        "",
        "1. the median time of a query;",
        "2. its 99th percentile;",
        "3. the median over poses of the least time, as a multiple of the first row's (`cases.csv` has the "
        "times). Other work on the machine disturbs the least time less, unless a query is longer than a "
        "time slice of some 4 ms.",
        "",
        "Preparation is in seconds; the time for convex parts comes first. The table of settings says "
        "what is timed. Pairs have no ground, so the rows with an analytic ground have no figures for "
        "them.",
        "",
        *_table(
            ["engine", "preparation, s", *(case.label for case in cases)],
            [
                [
                    peer.label,
                    format_preparation(peer),
                    *(format_times(comparison, peer, case, with_p99=True) for case in cases),
                ]
                for peer in peers
            ],
        ),
    ]


def _tabulate_depths(comparison: Comparison, peers: list[PeerResult]) -> list[str]:
    cases = comparison.cases
    return [
        "",
        "## Contacts and depths",
        "",
        "Each cell has the number of contacts in the first pose, the deepest depth reported in "
        "millimeters, and its error in parentheses. The true depth is the distance of the deepest point "
        "of either body from the other's surface. Convex shapes report the shortest separating "
        "translation instead, for each pair of parts. Meshes report how deep one triangle is in another.",
        "",
        *_table(
            ["engine", *(case.label for case in cases)],
            [
                [peer.label, *(format_depth(comparison, peer, case) for case in cases)]
                for peer in peers
            ],
        ),
    ]


def _tabulate_drops(comparison: Comparison, peers: list[PeerResult]) -> list[str]:
    if not peers:
        return []
    rates = comparison.settings.rates
    lines = [
        "",
        "## Drops",
        "",
        f"The bunny falls upright from {DROP_HEIGHT:g} m and is simulated for "
        f"{comparison.settings.drop_seconds:g} s. Each cell has the result and the height of the mesh's "
        "lowest vertex at the end in millimeters. *rests*: the bunny was slower than "
        f"{1e3 * REST_SPEED:g} mm/s and {REST_SPIN:g} rad/s for the last second. *moves*: it was not. "
        f"*sinks*: it is deeper than {1e3 * SUNK:g} mm at the end. *through*: its center is below the "
        "surface. *off*: it left the box sideways. *unstable*: the simulation diverged. `drops.csv` has "
        "the greatest depth of each drop.",
    ]
    for ground in GROUNDS:
        thick = 2e2 * BOX_HALF_EXTENTS[2]
        where = "plane" if ground == "plane" else f"box, {thick:g} cm thick"
        lines += [
            "",
            f"On the {where}:",
            "",
            *_table(
                ["engine", *(f"{rate:g} Hz" for rate in rates)],
                [
                    [peer.label, *(format_drop(find_drop(peer, ground, rate)) for rate in rates)]
                    for peer in peers
                ],
            ),
        ]
    return lines


def _tabulate_settings(peers: list[PeerResult]) -> list[str]:
    return [
        "",
        "## Settings",
        "",
        *_table(
            ["engine", "version", "timed", "settings"],
            [[peer.label, peer.version, peer.timed, format_settings(peer)] for peer in peers],
        ),
    ]


def _tabulate_problems(comparison: Comparison) -> list[str]:
    problems = list(list_problems(comparison))
    if not problems:
        return []
    return ["", "## Not measured", "", *_table(["engine", "what", "why"], problems)]


def format_settings(peer: PeerResult) -> str:
    """Return names and values."""
    return "; ".join(
        f"{name.replace('_', ' ')} {value:g}"
        if isinstance(value, float)
        else f"{name.replace('_', ' ')} {value}"
        for name, value in peer.settings.items()
    )


def list_problems(comparison: Comparison) -> Iterable[list[str]]:
    """Return peer, what is not measured, and why."""
    for peer in comparison.peers:
        if peer.status != "measured":
            yield [peer.label, peer.status, peer.reason]
        for case in peer.cases:
            if case.problem:
                yield [peer.label, case.case, case.problem]
        for drop in peer.drops:
            if drop.problem:
                yield [peer.label, f"drop, {drop.other}, {drop.rate:g} Hz", drop.problem]


def _table(headings: list[str], rows: Iterable[list[str]]) -> list[str]:
    def line(cells: list[str]) -> str:
        return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"

    return [line(headings), "|" + "---|" * len(headings), *map(line, rows)]


def _write_csv(path: Path, rows: list[dict[str, object]]) -> None:
    if rows:
        write_csv(path, rows[0], (row.values() for row in rows))
    else:
        write_text(path, "")
