"""Measurements as rows, beside the bars that they are held to."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

Results = dict[str, Any]
"""A stored run: "machine", "context" and "cases", each of which is a dict of figures by name."""

FLAT = "flat/warm"


@dataclass(frozen=True)
class Bar:
    """The most that a figure may be, and how many times faster than the flat loop it must be."""

    most: float
    least_ratio: float | None = None


BARS_RESOLUTION = 300
"""Voxels along the bunny's longest side that the bars are for."""

# By case, then figure. Query times are medians in microseconds.
BARS: dict[tuple[str, str], Bar] = {
    ("voxelised_plane/contacts/warm", "median_us"): Bar(10.0, least_ratio=20.0),
    ("voxelised_plane/manifold/warm", "median_us"): Bar(6.0),
    ("voxelised_plane/segments/warm", "median_us"): Bar(6.0),
    ("analytic_plane/contacts/warm", "median_us"): Bar(2.0),
    ("pair_shallow/contacts/warm", "median_us"): Bar(3.5),
    ("pair_shallow/contacts/repeated", "median_us"): Bar(0.7),
    ("pair_deep/contacts/warm", "median_us"): Bar(25.0),
    ("pair_deepest/nearest/warm", "median_us"): Bar(60.0),
    ("pair_deepest/depth_error", "voxels"): Bar(1.0),
    ("near_miss/contacts/warm", "median_us"): Bar(1.5),
    ("coarse_voxelised_plane/contacts/warm", "median_us"): Bar(1.0),
    ("build/voxels_300", "seconds"): Bar(1.0),
    ("build/voxels_300", "model_bytes"): Bar(12e6),
    ("load/voxels_300", "seconds"): Bar(0.020),
}
MOST_MANIFOLD_GROWTH = 0.4
"""Exponent of the number of points, from 10 thousand to a million."""

_NOT_FIGURES = {
    "name",
    "run_name",
    "run_type",
    "family_index",
    "per_family_instance_index",
    "repetitions",
    "repetition_index",
    "threads",
    "iterations",
    "real_time",
    "cpu_time",
    "time_unit",
}


def read_cases(benchmarks: list[dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """The cases of google-benchmark's JSON: figures by name, or "why_not"."""
    cases: dict[str, dict[str, Any]] = {}
    for entry in benchmarks:
        name = entry["run_name"].removesuffix("/manual_time").removesuffix("/iterations:1")
        if entry.get("error_occurred"):
            cases[name] = {"why_not": entry.get("error_message", "failed")}
        else:
            cases[name] = {key: entry[key] for key in entry if key not in _NOT_FIGURES}
    return cases


def ratio_to_flat(cases: dict[str, dict[str, Any]], name: str) -> float | None:
    """How many times faster a query is than the flat loop in the same scene and process."""
    flat = cases.get(f"{name.split('/')[0]}/{FLAT}", {}).get("median_us")
    own = cases[name].get("median_us")
    return flat / own if flat and own else None


def holds(cases: dict[str, dict[str, Any]], name: str, figure: str) -> bool | None:
    """Whether a case holds its bar; None where it has none or was not measured."""
    bar = BARS.get((name, figure))
    value = cases.get(name, {}).get(figure)
    if bar is None or value is None:
        return None
    ratio = ratio_to_flat(cases, name)
    if bar.least_ratio is not None and (ratio is None or ratio < bar.least_ratio):
        return False
    return value <= bar.most


def growth(
    cases: dict[str, dict[str, Any]], query: str, least_points: int = 10_000
) -> float | None:
    """The exponent e of time ~ points^e over the scaling cases, by least squares of logarithms."""
    samples = [
        (math.log(case["points"]), math.log(case["median_us"]))
        for name, case in cases.items()
        if name.startswith("points_")
        and name.endswith(f"/{query}/warm")
        and case.get("points", 0) >= 0.9 * least_points
    ]
    if len(samples) < 2:
        return None
    mean_x = sum(x for x, _ in samples) / len(samples)
    mean_y = sum(y for _, y in samples) / len(samples)
    spread = sum((x - mean_x) ** 2 for x, _ in samples)
    return sum((x - mean_x) * (y - mean_y) for x, y in samples) / spread


def compare(old: Results, new: Results) -> list[tuple[str, str, float, float]]:
    """(case, figure, before, after) of what both runs measured."""
    rows = []
    for name, case in new["cases"].items():
        for figure in ("median_us", "seconds", "model_bytes"):
            before = old["cases"].get(name, {}).get(figure)
            after = case.get(figure)
            if before and after:
                rows.append((name, figure, before, after))
    return rows
