"""The page around a replay: heading, legend, and a policy that forbids network access."""

from __future__ import annotations

import re
from html import escape
from importlib.resources import files
from typing import TYPE_CHECKING

from voxshell.base.lengths import metric
from voxshell.base.outputs import write_text
from voxshell.errors import RecordingError
from voxshell.viewer.palette import FORCE_COLOR
from voxshell.viewer.pins import DEPTH_COLORS
from voxshell.viewer.stage import VIEW_ASPECT

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

# The browser refuses every network access, but may run what is in the page.
_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval' blob: data:; "
    "style-src 'unsafe-inline'; img-src data: blob:; font-src data:; connect-src data: blob:; "
    "worker-src data: blob:; base-uri 'none'; form-action 'none'"
)


def add_heading(
    page: str,
    *,
    title: str,
    caption: str,
    rate: str,
    deepest: float | None,
    grid: float | None,
    strongest: float = 0.0,
    plots: str = "",
    ground: float | None = None,
    seconds: float = 0.0,
    notes: Sequence[str] = (),
) -> str:
    """Add a heading with a legend to the player's page, and forbid network access.

    Args:
        page: The player's page, HTML.
        title: Plain text.
        caption: Plain text below the title; may be empty.
        rate: Plain text: the speed of the replay.
        deepest: Depth of the darkest color, meters; 0 if contacts do not overlap; None if there are
            no contacts.
        grid: Distance of grid lines, meters; None if there is no grid.
        strongest: Force of the longest arrow, newtons; 0 if there are no arrows.
        plots: HTML from :func:`~voxshell.viewer.time_plots.draw_time_plots`.
        ground: Height above which the camera stays, display units; None if there is no ground.
        seconds: Of playback up to the last picture, where the clock ends; 0 if nothing plays.
        notes: More lines of the legend, HTML.

    Raises:
        RecordingError: The page has no head or body, so the player is not the expected one.
    """
    legend = []
    if deepest is not None:
        if deepest > 0.0:
            legend.append(
                '<span class="depth">contact depth 0<span class="scale"></span>'
                f"{escape(metric(deepest))}</span>"
            )
        if strongest > 0.0:
            legend.append(
                '<span><b class="force">&#10230;</b> normal force on the moving body, '
                f"longest {strongest:g} N</span>"
            )
        else:
            legend.append("<span>stems: contact normals</span>")
        legend.append(
            '<label hidden><input id="voxshell-through" type="checkbox" checked>'
            "contacts show through bodies</label>"
        )
    legend += [f"<span>{note}</span>" for note in notes]
    if grid is not None:
        legend.append(f'<span class="faint">grid: {escape(metric(grid))}</span>')
    colors = ", ".join("#{:02x}{:02x}{:02x}".format(*color) for color in DEPTH_COLORS)
    heading = read_part("page.html")
    values = {
        "title": escape(title),
        "caption": f"<p>{escape(caption)}</p>" if caption else "",
        "rate": escape(rate),
        "legend": "".join(legend),
        "hint": "Drag to turn, right-drag to move, wheel to zoom"
        + (", space to pause." if rate else "."),
        "plots": plots,
        "colors": colors,
        "force": "#{:02x}{:02x}{:02x}".format(*FORCE_COLOR),
        "aspect": f"{VIEW_ASPECT:g}",
        "seconds": f"{seconds:.6g}",
        "canvas": read_part("canvas.css"),
        "own_look": read_part("own_look.js"),
        "stay_above": read_part("stay_above.js"),
        "ground": "null" if ground is None else f"{ground:.6g}",
    }
    heading = re.sub(r"\{\{(\w+)\}\}", lambda found: values[found[1]], heading)
    head, body = page.find("<head>"), page.rfind("</body>")
    if head < 0 or body < head:
        raise RecordingError(
            "viser's page has no <head> and </body>; this version is not supported"
        )
    head += len("<head>")
    policy = f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">'
    top, count = re.subn(
        r"<title>.*?</title>", lambda _: f"<title>{escape(title)}</title>", page[head:body], count=1
    )
    if count == 0:
        top = f"<title>{escape(title)}</title>{top}"
    return "".join([page[:head], policy, top, heading, page[body:]])


def plain_head() -> str:
    """Return the background and the light of a scene, for the head of a page that has none of its own."""
    return f"<style>{read_part('canvas.css')}</style><script>{read_part('own_look.js')}</script>"


def read_part(name: str) -> str:
    """Return a file of this folder, which pages contain."""
    return files("voxshell.viewer").joinpath(name).read_text(encoding="utf-8")


def write_whole(path: Path, text: str) -> Path:
    """Write a file so that readers see either the old or the new content."""
    write_text(path, text)
    return path
