from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import trimesh

TINY = """
[ball]
phases = 2
steps = 90
low_points = 100
high_points = 300
[stack]
seeds = 2
seconds = 1.5
resolutions = [100, 300]
bunny_seeds = 1
[bunny]
mesh = "MESH"
size = 0.1
height = 0.1
voxel_size = 0.005
fine_points = 600
coarse_points = 100
steps = 600
slow_steps = 600
orientations = 1
equal_poses = 2
repeats = 1
[segments]
orientations = 1
repeats = 1
fine_points = 1000
voxel_size = 0.006
last_step = 240
[rates]
orientations = 1
rates = [50, 10, 1]
seconds = 1.0
fine_points = 1000
voxel_size = 0.006
[pair]
mesh = "MESH"
size = 0.1
voxel_size = 0.005
height = 0.1
fine_points = 600
coarse_points = 100
poses = 2
repeats = 1
[pour]
mesh = "MESH"
count = 4
voxel_size = 0.005
bin_voxel_size = 0.03
seconds = 0.2
slow_steps = 1
[rest]
orientations = 1
settle_seconds = 0.5
drift_seconds = 0.2
fine_points = 1000
voxel_size = 0.006
[slope]
seconds = 0.5
halvings = 3
[nut]
seconds = 0.05
rate = 200.0
segments = 12
voxel_size = 0.0008
fit_methods = ["voxshell", "hull"]
[gears]
voxel_size = 0.0008
rate = 100.0
speed = 4.0
methods = ["voxshell", "gimpact"]
[accuracy]
poses = 2
fine_points = 1000
voxel_size = 0.006
reference_voxel_size = 0.004
[geometry]
scenes = ["ball on slab 0.3 m", "crossed knives"]
poses = 1
rotations = 0
retriangulated = 0
judged = 2
judged_pairs = 1
pairs = 1
pair_poses = 20
optimized = 0
builds = 1
compared_poses = 0
[everyday]
scenes = ["cube stops, plane", "cradle of five balls"]
placements = 1
longest = 0.2
rates = [200.0, 60.0]
engines = ["voxshell", "bullet"]
[limits]
scenes = ["Bullet's box of 0.1 m on a belt at 0.3 m/s"]
rates = [200.0]
[scaling]
orientations = 1
points = [500, 1000]
voxel_sizes = [0.01, 0.006]
voxel_size = 0.006
steps = 20
bodies = [2]
poured = 0.1
"""
CLI = (sys.executable, "-c", "from voxshell.cli import main; main()", "reproduce")
PATIENCE = 240
ENVIRONMENT = {**os.environ, "COLUMNS": "100", "NO_COLOR": "1"}


@pytest.fixture(scope="module", autouse=True)
def cache(tmp_path_factory):
    """Models that the processes of these tests share."""
    ENVIRONMENT["VOXSHELL_CACHE_DIR"] = str(tmp_path_factory.mktemp("cache"))
    ENVIRONMENT["VOXSHELL_CACHE_SIZE"] = "1GB"


def reproduce(*arguments, **options):
    return subprocess.run(
        [*CLI, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        env=ENVIRONMENT,
        **options,
    )


def read_data(folder: Path) -> dict[str, bytes]:
    """Every table of an experiment, by part and name."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted((folder / "data").glob("*/*.parquet"))
    }


@pytest.fixture(scope="module")
def settings(tmp_path_factory):
    folder = tmp_path_factory.mktemp("settings")
    trimesh.creation.cone(radius=30, height=50).export(folder / "cone.stl")
    path = folder / "tiny.toml"
    path.write_text(TINY.replace("MESH", str(folder / "cone.stl")))
    return path


@pytest.fixture(scope="module")
def report(tmp_path_factory, settings):
    """The whole report with tiny settings: what it printed, and its folder."""
    out = tmp_path_factory.mktemp("report")
    result = reproduce("all", "--quick", "--settings", settings, "--out", out)
    assert result.returncode == 0, result.stderr
    return result, out


# What the section reports, experiment by experiment: each needs a verdict from data.
PUBLISHED = {
    "ball": (
        *("contacts in a step with contact", "first apex", "maximum penetration"),
        "farthest off Bullet's sphere",
    ),
    "stack": ("time to collapse", "growth of that time"),
    "bunny": (
        *("GImpact / VPS fine", "VPS fine / GJK on the hull", "decomposition / VPS coarse"),
        *("picture of the convex hull", "picture of the decomposition", "frames of the drop"),
        *("picture of the segments", "video of the drop"),
        *("set-up: voxels", "set-up: points of", "set-up: moment of inertia"),
    ),
    "segments": ("max/min over L, low", "max/min over L, high"),
    "rates": (
        *(f"lowest rate that holds, L = {level}" for level in (1, 4, 5)),
        "penetration at rest of L = 5",
    ),
}
DEMANDED = {
    "ball": ("rebound off c2", "energy gained", "deepest the ball is in the ground"),
    "stack": ("5 fine spheres stand", "5 bunnies stand"),
    "bunny": ("GImpact / VPS fine on the analytic plane", "VPS fine / GJK", "decomposition /"),
    "segments": ("mean time, low", "mean time, high", "max/min over L"),
    "rates": (
        *("lowest rate that holds, auto, our rule", "deepest after the first contact"),
        "deepest at rest",
    ),
    "pair": ("GImpact / VPS fine", "decomposition / VPS fine"),
    "pour": ("left the bin",),
    "rest": ("angular speed", "drift", "fall asleep"),
    "slope": ("angle of sliding",),
    "nut": ("creep of the nut", "off its thread", "distance of the threads"),
    "gears": ("turns of the driven gear", "deepest true overlap"),
    "accuracy": ("depth off the truth",),
    "geometry": ("first contact beyond the first touch", "answers wrong beyond the stated bounds"),
    "everyday": ("measures within their limits, voxshell", "sliding and stopping, cube stops"),
}


@pytest.mark.slow
def test_every_published_figure_has_a_verdict(report):
    _, out = report
    rows = json.loads((out / "report.json").read_text(), parse_constant=pytest.fail)["rows"]
    for field, wanted in (("reproduced", PUBLISHED), ("holds", DEMANDED)):
        for experiment, quantities in wanted.items():
            for quantity in quantities:
                found = [
                    row[field]
                    for row in rows
                    if row["experiment"] == experiment and row["quantity"].startswith(quantity)
                ]
                assert any(isinstance(verdict, bool) for verdict in found), (field, quantity)
    assert all(row["bar"] for row in rows if row["holds"] is not None)
    assert all(row["published"] is not None for row in rows if row["reproduced"] is not None)


@pytest.mark.slow
def test_page_opens_offline(report, browser):
    _, out = report
    context = browser.new_context(offline=True)
    page = context.new_page()
    complaints, requests = [], []
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("request", lambda request: requests.append(request.url))
    page.goto((out / "index.html").as_uri())
    assert page.inner_text("h1") == "Section 5.3, re-run"
    widths = page.eval_on_selector_all("img", "all => all.map(one => one.naturalWidth)")
    assert len(widths) >= 12
    assert min(widths) > 100
    links = page.eval_on_selector_all("p > a", "all => all.map(one => one.getAttribute('href'))")
    assert len(links) >= 3
    assert all((out / link).is_file() for link in links)
    assert complaints == []
    assert [url for url in requests if not url.startswith("data:")] == [
        (out / "index.html").as_uri()
    ]
    context.close()


@pytest.mark.slow
def test_table_is_printed_and_written(report):
    result, out = report
    for title in ("Bouncing ball", "Stack of spheres", "Falling bunny", "Low rates"):
        assert title in result.stdout
    table = (out / "ball" / "table.csv").read_text().splitlines()
    assert table[0].startswith("quantity,published,here,unit")
    assert len(table) > 20


@pytest.mark.slow
def test_two_runs_of_untimed_experiments_are_identical(report, settings, tmp_path):
    _, out = report
    result = reproduce("stack", "--quick", "--settings", settings, "--out", tmp_path, "--json")
    assert result.returncode == 0, result.stderr
    assert read_data(tmp_path / "stack") == read_data(out / "stack")
    rows = json.loads(result.stdout)
    assert rows == json.loads((out / "stack" / "results.json").read_text())["rows"]


def wait_for_parts(out: Path, process: subprocess.Popen, count: int = 1) -> None:
    deadline = time.monotonic() + PATIENCE
    while len(list(out.glob("*/data/[!.]*/manifest.json"))) < count:
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.01)


@pytest.mark.slow
def test_killed_run_goes_on_to_the_same_report(report, settings, tmp_path):
    _, out = report
    arguments = ("rates", "--quick", "--settings", settings, "--out", tmp_path, "--json")
    process = subprocess.Popen(
        [*CLI, *map(str, arguments), "--jobs", "1"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=ENVIRONMENT,
    )
    wait_for_parts(tmp_path, process, 2)
    process.kill()
    process.wait()
    finished = {
        path: path.stat().st_mtime_ns for path in tmp_path.glob("*/data/[!.]*/manifest.json")
    }
    assert len(finished) < len(read_data(out / "rates"))
    result = reproduce(*arguments)
    assert result.returncode == 0, result.stderr
    assert read_data(tmp_path / "rates") == read_data(out / "rates")
    assert json.loads(result.stdout) == json.loads((out / "rates/results.json").read_text())["rows"]
    assert {path: path.stat().st_mtime_ns for path in finished} == finished
    assert list((tmp_path / "rates" / "data").glob(".*")) == []


def test_interrupt_ends_at_once_with_130(settings, tmp_path):
    process = subprocess.Popen(
        [*CLI, "rates", "--settings", str(settings), "--out", str(tmp_path)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=ENVIRONMENT,
    )
    wait_for_parts(tmp_path, process)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=30)
    assert process.returncode == 130
    assert "Traceback" not in errors


@pytest.fixture
def cluster(tmp_path):
    """A Dask scheduler with two workers, each a process: its address, and the workers."""
    file = tmp_path / "scheduler.json"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": ENVIRONMENT}
    base = [sys.executable, "-m"]
    scheduler = subprocess.Popen(
        [
            *(*base, "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0"),
            *("--no-dashboard", "--scheduler-file", str(file)),
        ],
        **quiet,
    )
    workers = [
        subprocess.Popen(
            [
                *(*base, "distributed.cli.dask_worker", "--scheduler-file", str(file)),
                *("--no-nanny", "--nthreads", "1", "--no-dashboard"),
                *("--local-directory", str(tmp_path / f"worker-{i}")),
            ],
            **quiet,
        )
        for i in range(2)
    ]
    deadline = time.monotonic() + PATIENCE
    while not file.exists() or not file.read_text().strip():
        assert time.monotonic() < deadline
        time.sleep(0.1)
    address = json.loads(file.read_text())["address"]
    ready = (
        "from distributed import Client; import sys\n"
        "with Client(sys.argv[1]) as client: client.wait_for_workers(2, timeout=120)"
    )
    subprocess.run([sys.executable, "-c", ready, address], check=True, timeout=PATIENCE)
    yield address, workers
    for process in (*workers, scheduler):
        process.kill()
        process.wait()


@pytest.mark.slow
def test_cluster_that_loses_a_worker_gives_the_same_data(report, settings, cluster, tmp_path):
    address, workers = cluster
    _, out = report
    arguments = ("rates", "--quick", "--settings", settings, "--out", tmp_path / "out")
    process = subprocess.Popen(
        [*CLI, *map(str, arguments), "--scheduler", address],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=ENVIRONMENT,
    )
    wait_for_parts(tmp_path / "out", process)
    workers[0].kill()
    _, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, errors
    assert read_data(tmp_path / "out" / "rates") == read_data(out / "rates")


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (["ball", "--jobs", "0"], "jobs must be at least 1, not 0"),
        (["ball", "--settings", "missing.toml"], "missing.toml"),
        (["ball", "--scheduler", "tcp://127.0.0.1:9"], "no Dask scheduler answers at tcp://"),
        (["tower"], "tower"),
    ],
)
def test_bad_input_is_an_error_that_names_it(tmp_path, arguments, part):
    result = reproduce(*arguments, "--out", tmp_path)
    assert result.returncode != 0
    said = " ".join((result.stdout + result.stderr).split())
    assert part in said
    assert "Traceback" not in said


def test_help_lists_the_experiments():
    said = reproduce("--help").stdout
    for name in ("ball", "stack", "bunny", "segments", "rates", "all"):
        assert f" {name} " in said
    said = reproduce("ball", "--help").stdout
    for option in ("--quick", "--settings", "--scheduler", "--jobs", "--json"):
        assert option in said
