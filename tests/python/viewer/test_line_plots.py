from __future__ import annotations

import re

import numpy as np
import pytest
from voxshell.viewer.line_plots import LinePlot, choose_ticks, draw_line_plots


@pytest.mark.parametrize(
    ("low", "high", "whole", "ticks"),
    [
        (0.0, 1.0, False, [0.0, 0.5, 1.0]),
        (0.0, 1.0, True, [0, 1]),
        (54.0, 56.25, True, [0, 20, 40, 60]),
        (-0.4, 0.0, False, [-0.4, -0.2, 0.0]),
        (-1.0, 3.0, False, [-2.0, 0.0, 2.0, 4.0]),
        (0.0, 0.0, False, [0.0]),
    ],
)
def test_ticks_are_few_and_round_and_enclose_zero_and_the_values(
    low: float, high: float, whole: bool, ticks: list[float]
):
    assert choose_ticks(low, high, whole=whole).tolist() == pytest.approx(ticks)


def labels_of(page: str) -> list[str]:
    return re.findall(r"<text[^>]*>([^<]*)</text>", page)


def test_a_plot_without_data_has_no_ticks():
    page = draw_line_plots([LinePlot("contacts", {"contacts": "red"})])
    assert "contacts" in page
    assert labels_of(page) == []


def test_counts_have_whole_ticks_and_the_time_axis_has_its_unit():
    times = np.array([16.7, 20.0, 38.9])
    counts = LinePlot("contacts", {"n": "red"}, (times, np.array([56.0, 54.0, 55.0])), whole=True)
    zeros = LinePlot("depth, mm", {"depth": "blue"}, (times, np.zeros(3)))
    labels = labels_of(draw_line_plots([counts, zeros]))
    assert labels == ["0", "20", "40", "60", "0", "20 s", "30 s"]


def test_lines_span_the_plot_and_stay_in_it():
    times = np.linspace(5.0, 9.0, 50)
    plot = LinePlot("energy, J", {"a": "red", "b": "blue"}, (times, np.sin(times), -3.0 * times))
    page = draw_line_plots([plot])
    view = [float(part) for part in re.findall(r'viewBox="([^"]*)"', page)[0].split()]
    lines = re.findall(r'points="([^"]*)"', page)
    assert len(lines) == 2
    for line in lines:
        points = np.array([pair.split(",") for pair in line.split()], dtype=np.float64)
        assert np.ptp(points[:, 0]) > 0.8 * view[2]
        assert (points >= view[:2]).all()
        assert (points <= np.add(view[:2], view[2:])).all()
