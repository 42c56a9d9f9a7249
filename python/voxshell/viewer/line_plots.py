"""Small line plots over one time axis, as HTML: a title, a few round ticks, and lines."""

from __future__ import annotations

import math
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from voxshell.viewer.stage import nice_length

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

_WIDTH, _LEFT, _RIGHT = 300.0, 38.0, 8.0
_HEIGHT, _ABOVE, _BELOW = 58.0, 6.0, 15.0
"""Pixels of the area of the lines, above it for half a letter, and below it for the ticks of time."""
_STEPS = 3
"""Steps between ticks at most, but for one that zero or rounding adds."""
_INK, _TICK = "#48525f", "#e3e7ec"


@dataclass(eq=False)
class LinePlot:
    """Lines over time.

    Args:
        title: Quantity and unit.
        lines: Name and color of each line.
        data: Times (k,) in seconds, and the values (k,) of each line; empty before there are any.
        whole: The values are whole numbers, so ticks are, too.
    """

    title: str
    lines: dict[str, str]
    data: tuple[NDArray[np.float64], ...] = ()
    whole: bool = False


def draw_line_plots(plots: Sequence[LinePlot]) -> str:
    """Return plots below each other as HTML; the last one has the ticks of time."""
    drawn = "".join(_draw(plot, has_time=plot is plots[-1]) for plot in plots)
    return f'<div style="padding: 0 1em 0.6em; font-size: 0.8em; line-height: 1.5">{drawn}</div>'


def choose_ticks(low: float, high: float, *, whole: bool = False) -> NDArray[np.float64]:
    """Return round numbers that enclose zero and a range.

    Args:
        low: Lower end.
        high: Upper end.
        whole: Whole numbers only.

    Example:
        >>> choose_ticks(3.0, 56.0, whole=True).tolist()
        [0.0, 20.0, 40.0, 60.0]
        >>> choose_ticks(0.0, 0.0).tolist()
        [0.0]
    """
    low, high = min(low, 0.0), max(high, 0.0)
    if low == high:
        return np.zeros(1)
    step = nice_length((high - low) / _STEPS)
    if whole:
        step = max(step, 1.0)
    first, last = math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9)
    return np.arange(first, last + 1, dtype=np.float64) * step


def _draw(plot: LinePlot, *, has_time: bool) -> str:
    key = "".join(
        f' <span style="color: {color}">&#8212; {escape(name)}</span>'
        for name, color in plot.lines.items()
        if len(plot.lines) > 1
    )
    parts = [_line(_LEFT, _HEIGHT, _WIDTH - _RIGHT, _HEIGHT, _INK)]
    if len(plot.data) and len(plot.data[0]) > 1:
        times, values = plot.data[0], np.array(plot.data[1:])
        ticks = choose_ticks(float(values.min()), float(values.max()), whole=plot.whole)
        span = float(ticks[-1] - ticks[0]) or 1.0
        parts = [*_draw_ticks(ticks, span), *(_draw_time(times) if has_time else ())]
        across = _LEFT + (_WIDTH - _LEFT - _RIGHT) * (times - times[0]) / (times[-1] - times[0])
        for line, color in zip(values, plot.lines.values(), strict=True):
            up = _HEIGHT * (1.0 - (line - ticks[0]) / span)
            points = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(across, up, strict=True))
            parts.append(
                f'<polyline points="{points}" fill="none" stroke="{color}" stroke-width="1.2"/>'
            )
    height = _ABOVE + _HEIGHT + (_BELOW if has_time else 5.0)
    return (
        f'<div>{escape(plot.title)}{key}</div><svg viewBox="0 {-_ABOVE:g} {_WIDTH:g} {height:g}" '
        f'style="display: block; width: 100%" font-size="10" fill="{_INK}">{"".join(parts)}</svg>'
    )


def _draw_ticks(ticks: NDArray[np.float64], span: float) -> list[str]:
    parts = []
    for tick, label in zip(ticks, _write(ticks), strict=True):
        y = _HEIGHT * (1.0 - float(tick - ticks[0]) / span)
        parts.append(_line(_LEFT, y, _WIDTH - _RIGHT, y, _TICK if tick else _INK))
        parts.append(f'<text x="{_LEFT - 4:g}" y="{y + 3.5:.1f}" text-anchor="end">{label}</text>')
    return parts


def _draw_time(times: NDArray[np.float64]) -> list[str]:
    """Return the ticks of time, which do not reach beyond the first and last time."""
    start, end = float(times[0]), float(times[-1])
    step = nice_length((end - start) / 4.0)
    first, last = math.ceil(start / step - 1e-9), math.floor(end / step + 1e-9)
    ticks = np.arange(first, last + 1, dtype=np.float64) * step
    parts = []
    for tick, label in zip(ticks, _write(ticks), strict=True):
        x = _LEFT + (_WIDTH - _LEFT - _RIGHT) * (float(tick) - start) / (end - start)
        parts.append(_line(x, _HEIGHT, x, _HEIGHT + 3.0, _INK))
        parts.append(
            f'<text x="{min(x, _WIDTH - 14.0):.1f}" y="{_HEIGHT + 13:g}" text-anchor="middle">{label} s</text>'
        )
    return parts


def _write(ticks: NDArray[np.float64]) -> list[str]:
    """Return equally spaced numbers with as many decimals as their distance needs."""
    if len(ticks) < 2:
        return [f"{tick:g}" for tick in ticks.tolist()]
    decimals = max(0, -math.floor(math.log10(float(ticks[1] - ticks[0])) + 1e-9))
    return [f"{tick:,.{decimals}f}" for tick in (ticks + 0.0).tolist()]


def _line(x1: float, y1: float, x2: float, y2: float, color: str) -> str:
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{color}"/>'
