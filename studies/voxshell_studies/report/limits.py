"""Report of the study of limits: a table for each row of the page of limits."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np
from voxshell.base.outputs import make_folder, write_text

from voxshell_studies import limits
from voxshell_studies.experiment import Experiment
from voxshell_studies.limits import LimitsSettings, name_run
from voxshell_studies.verdict import Row, format_value

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from voxshell_studies.experiment import Picture, Results
    from voxshell_studies.scenes.limits.scene import LimitScene

TABLE = "table.md"
"""Name of the file with the tables for documents."""


@dataclass(frozen=True)
class Line:
    """One scene.

    Attributes:
        scene: The scene.
        values: By rate, the value of each placement; NaN where there was none.
    """

    scene: LimitScene
    values: dict[float, NDArray[np.float64]]

    def worst(self, rate: float) -> float:
        """Return the value farthest from the truth at a rate."""
        values = self.values[rate]
        errors = np.where(np.isfinite(values), np.abs(values - self.scene.truth), np.inf)
        return float(values[int(np.argmax(errors))])

    def format(self, rate: float) -> str:
        """Return the values at a rate as text: the median, and the worst of several placements."""
        if rate not in self.values:
            return ""
        values = self.values[rate]
        # Without a value, a median would depend on what a NaN is counted as.
        middle = float(np.median(values)) if np.isfinite(values).all() else float("nan")
        text = _shorten(middle)
        worst = _shorten(self.worst(rate))
        return text if worst == text else f"{text} ({worst})"


def _shorten(value: float) -> str:
    """Return a value as text, without what is below a thousandth."""
    return format_value(round(value, 3) + 0.0)


def make_lines(settings: LimitsSettings, results: Results) -> list[Line]:
    """Return a line for each scene that ran."""
    lines = []
    for scene in settings.chosen:
        values = {
            rate: results[name_run(scene, rate)]["runs"]["value"]
            for rate in settings.rates_of(scene)
        }
        if values:
            lines.append(Line(scene, values))
    return lines


def describe(settings: LimitsSettings) -> str:
    """Return the setup as text."""
    rates = sorted({rate for scene in settings.chosen for rate in settings.rates_of(scene)})
    return (
        f"{len(settings.chosen)} scenes run at default settings, at "
        f"{', '.join(f'{rate:g}' for rate in rates)} Hz, in up to {settings.placements} placements. "
        "Each yields one number, beside the number that it should be."
    )


def reduce(settings: LimitsSettings, results: Results) -> list[Row]:
    """Return a row for each scene: the value that is farthest from the truth."""
    rows = []
    for line in make_lines(settings, results):
        scene = line.scene
        rate = max(line.values, key=lambda rate: _distance(line, rate))
        values = ", ".join(f"{rate:g} Hz {line.format(rate)}" for rate in line.values)
        rows.append(
            Row(
                f"{scene.group[:1].lower()}{scene.group[1:]}, {scene.name}, {scene.measured}",
                None,
                line.worst(rate),
                scene.unit,
                note=f"worst at {rate:g} Hz, to be {format_value(scene.truth)}; {values}",
                group=scene.group,
            )
        )
    return rows


def _distance(line: Line, rate: float) -> float:
    worst = line.worst(rate)
    return abs(worst - line.scene.truth) if np.isfinite(worst) else float("inf")


def write_table(lines: Sequence[Line]) -> str:
    """Return a Markdown table for each group."""
    parts = []
    for group, members in groupby(lines, key=lambda line: line.scene.group):
        rows = [
            "| scene: measured | truth | 1000 Hz | 200 Hz | 60 Hz | 30 Hz |",
            "|---|---|---|---|---|---|",
        ]
        for line in members:
            scene = line.scene
            unit = f", {scene.unit}" if scene.unit else ""
            cells = (
                f"{scene.name}: {scene.measured}{unit}",
                format_value(scene.truth),
                *(line.format(rate) for rate in (1000.0, 200.0, 60.0, 30.0)),
            )
            rows.append(f"| {' | '.join(cells)} |")
        parts += [f"### {group}", "\n".join(rows)]
    return "\n\n".join(parts) + "\n"


def draw(settings: LimitsSettings, results: Results, folder: Path) -> list[Picture]:
    """Write the tables; there are no pictures."""
    make_folder(folder)
    write_text(folder / TABLE, write_table(make_lines(settings, results)))
    return []


LIMITS = Experiment(
    name="limits",
    title="Limits",
    question="How far is motion from the truth in the scenes of the limits page, at default settings?",
    describe=describe,
    settings=LimitsSettings(),
    quick=replace(LimitsSettings(), placements=1),
    plan=limits.plan,
    reduce=reduce,
    draw=draw,
    published=False,
)
