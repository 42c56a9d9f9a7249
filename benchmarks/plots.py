#!/usr/bin/env python3
"""Draws how times grow with points and voxels, from stored results.

usage: benchmarks/plots.py RESULTS.json
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any


def find_series(
    cases: dict[str, dict[str, Any]], prefix: str, figure: str
) -> dict[str, list[tuple[float, float]]]:
    """(size, figure) by query, of the cases `prefix`SIZE/query/warm."""
    series: dict[str, list[tuple[float, float]]] = {}
    for name, case in cases.items():
        scene, _, query = name.partition("/")
        if scene.startswith(prefix) and figure in case:
            size = float(scene.removeprefix(prefix))
            series.setdefault(query.removesuffix("/warm"), []).append((size, case[figure]))
    return series


def draw_scaling(path: Path) -> Path:
    """Writes a picture beside the results; returns its path."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    results = json.loads(path.read_text())
    cases = results["cases"]
    builds = {
        "build": [
            (float(name.removeprefix("build/voxels_")), 1e6 * case["seconds"])
            for name, case in cases.items()
            if name.startswith("build/voxels_") and "seconds" in case
        ]
    }
    panels = (
        (
            "points of the shell (bunny on voxelised plane)",
            find_series(cases, "points_", "median_us"),
        ),
        ("voxels along a side (bunny on bunny)", find_series(cases, "voxels_", "median_us")),
        ("voxels along a side (building)", builds),
    )
    figure, axes = plt.subplots(1, len(panels), figsize=(15, 4.5), layout="constrained")
    for axis, (label, series) in zip(axes, panels, strict=True):
        for query, samples in series.items():
            if samples:
                axis.loglog(*zip(*sorted(samples), strict=True), marker="o", label=query)
        axis.set_xlabel(label)
        axis.set_ylabel("median, microseconds")
        axis.grid(visible=True, which="major", alpha=0.3)
        if axis.lines:
            axis.legend()
    machine = results["machine"]
    figure.suptitle(f"{machine['cpu']}, commit {machine['commit']}, {machine['date'][:10]}")
    picture = path.with_suffix(".png")
    figure.savefig(picture, dpi=120)
    plt.close(figure)
    return picture


if __name__ == "__main__":
    print(draw_scaling(Path(sys.argv[1])))
