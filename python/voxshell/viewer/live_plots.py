"""Plots over simulated time beside a live view: energy, number of contacts, largest depth."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

import numpy as np

from voxshell.viewer.line_plots import LinePlot, draw_line_plots

if TYPE_CHECKING:
    import viser
    from numpy.typing import NDArray

    from voxshell.simulation.live_frame import LiveFrame

_SAMPLES = 600
"""Number of frames in the plots: twenty seconds at 30 frames per second."""

_DEPTH_UNITS = (("mm", 1e3), ("µm", 1e6), ("nm", 1e9))
_ENERGY_UNITS = (("J", 1.0), ("mJ", 1e3), ("µJ", 1e6), ("nJ", 1e9))
_LEAST_NUMBER = 0.1
"""If the largest value is smaller than this, a smaller unit is used."""
_ENERGY_COLORS = ("#1f6fb4", "#2a9d6f", "#1e2733")


class LivePlots:
    """Three plots in the controls of a page.

    Args:
        gui: The page's controls.
    """

    def __init__(self, gui: viser.GuiApi) -> None:
        # Columns: time; kinetic, potential and total energy, J; contacts; depth, m.
        self._rows: deque[tuple[float, ...]] = deque(maxlen=_SAMPLES)
        self._ground: float | None = None
        self._is_broken = False
        names = ("kinetic", "potential", "sum")
        self._energy = LinePlot("energy, J", dict(zip(names, _ENERGY_COLORS, strict=True)))
        self._count = LinePlot("contacts", {"contacts": "#b4324a"}, whole=True)
        self._depth = LinePlot("deepest contact, mm", {"depth": "#d97706"})
        # viser's own plots keep the range of an old time axis when their title changes.
        self._page = gui.add_html("")
        self.show()

    def add(self, frame: LiveFrame) -> None:
        """Add a frame. If the time of the world went back, restart the plots."""
        if self._rows and frame.time < self._rows[-1][0]:
            self._rows.clear()
            self._ground = None
        if self._is_broken and self._rows and frame.time > self._rows[-1][0]:
            self._rows.clear()  # a line would join what was read before with what is read now
        self._is_broken = False
        if self._rows and frame.time == self._rows[-1][0]:
            self._rows.pop()
        if self._ground is None:
            self._ground = frame.potential
        potential = frame.potential - self._ground
        depth = float(frame.depths.max(initial=0.0))
        energies = (frame.kinetic, potential, frame.kinetic + potential)
        self._rows.append((frame.time, *energies, float(len(frame.depths)), depth))

    def interrupt(self) -> None:
        """Begin anew with the next frame of a later time: nothing was read before it."""
        self._is_broken = True

    def show(self) -> None:
        """Draw all frames added so far."""
        columns = np.array(self._rows).T
        if columns.shape[-1] >= 2:
            energy_unit, energies = _express(columns[1:4], _ENERGY_UNITS)
            depth_unit, depths = _express(columns[5], _DEPTH_UNITS)
            self._energy.title = f"energy, {energy_unit}"
            self._depth.title = f"deepest contact, {depth_unit}"
            self._energy.data = (columns[0], *energies)
            self._count.data = (columns[0], columns[4])
            self._depth.data = (columns[0], depths)
        self._page.content = draw_line_plots((self._energy, self._count, self._depth))


def _express(
    values: NDArray[np.float64], units: tuple[tuple[str, float], ...]
) -> tuple[str, NDArray[np.float64]]:
    """Return the largest unit in which the values are not tiny, and the values in it.

    Args:
        values: Values in an SI unit.
        units: Names, and numbers of units in an SI unit; the largest unit first.
    """
    largest = float(np.abs(values).max())
    fitting = (unit for unit in units if largest * unit[1] >= _LEAST_NUMBER or largest == 0.0)
    name, factor = next(fitting, units[-1])
    return name, factor * values
