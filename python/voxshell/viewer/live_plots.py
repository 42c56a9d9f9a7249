"""Plots over simulated time beside a live view: energy, number of contacts, largest depth."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import viser

    from voxshell.simulation.live_frame import LiveFrame

_SAMPLES = 600
"""Number of frames in the plots: twenty seconds at 30 frames per second."""

_HEIGHT = 104  # pixels
_ENERGY_COLORS = ("#1f6fb4", "#2a9d6f", "#1e2733")


class LivePlots:
    """Three plots in the controls of a page.

    Args:
        gui: The page's controls.
    """

    def __init__(self, gui: viser.GuiApi) -> None:
        # Columns: time; kinetic, potential and total energy; contacts; depth.
        self._rows: deque[tuple[float, ...]] = deque(maxlen=_SAMPLES)
        self._ground: float | None = None
        names = ("kinetic", "potential", "sum")
        self._energy = _add_plot(gui, "energy, J", dict(zip(names, _ENERGY_COLORS, strict=True)))
        self._count = _add_plot(gui, "contacts", {"contacts": "#b4324a"})
        self._depth = _add_plot(gui, "deepest contact, mm", {"depth": "#d97706"})

    def add(self, frame: LiveFrame) -> None:
        """Add a frame. If the time of the world went back, restart the plots."""
        if self._rows and frame.time < self._rows[-1][0]:
            self._rows.clear()
            self._ground = None
        if self._rows and frame.time == self._rows[-1][0]:
            self._rows.pop()
        if self._ground is None:
            self._ground = frame.potential
        potential = frame.potential - self._ground
        depth = 1e3 * float(frame.depths.max(initial=0.0))
        energies = (frame.kinetic, potential, frame.kinetic + potential)
        self._rows.append((frame.time, *energies, float(len(frame.depths)), depth))

    def show(self) -> None:
        """Draw all frames added so far."""
        columns = np.array(self._rows).T
        if columns.shape[-1] < 2:
            return
        self._energy.data = tuple(columns[:4])
        self._count.data = (columns[0], columns[4])
        self._depth.data = (columns[0], columns[5])


def _add_plot(gui: viser.GuiApi, title: str, colors: dict[str, str]) -> Any:
    nothing = np.array([0.0, 1.0])
    series = tuple({"label": name, "stroke": color, "width": 1.5} for name, color in colors.items())
    return gui.add_uplot(
        data=(nothing, *(np.zeros(2) for _ in colors)),
        series=({"label": "time, s"}, *series),  # pyright: ignore[reportArgumentType]
        scales={"x": {"time": False}},
        title=title,
        legend={"show": len(colors) > 1, "live": False},
        height=_HEIGHT,
    )
