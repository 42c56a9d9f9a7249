"""Every example of the gallery runs in its quick form, and what it claims holds."""

from __future__ import annotations

import json
import math
import runpy
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

EXAMPLES = Path(__file__).resolve().parents[3] / "examples/python"
PROGRAMS = sorted(EXAMPLES.glob("[0-9][0-9]_*.py"))
LINES_AT_MOST = 80
# Lighting a picture of the full size takes longer than most examples. `./dev docs` draws these, and runs each example in
# a process of its own.
SMALL = {"size": (160, 100), "quality": 0.1}


def hold_rings(figures: dict[str, Any]) -> None:
    assert figures["they_touch"]
    assert figures["deepest_mm"] == pytest.approx(0.2, abs=0.02)


def hold_ring_over_post(figures: dict[str, Any]) -> None:
    assert figures["height_of_the_model_mm"] == pytest.approx(15.0, abs=0.1)
    assert figures["height_of_the_hull_mm"] > 110.0


def hold_nut(figures: dict[str, Any]) -> None:
    """Down the thread, with the play that the clearance leaves; no jam, no tunneling."""
    assert figures["turns"] >= 3.0
    assert figures["seconds"] < 1.6, "the motor alone would take 1.5 s"
    assert figures["down_mm"] == pytest.approx(3.0 * figures["pitch_mm"], abs=0.4)
    assert figures["off_the_helix_at_most_mm"] < figures["clearance_mm"]
    assert figures["off_the_axis_at_most_mm"] < figures["clearance_mm"]
    assert figures["deepest_contact_mm"] < 0.05


def hold_gears(figures: dict[str, Any]) -> None:
    assert figures["turns_of_the_large_gear"] <= -1.0
    assert figures["ratio"] == pytest.approx(2.0, rel=0.01)
    assert figures["deepest_contact_mm"] < 0.1


def hold_peg(figures: dict[str, Any]) -> None:
    for name in ("loose", "close"):
        assert figures[f"{name}_peg_down_mm"] == pytest.approx(20.0, abs=0.05)
    # Where its chamfer of 1 mm meets the upper end of the bore.
    assert figures["thick_peg_down_mm"] == pytest.approx(1.4, abs=0.1)
    for name in ("loose", "close", "thick"):
        assert figures[f"{name}_peg_overlap_at_the_end_mm"] < 0.01


def hold_bunnies(figures: dict[str, Any]) -> None:
    assert figures["in_the_bowl"] == figures["bunnies"] == 8


def hold_batch(figures: dict[str, Any]) -> None:
    assert figures["agrees_with_single_calls"]
    assert 0.3 < figures["free_fraction"] < 0.9


def hold_force(figures: dict[str, Any]) -> None:
    assert figures["largest_force_N"] > 1.0
    assert figures["largest_change_from_call_to_call_N"] < 0.03 * figures["largest_force_N"]


def hold_sweep(figures: dict[str, Any]) -> None:
    assert figures["off_by_at_most_degrees"] < 0.05


def hold_gripper(figures: dict[str, Any]) -> None:
    """Held by friction alone, and not passed through."""
    assert figures["lifted_mm"] > 120.0
    assert figures["carried_mm"] == pytest.approx(2e3 * 0.3 * math.sin(0.6), abs=15.0)
    assert figures["slip_on_the_way_mm"] < 1.0
    assert figures["tilt_at_the_end_degrees"] < 0.1
    assert figures["height_at_the_end_mm"] == pytest.approx(0.0, abs=0.1)
    assert figures["median_force_N"] > 5.0, "fingers press"
    assert figures["deepest_finger_contact_mm"] < 0.5, "a quarter of a voxel"


def hold_ring_around_ball(figures: dict[str, Any]) -> None:
    assert figures["height_of_the_model_mm"] == pytest.approx(30.0, abs=0.1)
    assert figures["model_into_the_table_mm"] < 0.5
    assert figures["speed_of_the_model_at_the_end_mm_s"] < 0.1
    assert figures["height_of_the_GImpact_mm"] == pytest.approx(31.0, abs=0.5), "its margin"


HOLDS = {
    "01_quick_start": hold_rings,
    "03_coming_from_pybullet": hold_ring_over_post,
    "04_nut_on_a_bolt": hold_nut,
    "05_gears": hold_gears,
    "06_peg_in_hole": hold_peg,
    "07_pouring_bunnies": hold_bunnies,
    "08_batch_queries": hold_batch,
    "09_haptic_force": hold_force,
    "10_distributed_sweep": hold_sweep,
    "11_urdf_gripper": hold_gripper,
    "12_coming_from_gimpact": hold_ring_around_ball,
}


def test_the_gallery_is_numbered_without_gaps():
    assert [int(path.name[:2]) for path in PROGRAMS] == list(range(1, len(PROGRAMS) + 1))
    assert set(HOLDS) <= {path.stem for path in PROGRAMS}


def test_examples_need_nothing_but_the_package_and_what_others_publish():
    for path in EXAMPLES.glob("*.py"):
        assert "voxshell_studies" not in path.read_text(), path


@pytest.mark.parametrize(
    ("program", "missing", "said"),
    [
        ("01_quick_start", "matplotlib", "needs matplotlib: pip install 'voxshell[report]'"),
        ("05_gears", "manifold3d", "needs manifold3d: pip install 'voxshell[viewer]'"),
        ("10_distributed_sweep", "distributed", "needs distributed: pip install distributed"),
    ],
)
def test_a_missing_package_is_said_in_one_line(
    program: str, missing: str, said: str, tmp_path: Path
):
    path = EXAMPLES / f"{program}.py"
    code = (
        f"import runpy, sys; sys.modules[{missing!r}] = None; sys.path.insert(0, {str(EXAMPLES)!r}); "
        f"sys.argv[1:] = ['--out', {str(tmp_path)!r}]; runpy.run_path({str(path)!r}, run_name='__main__')"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == f"this example {said}\n"


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda path: path.stem)
def test_an_example_runs_and_holds(
    program: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
):
    assert len(program.read_text().splitlines()) <= LINES_AT_MOST
    monkeypatch.syspath_prepend(str(EXAMPLES))
    monkeypatch.setattr(sys, "argv", [str(program), "--quick", "--out", str(tmp_path)])
    import drawing

    options = drawing.Studio.__init__.__kwdefaults__
    monkeypatch.setattr(drawing.Studio.__init__, "__kwdefaults__", {**options, **SMALL})
    runpy.run_path(str(program), run_name="__main__")
    made = {path.name for path in tmp_path.iterdir()}
    assert {"picture.png", "plot.png", "replay.html", "figures.json"} <= made
    figures = json.loads((tmp_path / "figures.json").read_text())
    assert figures
    said = capsys.readouterr().out
    for name in figures:
        assert name.replace("_", " ") in said
    HOLDS.get(program.stem, lambda figures: None)(figures)
