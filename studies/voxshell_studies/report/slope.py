"""Report of the slope."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from voxshell_studies import slope
from voxshell_studies.experiment import Experiment, Picture
from voxshell_studies.report.figures import FAINT, OURS, OURS_PLANE, PEERS, open_figure
from voxshell_studies.slope import SlopeSettings
from voxshell_studies.verdict import Row, at_most

if TYPE_CHECKING:
    from pathlib import Path

    from voxshell_studies.experiment import Results

MOST_OFF = 2.0
"""Accepted error, percent of the angle."""

LABELS = {
    "regular": "regular contacts",
    "segmented": "segmented contacts",
    "bullet": "Bullet's box",
}


def describe(settings: SlopeSettings) -> str:
    """Return the setup as text."""
    size = " x ".join(f"{2e2 * half:g}" for half in settings.half_extents)
    return (
        f"A model of a box of {size} cm lies on a plane, and gravity is inclined. Bisection finds the "
        f"least angle at which the box slides more than {settings.least_slide * 1e3:g} mm in "
        f"{settings.seconds:g} s, for friction {', '.join(f'{f:g}' for f in settings.frictions)}. Ten "
        "degrees beyond Coulomb's angle, its acceleration is compared with g (sin a - mu cos a)."
    )


def reduce(settings: SlopeSettings, results: Results) -> list[Row]:
    """Return the verdicts."""
    del settings
    rows = []
    for kind in slope.KINDS:
        table = results[kind]["angles"]
        for i, friction in enumerate(table["friction"].tolist()):
            ours = kind != "bullet"
            off = abs(table["angle"][i] / table["ideal"][i] - 1.0) * 100
            pull = abs(table["acceleration"][i] / table["expected_acceleration"][i] - 1.0) * 100
            rows += [
                Row(
                    f"angle of sliding off Coulomb's, friction {friction:g}, {LABELS[kind]}",
                    None,
                    float(off),
                    "%",
                    bar=f"<= {MOST_OFF:g}" if ours else "",
                    holds=at_most(float(off), MOST_OFF) if ours else None,
                    note=f"{table['angle'][i]:.2f} instead of {table['ideal'][i]:.2f} degrees",
                ),
                Row(
                    f"acceleration beyond it off Coulomb's, friction {friction:g}, {LABELS[kind]}",
                    None,
                    float(pull),
                    "%",
                ),
            ]
    return rows


def draw(settings: SlopeSettings, results: Results, folder: Path) -> list[Picture]:
    """Draw angles over friction."""
    del settings
    with open_figure(folder / "angles.png", width=6, height=4) as figure:
        axes = figure.subplots()
        first = results["bullet"]["angles"]
        axes.plot(first["friction"], first["ideal"], color=FAINT, ls="--", label="Coulomb")
        for kind, color, marker in zip(
            slope.KINDS, (OURS, OURS_PLANE, PEERS[1]), "ox+", strict=True
        ):
            table = results[kind]["angles"]
            axes.plot(table["friction"], table["angle"], marker, color=color, label=LABELS[kind])
        axes.set(xlabel="friction", ylabel="angle of sliding, degrees")
        axes.legend(fontsize=8, frameon=False)
    return [Picture("angles.png", "The least angle at which the box slides.")]


SLOPE = Experiment(
    name="slope",
    title="Friction on a slope",
    question="Does a body of points begin to slide at Coulomb's angle?",
    describe=describe,
    settings=SlopeSettings(),
    quick=replace(SlopeSettings(), frictions=(0.5,)),
    plan=slope.plan,
    reduce=reduce,
    draw=draw,
    published=False,
)
