"""Report of everyday scenes."""

from __future__ import annotations

from dataclasses import replace
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np
from voxshell.base.outputs import make_folder, write_text
from voxshell.model.meshes import Mesh

from voxshell_studies.everyday import study
from voxshell_studies.everyday.study import EverydaySettings, name_part
from voxshell_studies.experiment import Experiment, Picture
from voxshell_studies.motion import restore
from voxshell_studies.report.everyday.table import (
    ENGINE_NAMES,
    count_holding,
    format_bar,
    format_error,
    make_lines,
    write_table,
)
from voxshell_studies.report.figures import OURS, as_rgb, open_figure
from voxshell_studies.report.paint import thin_out
from voxshell_studies.scenes.everyday.scene import ENGINES
from voxshell_studies.verdict import Row, format_value

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from voxshell_studies.experiment import Results
    from voxshell_studies.motion import Surface
    from voxshell_studies.part import Tables
    from voxshell_studies.report.everyday.table import Line
    from voxshell_studies.scenes.everyday.scene import Engine, EverydayScene, Item

TABLE = "table.md"
"""Name of the file with the tables for documents."""

MOST_DECADES = 3.0
"""Errors below a thousandth and above a thousand bars are drawn at these limits."""


def describe(settings: EverydaySettings) -> str:
    """Return the setup as text."""
    rates = sorted({rate for scene in settings.chosen for rate in settings.rates_of(scene)})
    ran = ", ".join(ENGINE_NAMES[engine] for engine in ENGINES if engine in settings.engines)
    return (
        f"{len(settings.chosen)} ordinary scenes run at default settings. Each has an independent truth: "
        "a closed form, summed over time steps where these matter, or an argument that anyone can "
        f"check. The rates are {', '.join(f'{rate:g}' for rate in rates)} Hz, with up to "
        f"{settings.placements} headings or positions each, for at most {settings.longest:g} s. The "
        f"worst run counts. The engines are {ran}, where they can represent the scene and are installed."
    )


def reduce(settings: EverydaySettings, results: Results) -> list[Row]:
    """Return the verdicts: the number of measures that hold, then all measures."""
    lines = make_lines(settings, results)
    return [*_summarize(settings, lines), *(_make_row(line) for line in lines)]


def _summarize(settings: EverydaySettings, lines: Sequence[Line]) -> list[Row]:
    rows = []
    rates = sorted({rate for line in lines for rate in line.by_rate["voxshell"]}, reverse=True)
    for engine in ENGINES:
        if engine not in settings.engines:
            continue
        held, count = count_holding(lines, engine, None)
        ours = engine == "voxshell"
        note = ", ".join(
            "{:g} Hz {} of {}".format(rate, *count_holding(lines, engine, rate)) for rate in rates
        )
        rows.append(
            Row(
                f"measures within their limits, {ENGINE_NAMES[engine]}",
                None,
                float(held),
                f"of {count}",
                bar=f"{count}" if ours else "",
                holds=held == count if ours else None,
                note=note if count else "not installed, or no scene that it can represent was run",
            )
        )
    fair = [line for line in lines if line.holds("voxshell") or line.verdict == "falls short, best"]
    rows.append(
        Row(
            "measures within their limits or no worse than the best of the others",
            None,
            float(len(fair)),
            f"of {len(lines)}",
            bar=f"{len(lines)}",
            holds=len(fair) == len(lines),
        )
    )
    held_out = [line for line in lines if line.scene.held_out]
    kept = sum(bool(line.holds("voxshell")) for line in held_out)
    rows.append(
        Row(
            "held-out measures within their limits",
            None,
            float(kept),
            f"of {len(held_out)}",
            bar=f"{len(held_out)}" if held_out else "",
            holds=kept == len(held_out) if held_out else None,
            note="" if held_out else "no scene is held out yet",
        )
    )
    return rows


def _make_row(line: Line) -> Row:
    measure, ours = line.measure, line.worst["voxshell"]
    scale = 100.0 if measure.relative else measure.scale
    rates = ", ".join(
        f"{rate:g} Hz {format_error(measure, error)}"
        for rate, error in line.by_rate["voxshell"].items()
    )
    others = "".join(
        f"; {ENGINE_NAMES[engine]} {format_error(measure, worst.error)}"
        for engine, worst in line.worst.items()
        if engine != "voxshell"
    )
    value = (
        f"worst {format_value(ours.value * measure.scale)} of "
        f"{format_value(ours.truth * measure.scale)} {measure.unit}".rstrip()
    )
    held = bool(line.holds("voxshell"))
    mark = ", held out" if line.scene.held_out else ""
    best = ", no worse than the others" if not held and line.verdict.endswith("best") else ""
    return Row(
        f"{line.scene.group[:1].lower()}{line.scene.group[1:]}, {line.scene.name}, {measure.name}{mark}",
        None,
        ours.error * scale,
        "% off" if measure.relative else f"{measure.unit} off".strip(),
        bar=format_bar(measure),
        holds=held,
        note=f"{value} at {ours.rate:g} Hz in placement {ours.placement}; {rates}{others}{best}",
        group=line.scene.group,
    )


# ---- figures -------------------------------------------------------------------------------------


def draw(settings: EverydaySettings, results: Results, folder: Path) -> list[Picture]:
    """Draw errors relative to bars by rate and engine, and write tables and replays."""
    lines = make_lines(settings, results)
    make_folder(folder)
    write_text(folder / TABLE, write_table(lines))
    pictures = []
    if lines:
        _draw_errors(lines, folder / "errors.png")
        pictures.append(
            Picture(
                "errors.png",
                "The worst error of each measure over its bar: white at the bar, green within it, red beyond; gray "
                "where an engine did not run.",
            )
        )
    for scene in settings.chosen:
        part = name_part(scene.name, "shown")
        if part in results:
            name = f"replay-{part.removesuffix('-shown')}.html"
            _save_replay(scene, results[part], folder / name)
            pictures.append(Picture(name, f"{scene.name}, with models. {scene.law}"))
    return pictures


def _draw_errors(lines: Sequence[Line], path: Path) -> None:
    columns: list[tuple[Engine, float]] = [
        (engine, rate)
        for engine in ENGINES
        for rate in sorted(
            {r for line in lines for r in line.by_rate.get(engine, {})}, reverse=True
        )
    ]
    shown = np.full((len(lines), len(columns)), np.nan)
    for i, line in enumerate(lines):
        for j, (engine, rate) in enumerate(columns):
            error = line.by_rate.get(engine, {}).get(rate)
            if error is not None:
                shown[i, j] = _count_decades(error, line.measure.bar)
    with open_figure(path, width=11, height=2.0 + 0.17 * len(lines)) as figure:
        axes = figure.subplots()
        picture = axes.imshow(
            np.ma.masked_invalid(shown),
            aspect="auto",
            cmap="RdYlGn_r",
            vmin=-MOST_DECADES,
            vmax=MOST_DECADES,
            interpolation="nearest",
        )
        axes.set_facecolor("#d8d8d8")
        axes.set_xticks(
            range(len(columns)),
            [f"{engine}\n{rate:g} Hz" for engine, rate in columns],
            fontsize=7,
        )
        axes.xaxis.tick_top()
        axes.set_yticks(
            range(len(lines)),
            [f"{line.scene.name}: {line.measure.name}" for line in lines],
            fontsize=6,
        )
        for engine, members in groupby(enumerate(columns), key=lambda each: each[1][0]):
            del engine
            axes.axvline(list(members)[-1][0] + 0.5, color="black", lw=1.0)
        bar = figure.colorbar(picture, ax=axes, shrink=min(1.0, 8.0 / len(lines)), pad=0.01)
        bar.set_label("decades above the bar", fontsize=7)


def _count_decades(error: float, bar: float) -> float:
    """Return the logarithm of an error relative to its bar, clipped; all or nothing if one is 0."""
    if bar == 0.0 or error == 0.0 or np.isinf(error):
        return MOST_DECADES if error > bar else -MOST_DECADES
    return float(np.clip(np.log10(error / bar), -MOST_DECADES, MOST_DECADES))


def _save_replay(scene: EverydayScene, tables: Tables, path: Path) -> None:
    from voxshell.viewer.lanes import arrange_lanes
    from voxshell.viewer.replay import save_replay

    stage = scene.stage(0)
    surfaces = {item.name: _surface(item) for item in stage.items}
    step = float(tables["frames"]["time_step"][0])
    recording = restore(tables, surfaces, step)
    save_replay(path, arrange_lanes({scene.name: recording}), title=scene.name, caption=scene.law)


def _surface(item: Item) -> Surface:
    color = as_rgb(OURS) if item.moves else None
    if item.form.mesh is None:
        side = 1.0
        corners = np.array([(-side, -side, 0), (side, -side, 0), (side, side, 0), (-side, side, 0)])
        return Mesh(corners.astype(np.float64), np.array([(0, 1, 2), (0, 2, 3)], np.uint32)), color
    mesh = item.form.mesh
    if len(mesh.faces) > 2_000:
        mesh = thin_out(mesh, float(np.ptp(mesh.vertices, axis=0).max()) / 40)
    return mesh, color


EVERYDAY = Experiment(
    name="everyday",
    title="Everyday scenes",
    question="Do bodies slide, roll, bounce, spin, hang and stand as mechanics predicts, at default settings?",
    describe=describe,
    settings=EverydaySettings(),
    quick=replace(
        EverydaySettings(),
        placements=2,
        heavy_placements=1,
        longest=2.0,
        heavy_rates=(200.0,),
    ),
    plan=study.plan,
    reduce=reduce,
    draw=draw,
    published=False,
)
