"""The verdicts as Markdown."""

from __future__ import annotations

from itertools import groupby
from typing import TYPE_CHECKING

from voxshell.base.outputs import write_text
from voxshell.measuring.environment import describe_environment

from voxshell_studies.verdict import format_value

if TYPE_CHECKING:
    from pathlib import Path

    from voxshell_studies.reproduction import Finding
    from voxshell_studies.verdict import Row

_HEAD = (
    "| quantity | published | here | unit | required of voxshell | verdict | note |",
    "|---|---|---|---|---|---|---|",
)


def write_markdown(path: Path, findings: list[Finding], *, command: str) -> None:
    """Write a table for each experiment, with set-ups and notes, as Markdown."""
    environment = describe_environment()
    parts = [
        "# Section 5.3, re-run",
        f"Made by `{command}` on {environment['cpu']}, {environment['cores']} cores, with Bullet "
        f"{environment['bullet']}, at commit {environment['commit'] or 'unknown'}. Absolute times are "
        "that machine's; ratios, orders and flatness compare.",
    ]
    for finding in findings:
        experiment = finding.study.experiment
        parts += [
            f"## {experiment.title}",
            f"{experiment.question} {experiment.describe(finding.study.settings)}",
            *_make_tables(finding.rows),
        ]
    write_text(path, "\n\n".join(parts) + "\n")


def _make_tables(rows: list[Row]) -> list[str]:
    """Return a table for each group, below its heading."""
    parts = []
    for group, members in groupby(rows, key=lambda row: row.group):
        if group:
            parts.append(f"### {group}")
        parts.append("\n".join([*_HEAD, *map(_make_line, members)]))
    return parts


def _make_line(row: Row) -> str:
    cells = (
        *(row.below_heading, format_value(row.published), format_value(row.here), row.unit),
        *(row.bar, row.verdict, row.note),
    )
    return "| " + " | ".join(cell.replace("|", "/") for cell in cells) + " |"
