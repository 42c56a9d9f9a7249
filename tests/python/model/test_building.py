"""What happens while a model is built: reports, exceptions, Ctrl-C, other threads."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time
import warnings

import numpy as np
import pytest
import trimesh
import voxshell as vx


def build(**options: object) -> vx.Model:
    return vx.Model.from_mesh(trimesh.creation.icosphere(3), **{"resolution": 60, **options})


def test_progress_is_reported_from_this_thread():
    reports = []
    build(progress=lambda stage, fraction: reports.append((stage, fraction, threading.get_ident())))
    stages = list(dict.fromkeys(stage for stage, _, _ in reports))
    assert "distance field" in stages
    assert len(stages) >= 2
    for stage in stages:
        fractions = [fraction for name, fraction, _ in reports if name == stage]
        assert fractions == sorted(fractions)
        assert all(0.0 <= fraction <= 1.0 for fraction in fractions)
        assert fractions[-1] == 1.0
    assert {ident for _, _, ident in reports} == {threading.get_ident()}


@pytest.mark.parametrize("stop_at", [1, 2, 3])
@pytest.mark.parametrize("kind", [RuntimeError, KeyboardInterrupt, SystemExit])
def test_what_progress_raises_stops_the_build_and_arrives(stop_at: int, kind: type[BaseException]):
    error = kind(3)
    calls = 0

    def stop(stage: str, fraction: float) -> None:
        nonlocal calls
        calls += 1
        if calls == stop_at:
            raise error

    with pytest.raises(kind) as caught:
        build(progress=stop)
    assert caught.value is error
    assert calls == stop_at  # not asked again


def test_what_progress_returns_does_not_matter():
    assert len(build(progress=lambda stage, fraction: False).shell) > 0


def test_a_progress_of_wrong_arity_is_its_own_error():
    with pytest.raises(TypeError, match="positional argument"):
        build(progress=lambda: None)


def test_a_model_can_be_built_inside_a_report():
    inner = []

    def nest(stage: str, fraction: float) -> None:
        if not inner:
            inner.append(build(resolution=10))

    assert build(progress=nest).field.shape > inner[0].field.shape


def test_other_threads_run_during_a_build():
    thread = threading.Thread(target=lambda: build(resolution=120, threads=1))
    thread.start()
    ticks, start = 0, time.perf_counter()
    while thread.is_alive():
        time.sleep(0.001)
        ticks += 1
    took = time.perf_counter() - start
    thread.join()
    # With the GIL held there would be one tick, or one every 50 ms.
    assert ticks > 60 * took


BUILD_FOR_LONG = """
import sys, trimesh
import voxshell as vx
print("building", flush=True)
try:
    vx.Model.from_mesh(trimesh.creation.icosphere(6), resolution=700, threads={threads}{progress})
except KeyboardInterrupt:
    print("interrupted", flush=True)
    sys.exit(7)
print("built", flush=True)
"""


@pytest.mark.parametrize("threads", [1, 4])
@pytest.mark.parametrize("progress", ["", ", progress=print"], ids=["silent", "reporting"])
def test_ctrl_c_stops_a_build_within_two_seconds(threads: int, progress: str):
    child = subprocess.Popen(
        [sys.executable, "-c", BUILD_FOR_LONG.format(threads=threads, progress=progress)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert child.stdout is not None
    assert child.stdout.readline() == "building\n"
    time.sleep(1.5)
    assert child.poll() is None
    start = time.perf_counter()
    child.send_signal(signal.SIGINT)
    try:
        output, errors = child.communicate(timeout=20)
    finally:
        child.kill()
    assert time.perf_counter() - start < 2.0
    assert output.endswith("interrupted\n"), errors  # print() may be interrupted within a line
    assert child.returncode == 7
    assert errors == ""


@pytest.mark.parametrize(
    ("settings", "error", "message"),
    [
        ({"sign": np.array(["auto", "closed"])}, vx.SettingsError, "sign must be 'auto'"),
        ({"open": ["auto"]}, vx.SettingsError, "open must be 'auto'"),
        ({"cache": "no"}, vx.SettingsError, "cache must be True or False, not 'no'"),
        ({"progress": 3}, vx.InputTypeError, "progress must be callable, not int"),
    ],
)
def test_words_and_flags_of_a_wrong_type_are_told(settings, error, message):
    with pytest.raises(error, match=message):
        vx.Model.from_mesh(trimesh.creation.box(), resolution=10, **settings)


@pytest.mark.parametrize(("tolerance", "is_coarse"), [(0.1, True), (0.021, True), (0.019, False)])
def test_a_tolerance_in_millimeters_is_doubted(tolerance: float, is_coarse: bool):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        vx.Model.from_mesh(trimesh.creation.box((0.1, 0.2, 0.3)), tolerance=tolerance)
    doubts = [str(each.message) for each in caught if "check its unit" in str(each.message)]
    assert len(doubts) == is_coarse
    assert all("the mesh's shortest side of 0.1 m" in doubt for doubt in doubts)


def test_a_flat_sheet_has_no_shortest_side_to_compare_with():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        vx.Model.from_mesh(
            ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]), tolerance=0.01, open="sheet"
        )


def test_a_resolution_that_no_place_of_the_origin_allows_is_at_fault_itself():
    for center in (0.0, 5.0):
        mesh = trimesh.creation.box().apply_translation((center, 0, 0))
        with pytest.raises(
            vx.MeshError, match=r"resolution of 16778 is too .*; pass at most 16777$"
        ):
            vx.Model.from_mesh(mesh, resolution=16_778)
    with pytest.raises(vx.MeshError, match="move it to its origin"):
        vx.Model.from_mesh(mesh, resolution=5_000)
