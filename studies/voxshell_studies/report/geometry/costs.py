"""Report of the geometry study on time and memory of models."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from voxshell_studies.geometry.costs import ASKED, COMPARED, KINDS
from voxshell_studies.scenes.geometry import BUILT
from voxshell_studies.verdict import Row, at_most, format_value

if TYPE_CHECKING:
    from voxshell_studies.geometry.study import GeometrySettings
    from voxshell_studies.part import Columns, Tables

SECONDS_BAR, BYTES_BAR = 3.0, 64e6

QUERY_BAR, MEMORY_BAR, BUILD_BAR = 1.3, 1.0, 1.5
"""Limits for a model by tolerance, relative to an equally accurate uniform one."""


def judge_builds(table: Columns) -> list[Row]:
    """Return rows on whether default builds are fast and small, and on their warnings."""
    within = (table["seconds"] <= SECONDS_BAR) & (table["bytes"] <= BYTES_BAR)
    broken = ~within & (table["warnings"] == 0.0)
    names = [body for body, fails in zip(BUILT, broken, strict=False) if fails]
    slowest, largest = int(np.argmax(table["seconds"])), int(np.argmax(table["bytes"]))
    return [
        Row(
            "default builds beyond 3 s or 64 MB without a warning",
            None,
            len(names),
            f"of {len(broken)}",
            bar="0",
            holds=not names,
            note=", ".join(names),
        ),
        Row(
            "slowest default build",
            None,
            float(table["seconds"][slowest]),
            "s",
            note=BUILT[slowest],
        ),
        Row(
            "largest default model",
            None,
            float(table["bytes"][largest]) / 1e6,
            "MB",
            note=BUILT[largest],
        ),
    ]


def judge_costs(settings: GeometrySettings, tables: Tables) -> list[Row]:
    """Return rows that compare a model by tolerance with an equally accurate uniform one."""
    builds, queries = tables["builds"], tables["queries"]
    seconds, size, points, segments, tolerance, field, shell = (
        [float(np.median(builds[column][builds["kind"] == kind])) for kind in range(len(KINDS))]
        for column in ("seconds", "bytes", "points", "segments", "tolerance", "field", "shell")
    )
    rows = [
        Row(
            "memory of field and shell",
            None,
            size[1] / size[0],
            "times",
            bar=f"<= {MEMORY_BAR:g}",
            holds=at_most(size[1], MEMORY_BAR * size[0]),
            note=f"{COMPARED} to {format_value(tolerance[1] * 1e3)} mm, {size[1] / 1e6:.1f} MB, and of "
            f"{settings.compared_resolution} uniform voxels, {size[0] / 1e6:.1f} MB: {points[1]:,.0f} points "
            f"and {segments[1]:,.0f} segments instead of {points[0]:,.0f} points; 99 % of the field within "
            f"{format_value(field[1] * 1e3)} and {format_value(field[0] * 1e3)} mm, of the shell within "
            f"{format_value(shell[1] * 1e3)} and {format_value(shell[0] * 1e3)} mm",
        ),
        Row(
            "time to build",
            None,
            seconds[1] / seconds[0],
            "times",
            bar=f"<= {BUILD_BAR:g}",
            holds=at_most(seconds[1], BUILD_BAR * seconds[0]),
            note=f"{seconds[1]:.1f} and {seconds[0]:.1f} s",
        ),
    ]
    for asked, words in (("a", "one shell"), ("both", "both shells")):
        for name, percent in (("median", 50), ("99 %", 99)):
            uniform, ours = (
                float(np.percentile(queries[f"{kind}_{asked}"], percent)) * 1e6
                for kind in KINDS[:2]
            )
            rows.append(
                Row(
                    f"time of contacts, {words}, {name} of poses",
                    None,
                    ours / uniform,
                    "times",
                    bar=f"<= {QUERY_BAR:g}",
                    holds=at_most(ours, QUERY_BAR * uniform),
                    note=f"{ours:.1f} and {uniform:.1f} \N{MICRO SIGN}s",
                )
            )
    for kind in KINDS:
        one, both = (float(np.median(queries[f"{kind}_{asked}"])) for asked in ASKED)
        rows.append(
            Row(
                f"time of contacts, both shells over one, {kind} model",
                None,
                both / one,
                "times",
                note=f"{both * 1e6:.1f} and {one * 1e6:.1f} \N{MICRO SIGN}s",
            )
        )
    return rows
