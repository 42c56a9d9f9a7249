"""Numbers of everyday scenes by rate and engine: the worst of all placements, and tables."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np

from voxshell_studies.everyday.study import name_part
from voxshell_studies.verdict import format_value

if TYPE_CHECKING:
    from collections.abc import Sequence

    from voxshell_studies.everyday.study import EverydaySettings
    from voxshell_studies.experiment import Results
    from voxshell_studies.scenes.everyday.scene import Engine, EverydayScene, Measure

ENGINE_NAMES: dict[Engine, str] = {
    "voxshell": "voxshell",
    "bullet": "Bullet's own shapes",
    "mujoco": "MuJoCo",
}

_FRACTION_OF_BAR = 1e-9
"""Fraction of a bar below which errors count as equal."""


@dataclass(frozen=True)
class Worst:
    """The run of an engine with the largest error.

    Attributes:
        error: In terms of the bar; infinite if a run had no value.
        value: Value of that run, before the measure's scale.
        truth: True value, likewise.
        rate: Steps per second.
        placement: Number of the placement.
    """

    error: float
    value: float
    truth: float
    rate: float
    placement: int


@dataclass(frozen=True)
class Line:
    """One measure of one scene.

    Attributes:
        scene: The scene.
        measure: Its measure.
        worst: Worst runs by engine, of those that ran.
        by_rate: Worst errors by engine and rate.
    """

    scene: EverydayScene
    measure: Measure
    worst: dict[Engine, Worst]
    by_rate: dict[Engine, dict[float, float]]

    def holds(self, engine: Engine, rate: float | None = None) -> bool | None:
        """Return whether an engine's worst error is within the bar; None if it did not run."""
        if engine not in self.worst:
            return None
        error = self.worst[engine].error
        if rate is not None:
            if rate not in self.by_rate[engine]:
                return None
            error = self.by_rate[engine][rate]
        return error <= self.measure.bar * (1.0 + _FRACTION_OF_BAR)

    @property
    def is_best(self) -> bool:
        """True if no other engine that ran has a smaller worst error than voxshell."""
        others = [worst.error for engine, worst in self.worst.items() if engine != "voxshell"]
        ours = self.worst["voxshell"].error
        return bool(others) and ours <= min(others) * (1.0 + _FRACTION_OF_BAR)

    @property
    def verdict(self) -> str:
        """The verdict in a few words."""
        if self.holds("voxshell"):
            return "holds"
        others = [worst for engine, worst in self.worst.items() if engine != "voxshell"]
        if not others or all(
            math.isinf(worst.error) for worst in (*others, self.worst["voxshell"])
        ):
            return "falls short"
        return "falls short, best" if self.is_best else "falls short"


def make_lines(settings: EverydaySettings, results: Results) -> list[Line]:
    """Return a line for each measure of the scenes that voxshell ran, in the order of the list."""
    lines = []
    for scene in settings.chosen:
        tables = {
            engine: results[name_part(scene.name, engine)]["runs"]
            for engine in settings.engines_of(scene)
            if name_part(scene.name, engine) in results
        }
        if "voxshell" not in tables:
            continue
        for number, measure in enumerate(scene.measures):
            worst, by_rate = {}, {}
            for engine, runs in tables.items():
                mine = {key: column[runs["measure"] == number] for key, column in runs.items()}
                errors = np.where(np.isnan(mine["error"]), np.inf, mine["error"])
                if not len(errors):
                    continue
                first = int(np.argmax(errors))
                worst[engine] = Worst(
                    float(errors[first]),
                    float(mine["value"][first]),
                    float(mine["truth"][first]),
                    float(mine["rate"][first]),
                    int(mine["placement"][first]),
                )
                by_rate[engine] = {
                    rate: float(errors[mine["rate"] == rate].max())
                    for rate in settings.rates_of(scene)
                }
            if "voxshell" in worst:
                lines.append(Line(scene, measure, worst, by_rate))
    return lines


def format_error(measure: Measure, error: float | None) -> str:
    """Return an error as text: in the measure's unit, in percent if relative, or in words."""
    if error is None:
        return ""
    if measure.bar == 0.0 and measure.unit == "":
        return "right" if error == 0.0 else "wrong"
    if math.isinf(error):
        return "no value"
    if measure.relative:
        return "> 1,000 %" if error > 10.0 else f"{format_value(round(error * 100.0, 3))} %"
    if measure.bar == 0.0:
        return f"{error:g} off"
    shown = error * measure.scale
    if shown >= 1e4:
        return f"> {'10 m' if measure.unit == 'mm' else f'10,000 {measure.unit}'}"
    return f"{format_value(round(shown, 4))} {measure.unit}".strip()


def format_bar(measure: Measure) -> str:
    """Return the bar with its unit."""
    if measure.bar == 0.0:
        return "right" if measure.unit == "" else "0"
    return f"<= {format_error(measure, measure.bar)}"


def count_holding(lines: Sequence[Line], engine: Engine, rate: float | None) -> tuple[int, int]:
    """Return the numbers of measures within their limits and of measures that an engine ran."""
    told = [held for line in lines if (held := line.holds(engine, rate)) is not None]
    return sum(told), len(told)


def write_table(lines: Sequence[Line]) -> str:
    """Return tables as Markdown: counts by rate and engine, then a table for each group."""
    parts = ["### Measures within their limits", _write_counts(lines)]
    for group, members in groupby(lines, key=lambda line: line.scene.group):
        parts.append(f"### {group}")
        rows = [
            "| scene, measure | limit | 1000 Hz | 200 Hz | 60 Hz | 30 Hz | worst value (truth) "
            "| Bullet's own | MuJoCo | verdict |",
            "|---|---|---|---|---|---|---|---|---|---|",
        ]
        rows += map(_write_row, members)
        parts.append("\n".join(rows))
    return "\n\n".join(parts) + "\n"


def _write_counts(lines: Sequence[Line]) -> str:
    rates = sorted({rate for line in lines for rate in line.by_rate["voxshell"]}, reverse=True)
    rows = [
        f"| engine | {' | '.join(f'{rate:g} Hz' for rate in rates)} | all rates |",
        "|---" * (len(rates) + 2) + "|",
    ]
    for engine, name in ENGINE_NAMES.items():
        counts = [count_holding(lines, engine, rate) for rate in (*rates, None)]
        if counts[-1][1]:
            cells = " | ".join(f"{held} of {count}" for held, count in counts)
            rows.append(f"| {name} | {cells} |")
    return "\n".join(rows)


def _write_row(line: Line) -> str:
    measure, ours = line.measure, line.worst["voxshell"]
    rates = line.by_rate["voxshell"]
    scale = measure.scale
    value = (
        f"{format_value(ours.value * scale)} ({format_value(ours.truth * scale)}) {measure.unit}"
    )
    others = [
        format_error(measure, line.worst[engine].error) if engine in line.worst else "-"
        for engine in ("bullet", "mujoco")
    ]
    mark = " (held out)" if line.scene.held_out else ""
    cells = (
        f"{line.scene.name}: {measure.name}{mark}",
        format_bar(measure),
        *(format_error(measure, rates.get(rate)) for rate in (1000.0, 200.0, 60.0, 30.0)),
        value.strip(),
        *others,
        line.verdict,
    )
    return "| " + " | ".join(cells) + " |"
