"""Times of single queries for contacts, measured in C++: tests/cpp/soak/query_latency.cpp."""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path

import trimesh
import voxshell as vx

from soak.task import CORE, Check, Outcome, Task, Totals, UnavailableError

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = ROOT / "build/release/tests/cpp/soak/voxshell_query_latency"
BUNNY = Path("/usr/share/glmark2/models/bunny.obj")
LENGTH, VOXEL, POINTS = 0.2115, 0.002, 35_596  # meters, meters, those of the thesis' fine bunny
QUERIES = 100_000  # a case
BUCKETS_AN_OCTAVE = 16


def prepare() -> Check:
    if not PROGRAM.is_file():
        raise UnavailableError(f"{PROGRAM.name} is not built")
    if not BUNNY.is_file():
        raise UnavailableError(f"{BUNNY} is missing; install the package glmark2-data")
    mesh = trimesh.load_mesh(BUNNY, process=False)
    mesh.apply_scale(LENGTH / mesh.extents.max())
    model = vx.Model.from_mesh(mesh, voxel_size=VOXEL, target_points=POINTS)
    file = Path(tempfile.mkdtemp(prefix="voxshell-soak-")) / "bunny.vxs"
    model.save(file)

    def check(case: int) -> Outcome:
        run = subprocess.run(
            [PROGRAM, file, str(case), str(QUERIES)], capture_output=True, text=True, check=False
        )
        assert run.returncode == 0, f"{PROGRAM.name} failed ({run.returncode}): {run.stderr[-500:]}"
        numbers = {name: float(value) for name, value in map(str.split, run.stdout.splitlines())}
        worst = numbers.pop("worst")
        return Outcome(QUERIES, numbers, {"worst": worst})

    return check


def quantile(totals: Totals, fraction: float) -> float:
    """Nanoseconds that this fraction of all queries does not exceed: the end of its bucket."""
    histogram = sorted((int(n), count) for n, count in totals.tallies.items() if n.isdigit())
    wanted = fraction * sum(count for _, count in histogram)
    for bucket, count in histogram:
        wanted -= count
        if wanted <= 0:
            return 2.0 ** ((bucket + 1) / BUCKETS_AN_OCTAVE)
    return float("nan")


def describe(totals: Totals) -> str:
    median, rare = (quantile(totals, fraction) / 1e3 for fraction in (0.5, 0.999))
    return (
        f"median {median:.2f} µs, p99.9 {rare:.1f} µs, worst {totals.peaks['worst'] / 1e3:,.0f} µs "
        f"({totals.tallies['interruptions']:,.0f} preemptions by the system); "
        f"{totals.tallies['touching'] / totals.count:.0%} touch"
    )


def doubt(totals: Totals) -> str:
    touching = totals.tallies["touching"] / totals.count
    return "" if 0.3 <= touching <= 0.95 else f"{touching:.0%} of the queries touch"


TASK = Task(
    promise="The p99.9 and worst times of queries for all contacts of two bunnies are known",
    oracle="the wall-clock time of each query, on a machine that other programs use too",
    unit="queries",
    target=100_000_000,
    prepare=prepare,
    sources=CORE,
    describe=describe,
    doubt=doubt,
    alone=True,
)
