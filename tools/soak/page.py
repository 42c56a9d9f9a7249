"""docs/evidence.md: the counters as a page."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from soak.ledger import ROOT, Record, digest, last_line
from soak.task import Task

PAGE = ROOT / "docs/evidence.md"
LISTED = 3  # findings of a task that the page shows

INTRODUCTION = """\
# Evidence

voxshell checks each promise below against an independent oracle and counts every run. `./dev soak` adds to the
counters until they reach the target of a release, and `./dev soak --write` writes this page. A row is **short**
while it is below its target, and short rows come first. "Found" counts the cases in which the promise did not
hold. Each counter belongs to the sources that its promise is about, as of the commit in the second table. A change to
these marks it as **older**, and the next run counts from zero. [evidence.json](evidence.json) has the counters, from which
runs go on.

The counters are numbers of random cases. They do not prove that the next case holds.
"""

AFTER = """\
Every case has a number, which seeds all its random values. `./dev soak --only NAME --case NUMBER` repeats one
case. The top of each task's file in `tools/soak/tasks` describes what the task does.
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
    """Fraction of the target."""
    return task.done(record.totals) / task.target


def count_row(task: Task, record: Record) -> str:
    """The counts of a task and its findings."""
    done = task.done(record.totals)
    short = " **short**" if done < task.target else ""
    if record.last and record.code != digest(task):
        short += " **older**"
    nothing = f"not run: {record.unavailable}" if record.unavailable else "nothing yet"
    measured = task.describe(record.totals) if record.totals.count else nothing
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
    """The origin of a counter."""
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


def escape(cell: str) -> str:
    """A cell without characters that would end it."""
    return cell.replace("|", "\\|").replace("\n", " ")
