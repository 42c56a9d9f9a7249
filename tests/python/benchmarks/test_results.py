"""What the benchmarks' table says about figures: ratios, bars, growth, before and after."""

from __future__ import annotations

import pytest
from results import BARS, compare, growth, holds, ratio_to_flat, read_cases

PLANE = "voxelised_plane/contacts/warm"


def entry(name: str, **figures: float) -> dict[str, object]:
    """As google-benchmark writes them."""
    return {
        "name": f"{name}/iterations:1/manual_time",
        "run_name": f"{name}/iterations:1/manual_time",
        "run_type": "iteration",
        "iterations": 1,
        "real_time": 1.0,
        **figures,
    }


def plane_cases(flat: float, tree: float) -> dict[str, dict[str, object]]:
    return read_cases(
        [entry("voxelised_plane/flat/warm", median_us=flat), entry(PLANE, median_us=tree)]
    )


def test_cases_are_read_by_name_with_their_figures_alone():
    assert read_cases([entry(PLANE, median_us=5.0, p99_us=7.0)]) == {
        PLANE: {"median_us": 5.0, "p99_us": 7.0}
    }


def test_a_case_that_could_not_be_measured_says_why():
    failed = entry(PLANE) | {"error_occurred": True, "error_message": "too slow"}
    cases = read_cases([failed])
    assert cases == {PLANE: {"why_not": "too slow"}}
    assert holds(cases, PLANE, "median_us") is None


def test_the_ratio_is_to_the_flat_loop_of_the_same_scene():
    cases = plane_cases(flat=300.0, tree=6.0)
    cases["near_miss/flat/warm"] = {"median_us": 1.0}
    assert ratio_to_flat(cases, PLANE) == pytest.approx(50.0)


@pytest.mark.parametrize(
    ("flat", "tree", "expected"),
    [(300.0, 9.9, True), (300.0, 10.1, False), (150.0, 9.9, False), (200.0, 10.0, True)],
)
def test_a_bar_of_time_and_ratio_holds_where_both_do(flat: float, tree: float, expected: bool):
    assert BARS[PLANE, "median_us"].least_ratio == 20.0
    assert holds(plane_cases(flat, tree), PLANE, "median_us") is expected


def test_a_case_without_a_bar_neither_holds_nor_fails():
    assert holds(plane_cases(300.0, 6.0), "voxelised_plane/flat/warm", "median_us") is None


def test_growth_is_the_exponent_of_the_number_of_points():
    cases = {
        f"points_{points}/manifold/warm": {"points": points, "median_us": 0.1 * points**0.37}
        for points in (10_000, 100_000, 1_000_000)
    }
    cases["points_1000/manifold/warm"] = {"points": 1_000, "median_us": 1e6}  # too few to count
    assert growth(cases, "manifold") == pytest.approx(0.37)
    assert growth(cases, "contacts") is None


def test_before_and_after_name_what_both_runs_measured():
    old = {"cases": plane_cases(300.0, 8.0) | {"gone/contacts/warm": {"median_us": 1.0}}}
    new = {"cases": plane_cases(300.0, 4.0) | {"new/contacts/warm": {"median_us": 1.0}}}
    rows = compare(old, new)
    assert (PLANE, "median_us", 8.0, 4.0) in rows
    assert len(rows) == 2
