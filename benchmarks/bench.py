#!/usr/bin/env python3
"""Runs the benchmarks, keeps their figures with machine and commit, and prints them as a table.

`./dev bench` builds the benchmarks and calls this. The results stay in build/bench/.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from machine import ROOT, describe_machine
from results import (
    BARS,
    BARS_RESOLUTION,
    MOST_MANIFOLD_GROWTH,
    compare,
    growth,
    holds,
    ratio_to_flat,
    read_cases,
)
from rich import box
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

PROGRAM = ROOT / "build/benchmarks/benchmarks/voxshell_benchmarks"
OUT = ROOT / "build/bench"


def read_arguments(arguments: list[str]) -> tuple[argparse.Namespace, list[str]]:
    """The options, and what is passed on to the program."""
    parser = argparse.ArgumentParser(
        prog="./dev bench",
        allow_abbrev=False,
        description="Other options (--poses=N, --resolution=N, --seconds=S, --build_limit=S) go to "
        "the program.",
    )
    parser.add_argument("--quick", action="store_true", help="fewer poses and sizes: in 2 minutes")
    parser.add_argument("--filter", default="", help="only cases whose name matches this pattern")
    parser.add_argument("--compare", type=Path, metavar="OLD.json", help="ratios to an earlier run")
    parser.add_argument("--json", action="store_true", help="print the results as JSON alone")
    return parser.parse_known_args(arguments)


def run_program(options: list[str], pattern: str, progress: Progress) -> dict[str, Any]:
    """Runs all cases in one process; google-benchmark's JSON."""
    command = [str(PROGRAM), *options]
    if pattern:
        command.append(f"--benchmark_filter={pattern}")
    listed = subprocess.run(
        [*command, "--benchmark_list_tests"], check=True, capture_output=True, text=True
    )
    names = set(listed.stdout.split())
    if not names:
        sys.exit(f"bench: no case matches {pattern!r}")
    task = progress.add_task("measuring", total=len(names))
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryFile("w+") as log:
        path = Path(folder) / "results.json"
        command += [f"--benchmark_out={path}", "--benchmark_out_format=json"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=log, text=True) as process:
            assert process.stdout is not None
            for line in process.stdout:
                words = line.split()
                if words and words[0] in names:
                    progress.update(task, advance=1, description=words[0].split("/iterations")[0])
        if process.returncode != 0:
            log.seek(0)
            said = log.read().splitlines()[-1:]
            sys.exit(f"bench: {PROGRAM.name} ended with {process.returncode}: {' '.join(said)}")
        return json.loads(path.read_text())


def format_time(value: float) -> str:
    """Microseconds in three digits."""
    return f"{value:.3g}" if value < 1000 else f"{value:,.0f}"


def format_holds(value: bool | None) -> str:
    """A word for a bar's column."""
    return {None: "", True: "yes", False: "no"}[value]


def make_table(title: str) -> Table:
    """A table whose first column names the case."""
    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("case", no_wrap=True)
    return table


def make_query_table(cases: dict[str, dict[str, Any]]) -> Table:
    """One row a query case; the answer is the mean number of contacts, or the fraction of yes."""
    table = make_table("queries, microseconds")
    for heading in ("answer", "median", "least", "p99", "bar", "flat/this", "holds"):
        table.add_column(heading, justify="right")
    for name, case in cases.items():
        if name.startswith(("build/", "load/")):
            continue
        if "why_not" in case:
            table.add_row(f"{name}  {case['why_not']}")
            continue
        if "median_us" not in case:
            continue
        bar = BARS.get((name, "median_us"))
        ratio = ratio_to_flat(cases, name)
        table.add_row(
            name,
            f"{case['answer']:.1f}",
            format_time(case["median_us"]),
            format_time(case["least_us"]) if "least_us" in case else "",
            format_time(case["p99_us"]),
            "" if bar is None else f"{bar.most:g}",
            "" if ratio is None else f"{ratio:.3g}",
            format_holds(holds(cases, name, "median_us")),
        )
    return table


def make_build_table(cases: dict[str, dict[str, Any]]) -> Table | None:
    """One row a model built or loaded; None without any."""
    built = {name: case for name, case in cases.items() if name.startswith(("build/", "load/"))}
    if not built:
        return None
    table = make_table("models")
    for heading in ("seconds", "bar", "holds", "field MB", "model MB", "bar", "holds"):
        table.add_column(heading, justify="right")
    for name, case in built.items():
        if "why_not" in case:
            table.add_row(f"{name}  {case['why_not']}")
            continue
        cells = []
        for figure, unit in (("seconds", 1.0), ("model_bytes", 1e6)):
            bar = BARS.get((name, figure))
            value = case.get(figure)
            cells += [
                "" if value is None else f"{value / unit:.3g}",
                "" if bar is None else f"{bar.most / unit:g}",
                format_holds(holds(cases, name, figure)),
            ]
        field = case.get("field_bytes")
        cells.insert(3, "" if field is None else f"{field / 1e6:.3g}")
        table.add_row(name, *cells)
    return table


def describe_stages(cases: dict[str, dict[str, Any]]) -> list[str]:
    """A line for each model built: the seconds of its stages."""
    lines = []
    for name, case in cases.items():
        stages = [
            f"{key.removeprefix('stage_').replace('_', ' ')} {value:.2g} s"
            for key, value in case.items()
            if key.startswith("stage_")
        ]
        if stages:
            lines.append(f"{name}: {', '.join(stages)}")
    return lines


def make_comparison_table(old: dict[str, Any], new: dict[str, Any]) -> Table:
    """Before, after and their ratio, the most changed first."""
    table = make_table(f"against {old['machine']['commit']}")
    table.add_column("figure")
    for heading in ("before", "after", "before/after"):
        table.add_column(heading, justify="right")
    rows = sorted(compare(old, new), key=lambda row: row[2] / row[3])
    for name, figure, before, after in rows:
        table.add_row(
            name, figure, format_time(before), format_time(after), f"{before / after:.2f}"
        )
    return table


def print_results(results: dict[str, Any], console: Console) -> None:
    """The tables, under what they were measured on."""
    machine, context, cases = results["machine"], results["context"], results["cases"]
    caches = ", ".join(
        f"L{cache['level']}{cache['type'][0] if cache['level'] == 1 else ''} {cache['size'] >> 10} kB"
        for cache in context["caches"]
    )
    console.print(
        f"{machine['cpu']}, {machine['cores']} cores ({caches}; {' '.join(machine['vector_sets'])})"
        f"\n{context['compiler']} {context['flags']}, commit {machine['commit']}, {machine['date']}"
        f"\nvoxels along the bunny: {context['resolution']}; each time includes "
        f"{1e3 * float(context['clock_overhead_us']):.0f} ns of reading the clock",
        highlight=False,
        soft_wrap=True,
    )
    if int(context["resolution"]) != BARS_RESOLUTION:
        console.print(f"the bars are for {BARS_RESOLUTION} voxels along the bunny", style="bold")
    if table := make_build_table(cases):
        console.print(table)
        for line in describe_stages(cases):
            console.print(line, highlight=False)
    console.print(make_query_table(cases))
    depth = cases.get("pair_deepest/depth_error", {})
    if "voxels" in depth:
        console.print(
            f"73.6 mm deep, the deepest contact is off the true depth by {depth['median_voxels']:.2f} "
            f"voxels, {depth['voxels']:.2f} at worst, by one at most in "
            f"{depth['fraction_within_voxel']:.0%} of the poses (bar {BARS['pair_deepest/depth_error', 'voxels'].most:g})"
        )
    for query in ("contacts", "manifold", "segments"):
        exponent = growth(cases, query)
        if exponent is not None:
            bar = f" (bar {MOST_MANIFOLD_GROWTH})" if query != "contacts" else ""
            console.print(f"{query}: time grows with points^{exponent:.2f}{bar}")


def exit_code(cases: dict[str, dict[str, Any]]) -> int:
    """1 where a query was wrong, whatever its time."""
    return int(
        any("differs from the flat loop" in case.get("why_not", "") for case in cases.values())
    )


def main(arguments: list[str]) -> int:
    """The command line; returns the exit code."""
    options, passed_on = read_arguments(arguments)
    old = json.loads(options.compare.read_text()) if options.compare else None
    if options.quick:
        passed_on.insert(0, "--quick")  # before what changes its settings
    console = Console()
    if not console.is_terminal:
        console = Console(width=120)
    with Progress(console=Console(stderr=True), transient=True) as progress:
        machine = describe_machine()
        measured = run_program(passed_on, options.filter, progress)
    results = {
        "machine": machine,
        "context": measured["context"],
        "options": passed_on,
        "cases": read_cases(measured["benchmarks"]),
    }
    OUT.mkdir(parents=True, exist_ok=True)
    stamp = str(machine["date"]).replace(":", "").split("+")[0]
    path = OUT / f"{stamp}-{machine['commit']}.json"
    path.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")
    if options.json:
        print(json.dumps(results, indent=2))
        return exit_code(results["cases"])
    print_results(results, console)
    if old is not None:
        console.print(make_comparison_table(old, results))
    written = [path]
    if any(name.startswith(("points_", "voxels_")) for name in results["cases"]):
        from plots import draw_scaling

        written.append(draw_scaling(path))
    for file in written:
        console.print(f"wrote {file.relative_to(ROOT)}", highlight=False)
    return exit_code(results["cases"])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
