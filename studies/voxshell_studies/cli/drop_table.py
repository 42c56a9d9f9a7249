"""The table that a drop prints."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from rich import box
from rich.table import Table
from voxshell.measuring.units import format_time

from voxshell_studies.drop import FULL_OPERATION, REST_STEPS
from voxshell_studies.scenes.drop import GROUND_HALF_EXTENTS

if TYPE_CHECKING:
    from voxshell_studies.drop import DropRun, DropSummary


def make_table(runs: list[DropRun], summaries: list[DropSummary]) -> Table:
    """Return a table of 80 columns with a row for each method."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    table.add_column("method\n", no_wrap=True)
    for heading in (
        "narrow\nmedian",
        "phase\np99",
        "ratio\nhere",
        "ratio\nthesis",
        "con-\ntacts",
        "deep\nmm",
        "rest\nmm/s",
        "low\nmm",
    ):
        table.add_column(heading, justify="right", no_wrap=True)
    for run, summary in zip(runs, summaries, strict=True):
        table.add_row(
            run.method.label,
            format_time(summary.median),
            format_time(summary.p99),
            format_ratio(summary.ratio),
            format_ratio(run.method.thesis_ratio),
            f"{summary.mean_contacts:.1f}" if summary.steps > FULL_OPERATION[0] else "-",
            _format_thousandths(summary.deepest, 1),
            _format_thousandths(summary.rest_speed, 2),
            _format_thousandths(summary.rest_lowest, 2, "+"),
        )
    return table


def explain(runs: list[DropRun], steps: int) -> str:
    """Return an explanation of the table's columns and of special values."""
    first, last = FULL_OPERATION
    lines = [
        f"narrow phase  all of Bullet's work on the pair in a step; steps {first} to {last}",
        "ratio         to VPS fine; thesis: as published in section 5.3 (fine: 0.71 ms)",
        "deep          deepest contact that the method itself reported, in any step",
        f"rest          largest speed of the center of mass in the last {REST_STEPS} steps",
        "low           lowest vertex of the mesh over the ground then, whatever collided",
        "ground        a block: voxels for VPS, a btBoxShape for others; or a plane",
    ]
    short = [run for run in runs if run.steps < steps]
    if short:
        names = ", ".join(f"{run.method.label} ({run.steps} steps)" for run in short)
        lines.append(f"fewer steps   because it is slow: {names}")
    underside = -2.0 * GROUND_HALF_EXTENTS[2]
    for run in runs:
        below = run.lowest < underside
        if below.any():
            step = int(below.argmax()) + 1
            lines.append(
                f"fallen        {run.method.label} is below the ground from step {step} on"
            )
    return "\n".join(lines)


def format_ratio(ratio: float | None) -> str:
    """Return a factor above or below one as text: "137", "1/4.0", "1/339".

    Example:
        >>> [format_ratio(r) for r in (137.2, 1.0, 0.25, 0.00295, None)]
        ['137', '1.0', '1/4.0', '1/339', '']
    """
    if ratio is None or not math.isfinite(ratio) or ratio <= 0.0:
        return ""
    number, prefix = (ratio, "") if ratio >= 0.995 else (1.0 / ratio, "1/")
    return f"{prefix}{number:.0f}" if number >= 10 else f"{prefix}{number:.1f}"


def _format_thousandths(value: float, decimals: int, sign: str = "") -> str:
    """Return a length in millimeters as text; without decimals if it is large."""
    number = value * 1e3
    return f"{number:{sign}.{decimals if abs(number) < 100.0 else 0}f}"
