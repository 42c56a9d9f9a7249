"""docs/evidence.md: the counters as a page."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from soak.ledger import ROOT, Record
from soak.task import Task

PAGE = ROOT / "docs/evidence.md"
LISTED = 3  # findings of a task that the page shows

INTRODUCTION = """\
# Evidence

Each promise below is held to an independent oracle, and every run is counted. `./dev soak` adds to the
counters until they reach what a release asks for, and `./dev soak --write` writes this page. A row is
**short** while it is below that target, and such rows come first. "Found" counts the cases in which the
promise did not hold. Counters speak of the code as it was at the commit in the second table: a change to the
library's sources starts them again.

These are the numbers of random cases that were tried. They are no proof that the next one holds.
"""

AFTER = """\
Every case has a number, which seeds all that is random in it. `./dev soak --only NAME --case NUMBER` runs one
case again. What each task does stands at the top of its file in `tools/soak/tasks`.
"""


def write_page(tasks: Mapping[str, Task], records: Mapping[str, Record], path: Path = PAGE) -> None:
    """Writes the page."""
    path.write_text(render(tasks, records), encoding="utf-8")


def render(tasks: Mapping[str, Task], records: Mapping[str, Record]) -> str:
    """The page as Markdown."""
    # Short rows first, the farthest from its target on top.
    order = sorted(tasks, key=lambda name: min(1.0, reach(tasks[name], records[name])))
    counts = [
        "| promise | run | target | found | measured |",
        "|---|---|---|---|---|",
        *(count_row(tasks[name], records[name]) for name in order),
    ]
    origins = [
        "| counter | oracle | command | last run (UTC) | commit | machine |",
        "|---|---|---|---|---|---|",
        *(origin_row(name, tasks[name], records[name]) for name in order),
    ]
    parts = [INTRODUCTION, "\n".join(counts) + "\n"]
    if findings := list_findings(tasks, records):
        parts.append("## What was found\n\n" + "\n".join(findings) + "\n")
    parts += ["## Where the numbers come from\n\n" + "\n".join(origins) + "\n", AFTER]
    return "\n".join(parts)


def reach(task: Task, record: Record) -> float:
    """Share of the target."""
    return task.done(record.totals) / task.target


def count_row(task: Task, record: Record) -> str:
    """How much was run, and what came of it."""
    done = task.done(record.totals)
    short = " **short**" if done < task.target else ""
    measured = task.describe(record.totals) if record.totals.count else "nothing yet"
    if record.unavailable:
        measured = f"not run: {record.unavailable}"
    if record.totals.count and (doubt := task.doubt(record.totals)):
        measured += f". **Proves little:** {doubt}"
    cells = (
        task.promise,
        f"{done:,.0f} {task.unit}{short}",
        f"{task.target:,.0f}",
        f"**{record.found:,}**" if record.found else "0",
        measured,
    )
    return f"| {' | '.join(escape(cell) for cell in cells)} |"


def origin_row(name: str, task: Task, record: Record) -> str:
    """Where a counter is from."""
    cells = (
        name,
        task.oracle,
        f"`./dev soak --only {name}`",
        record.last or "never",
        record.commit and f"`{record.commit}`",
        record.machine,
    )
    return f"| {' | '.join(escape(cell) for cell in cells)} |"


def list_findings(tasks: Mapping[str, Task], records: Mapping[str, Record]) -> list[str]:
    """The first findings of each task, and how many more there are."""
    lines: list[str] = []
    for name, task in tasks.items():
        record = records[name]
        for fault in record.faults[:LISTED]:
            lines.append(
                f"- {task.promise}: `./dev soak --only {name} --case {fault['case']}` says "
                f"`{last_line(fault['what'])}`"
            )
        if record.found > LISTED:
            lines.append(f"- and {record.found - LISTED:,} more of `{name}`")
    return lines


def last_line(text: str) -> str:
    """What an error says last, short enough for a list."""
    return (text.strip().splitlines() or ["?"])[-1][:200].replace("`", "'")


def escape(cell: str) -> str:
    """A cell without what ends one."""
    return cell.replace("|", "\\|").replace("\n", " ")
