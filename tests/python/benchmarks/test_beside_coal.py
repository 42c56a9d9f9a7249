"""What is made of the C++ program's answers and times, beside coal."""

from __future__ import annotations

import beside_coal
import numpy as np
import pytest
from beside_coal import judge, make_rows, run_program, summarize


def asked(microseconds: float, answers: tuple[int, ...] = (1, 0)) -> dict[str, object]:
    """Of two poses, three times each."""
    return {"answers": list(answers), "seconds": [[1e-6 * microseconds] * 2] * 3}


def test_the_median_is_over_poses_and_the_mean_over_a_pass():
    figures = summarize(1e-6 * np.array([[1.0, 2.0, 9.0], [1.0, 2.0, 9.0], [100.0, 2.0, 9.0]]))
    assert figures["median_us"] == pytest.approx(2.0)
    assert figures["mean_us"] == pytest.approx(4.0)


def test_coal_counts_with_its_best_way():
    rows = make_rows(
        {"OBB": asked(12), "kIOS": asked(10), "as it comes": asked(30), "voxshell": asked(0.5)}
    )
    assert rows["cases"]["coal, C++"]["median_us"] == pytest.approx(10)
    assert rows["cases"]["coal, C++, as it comes"]["median_us"] == pytest.approx(30)
    assert rows["fraction_that_agree"] == 1.0


def test_a_way_with_other_answers_does_not_count():
    rows = make_rows(
        {"OBB": asked(1, (1, 1)), "as it comes": asked(30), "voxshell": asked(0.5, (0, 0))}
    )
    assert rows["cases"]["coal, C++"]["median_us"] == pytest.approx(30)
    assert rows["fraction_that_agree"] == 0.5


@pytest.mark.parametrize(
    ("median", "mean", "holds"), [(20.0, 21.0, True), (19.9, 30.0, False), (30.0, 19.9, False)]
)
def test_the_bar_is_of_median_and_mean(median, mean, holds):
    ours = {"median_us": 1.0, "mean_us": 1.0}
    coal = {"median_us": median, "mean_us": mean}
    cases = {"voxshell, C++": ours, "coal, C++": coal, "coal, C++, as it comes": coal}
    said = judge(cases)["coal, C++"]
    assert (said["median_us"], said["mean_us"], said["holds"]) == (median, mean, holds)


def test_without_the_program_it_is_said_what_builds_it(tmp_path, monkeypatch):
    monkeypatch.setattr(beside_coal, "PROGRAM", beside_coal.ROOT / "build/no_such_program")
    with pytest.raises(SystemExit, match=r"no_such_program is missing: \./dev bench --peers"):
        run_program(tmp_path / "mesh.obj", np.eye(4)[None], 100, 1000, 3)
