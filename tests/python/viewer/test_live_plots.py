"""Plots of a live view, without a browser."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from voxshell.simulation.live_frame import LiveFrame
from voxshell.viewer.live_plots import LivePlots
from voxshell.viewer.server import silent_server


@pytest.fixture
def plots() -> Iterator[LivePlots]:
    with silent_server() as server:
        yield LivePlots(server.gui)


def at(
    time: float, *, kinetic: float = 0.0, potential: float = 0.0, depths: tuple[float, ...] = ()
) -> LiveFrame:
    """A frame without bodies."""
    poses, vectors = np.zeros((0, 4, 4)), np.zeros((len(depths), 3))
    return LiveFrame(
        time, (), poses, vectors, vectors, np.array(depths), vectors, kinetic, potential
    )


def columns_of(plot: Any) -> list[list[float]]:
    return [np.asarray(column).tolist() for column in plot.data]


def test_plots_show_energies_from_the_first_height_contacts_and_the_deepest_in_mm(plots: LivePlots):
    plots.add(at(0.0, kinetic=0.0, potential=50.0))
    plots.add(at(0.5, kinetic=2.0, potential=48.5, depths=(0.002, -0.001, 0.003)))
    plots.show()
    assert columns_of(plots._energy) == [[0.0, 0.5], [0.0, 2.0], [0.0, -1.5], [0.0, 0.5]]
    assert columns_of(plots._count) == [[0.0, 0.5], [0.0, 3.0]]
    assert columns_of(plots._depth) == [[0.0, 0.5], [0.0, 3.0]]


def test_a_single_frame_is_no_line(plots: LivePlots):
    before = columns_of(plots._count)
    plots.show()
    plots.add(at(1.0, depths=(0.001,)))
    plots.show()
    assert columns_of(plots._count) == before


def test_a_frame_at_the_same_time_replaces_the_one_before(plots: LivePlots):
    plots.add(at(0.0))
    plots.add(at(0.1, depths=(0.001,)))
    plots.add(at(0.1))
    plots.show()
    assert columns_of(plots._count) == [[0.0, 0.1], [0.0, 0.0]]


def test_a_world_that_went_back_in_time_begins_anew(plots: LivePlots):
    for time in (0.0, 0.1, 0.2):
        plots.add(at(time, potential=7.0))
    plots.add(at(0.1, potential=3.0))
    plots.add(at(0.3, potential=5.0))
    plots.show()
    assert columns_of(plots._energy)[0] == [0.1, 0.3]
    assert columns_of(plots._energy)[2] == [0.0, 2.0]


def test_no_line_joins_what_was_read_before_and_after_a_time_without_a_page(plots: LivePlots):
    plots.add(at(0.0, potential=7.0))
    plots.interrupt()
    plots.add(at(0.0, potential=7.0))  # a page opens before the first step
    plots.add(at(0.1, potential=6.0))
    plots.interrupt()
    plots.add(at(40.0, potential=5.0))
    plots.add(at(40.1, potential=4.0))
    plots.show()
    assert columns_of(plots._energy)[0] == [40.0, 40.1]
    assert columns_of(plots._energy)[2] == [-2.0, -3.0]


def test_the_oldest_frames_are_left_out(plots: LivePlots):
    for number in range(700):
        plots.add(at(0.1 * number))
    plots.show()
    times = columns_of(plots._energy)[0]
    assert len(times) == 600
    assert times[-1] == pytest.approx(69.9)


def test_small_depths_and_energies_have_small_units(plots: LivePlots):
    # The page writes three decimals: 0.4 um would be 0 mm.
    plots.add(at(0.0, potential=1.0))
    plots.add(at(0.1, kinetic=3e-5, potential=1.0, depths=(4e-7,)))
    plots.show()
    assert (plots._energy.title, plots._depth.title) == ("energy, µJ", "deepest contact, µm")
    assert columns_of(plots._energy)[1] == pytest.approx([0.0, 30.0])
    assert columns_of(plots._depth)[1] == pytest.approx([0.0, 0.4])
    plots.add(at(0.2, kinetic=3.0, potential=1.0, depths=(4e-3,)))
    plots.show()
    assert (plots._energy.title, plots._depth.title) == ("energy, J", "deepest contact, mm")
    assert columns_of(plots._depth)[1] == pytest.approx([0.0, 4e-4, 4.0])


def test_a_change_of_unit_leaves_no_plot_behind_the_others(plots: LivePlots):
    for time, joules in ((0.0, 1.0), (0.3, 1e-5), (30.0, 1.0)):
        plots.add(at(time, kinetic=joules, depths=(joules * 1e-3,)))
        plots.show()
    page = plots._page.content
    lines = [each.split() for each in re.findall(r'points="([^"]*)"', page)]
    assert len(lines) == 5
    assert {len(line) for line in lines} == {3}
    assert len({line[0].split(",")[0] for line in lines}) == 1
    assert len({line[-1].split(",")[0] for line in lines}) == 1
    assert "30 s" in page
