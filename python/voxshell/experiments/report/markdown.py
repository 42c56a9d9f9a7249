"""The verdicts as a text, for documents."""

from __future__ import annotations

from typing import TYPE_CHECKING

from voxshell._outputs import replacing
from voxshell.experiments.environment import describe_environment
from voxshell.experiments.verdict import format_value

if TYPE_CHECKING:
    from pathlib import Path

    from voxshell.experiments.reproduction import Finding
    from voxshell.experiments.verdict import Row


def write_markdown(path: Path, findings: list[Finding], *, command: str) -> None:
    """Writes a table an experiment, with set-ups and notes, as Markdown."""
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
            "\n".join(
                [
                    "| quantity | published | here | unit | ours should be | verdict | note |",
                    "|---|---|---|---|---|---|---|",
                    *map(_make_line, finding.rows),
                ]
            ),
        ]
    with replacing(path) as temporary:
        temporary.write_text("\n\n".join(parts) + "\n", encoding="utf-8")


def _make_line(row: Row) -> str:
    cells = (
        *(row.quantity, format_value(row.published), format_value(row.here), row.unit),
        *(row.bar, row.verdict, row.note),
    )
    return "| " + " | ".join(cell.replace("|", "/") for cell in cells) + " |"
