"""Rows of the C++ program that asks coal and voxshell whether the same bodies touch, in turn."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from machine import ROOT

PROGRAM = ROOT / "build/benchmarks/benchmarks/coal/voxshell_beside_coal"
OURS = "voxshell"
AS_IT_COMES = "as it comes"
FIGURES = ("median_us", "mean_us", "p99_us")
LEAST_RATIO = 20.0
"""How many times faster than coal a yes/no query at random poses is to be, median and mean."""


def summarize(seconds: np.ndarray) -> dict[str, float]:
    """Of (repeats, poses) seconds, in microseconds.

    The median over poses of that over repeats; the median over repeats of the mean; the 99th
    percentile.
    """
    return {
        "median_us": 1e6 * float(np.median(np.median(seconds, axis=0))),
        "mean_us": 1e6 * float(np.median(seconds.mean(axis=1))),
        "p99_us": 1e6 * float(np.quantile(seconds, 0.99)),
    }


def run_program(
    mesh: Path, poses: np.ndarray, resolution: int, target_points: int, repeats: int
) -> dict[str, Any]:
    """What it writes about these (n, 4, 4) poses, world_from_a: every answer and time."""
    if not PROGRAM.is_file():
        sys.exit(f"bench: {PROGRAM.relative_to(ROOT)} is missing: ./dev bench --peers builds it")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "poses"
        file.write_bytes(np.ascontiguousarray(poses, dtype=np.float64).tobytes())
        settings = [str(number) for number in (resolution, target_points, repeats)]
        ran = subprocess.run(
            [PROGRAM, mesh, file, *settings], check=False, capture_output=True, text=True
        )
    if ran.returncode != 0:
        sys.exit(f"bench: {PROGRAM.name} ended with {ran.returncode}: {ran.stderr.strip()}")
    return json.loads(ran.stdout)


def make_rows(questions: dict[str, Any]) -> dict[str, Any]:
    """Its cases by name, coal's ways one by one, and the fraction of poses with the same answers.

    "coal, C++" is the least of each figure over all of coal's ways, of which those do not count
    whose answers differ from coal's with its settings as they come.
    """
    answers = {name: np.array(asked["answers"]) for name, asked in questions.items()}
    figures = {name: summarize(np.array(asked["seconds"])) for name, asked in questions.items()}
    usual = answers[AS_IT_COMES]
    ways = {
        name: figures[name]
        for name in questions
        if name != OURS and np.array_equal(answers[name], usual)
    }
    cases = {
        "coal, C++": {f: min(way[f] for way in ways.values()) for f in FIGURES},
        "coal, C++, as it comes": ways[AS_IT_COMES],
        "voxshell, C++": figures[OURS],
    }
    return {
        "cases": cases,
        "ways": ways,
        "fraction_that_agree": float((answers[OURS] == usual).mean()),
    }


def judge(cases: dict[str, dict[str, float]]) -> dict[str, Any]:
    """How many times faster the C++ queries are than coal's, and whether that is LEAST_RATIO."""
    ours = cases["voxshell, C++"]
    ratios = {
        name: {f: cases[name][f] / ours[f] for f in ("median_us", "mean_us")}
        for name in ("coal, C++", "coal, C++, as it comes")
    }
    return {
        name: ratio | {"holds": min(ratio.values()) >= LEAST_RATIO}
        for name, ratio in ratios.items()
    }
