"""Plots over time beside a replay: number of contacts and largest depth."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

import numpy as np

from voxshell.base.lengths import limit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from voxshell.recording import Recording
    from voxshell.viewer.lanes import Lane
    from voxshell.viewer.timeline import Timeline

_WIDTH, _HEIGHT = 240.0, 40.0
_COLORS = ("#1f6fb4", "#d97706", "#2a9d6f", "#b4324a", "#7a55b0", "#8a6a4f", "#5b6878")


def draw_time_plots(lanes: Sequence[Lane], timeline: Timeline, *, full: float = 0.0) -> str:
    """Return two plots as HTML, with a line for each lane; empty without contacts or motion.

    Args:
        lanes: The lanes.
        timeline: The instants that are shown.
        full: Depth to which the plot of depths reaches at least, meters: that of the darkest color.

    Their ``data-seconds`` is the playback time from the left edge to the right one.
    """
    seconds = float(timeline.pauses.sum())
    counts = [_counts(lane.recording, timeline) for lane in lanes]
    depths = [_depths(lane.recording, timeline) for lane in lanes]
    most = max(float(values.max()) for values in counts)
    deepest = max(float(values.max()) for values in depths)
    if most == 0.0 or seconds == 0.0:
        return ""
    plots = [_draw(f"contacts, at most {most:,.0f}", counts, most)]
    if deepest > 0.0:
        plots.append(_draw(f"deepest, {limit(deepest)}", depths, max(deepest, full)))
    names = [lane.label.partition("\n")[0] for lane in lanes]
    key = "".join(
        f'<span style="color: {_color(number)}">{escape(name)}</span>'
        for number, name in enumerate(names)
        if len(lanes) > 1 and name
    )
    return f'<aside id="voxshell-plots" data-seconds="{seconds:.6g}">{"".join(plots)}{key}</aside>'


def _counts(recording: Recording, timeline: Timeline) -> NDArray[np.float64]:
    """Return the number of contacts shown at each instant, (k,)."""
    return recording.contacts.counts[timeline.contact_frames(recording)].astype(np.float64)


def _depths(recording: Recording, timeline: Timeline) -> NDArray[np.float64]:
    """Return the largest depth shown at each instant, (k,) meters; 0 if nothing overlaps."""
    track = recording.contacts
    deepest = np.zeros(recording.frame_count)
    np.maximum.at(deepest, np.repeat(np.arange(recording.frame_count), track.counts), track.depths)
    return deepest[timeline.contact_frames(recording)]


def _draw(title: str, lines: Sequence[NDArray[np.float64]], top: float) -> str:
    drawn = "".join(
        f'<polyline points="{_points(line / top)}" stroke="{_color(number)}"/>'
        for number, line in enumerate(lines)
    )
    return (
        f'<p>{title}</p><svg viewBox="0 0 {_WIDTH:g} {_HEIGHT:g}">{drawn}'
        f'<line class="now" y2="{_HEIGHT:g}"/></svg>'
    )


def _points(fractions: NDArray[np.float64]) -> str:
    """Return a line's points, each the maximum over a pixel's width."""
    last = len(fractions) - 1
    first = np.unique(np.linspace(0, last, int(_WIDTH) + 1).astype(int))
    across = first * (_WIDTH / last)
    up = (_HEIGHT - 1.0) * (1.0 - np.maximum.reduceat(fractions, first)) + 0.5
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(across, up, strict=True))


def _color(number: int) -> str:
    return _COLORS[number % len(_COLORS)]
