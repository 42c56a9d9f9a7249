#!/usr/bin/env python3
"""Draws the pictures that are committed: the moving ones of README.md and of the site, and the chart.

usage: tools/pictures.py [--out DIR] [NAME...]

Runs examples of examples/python and films their recordings, and draws the chart from the tables of docs/peers.md.
Writes to docs/pictures, or DIR. NAMEs choose some of: nut, bunnies, gripper, peers.
"""

from __future__ import annotations

import argparse
import runpy
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = ROOT / "examples/python"
SIZE = (420, 420)  # pixels
MOST_BYTES = 900_000
"""Of a moving picture: three of them are what a page may cost."""


class Film(NamedTuple):
    """How an example's recording is filmed.

    Args:
        example: The start of its file's name.
        options: Of its command.
        first: Frame of the recording.
        every: Each so many frames is a picture.
        milliseconds: From picture to picture.
        studio: Options of ``drawing.Studio``.
        most: Pictures at most.
    """

    example: str
    options: tuple[str, ...]
    first: int
    every: int
    milliseconds: int
    studio: dict[str, Any]
    most: int


FILMS = {
    "nut": Film(
        *("04", (), 14, 2, 60),  # before, forces are so large that their arrows leave the picture
        {
            "azimuth": 35,
            "elevation": 18,
            "fill": 0.84,  # room for arrows
            "cut": ("nut",),
        },
        48,
    ),
    "bunnies": Film(
        *("07", ("--count", "15"), 2, 1, 80),
        {"elevation": 52, "fill": 0.98, "frames": (-1,)},
        28,
    ),
    "gripper": Film(
        *("11", (), 68, 4, 60),
        {
            "azimuth": 32,
            "elevation": 20,
            "fill": 0.94,
            "frames": (68, 120, 240),
            "focus": ("gripper/boom", "gripper/wrist", "mug"),
            "cut": ("mug",),
        },
        46,
    ),
}


def run_example(number: str, options: tuple[str, ...]) -> dict[str, Any]:
    """The variables of an example after it has run."""
    program = next(EXAMPLES.glob(f"{number}_*.py"))
    arguments, paths = sys.argv, sys.path.copy()
    sys.path.insert(0, str(EXAMPLES))
    try:
        with tempfile.TemporaryDirectory() as folder:
            sys.argv = [str(program), "--out", folder, *options]
            return runpy.run_path(str(program), run_name="__main__")
    finally:
        sys.argv, sys.path = arguments, paths


def film(film: Film, path: Path, *, quality: float = 0.7) -> Path:
    """Writes an animated WebP of an example."""
    made = run_example(film.example, film.options)
    recording = made["recorder"].recording(colors=made.get("colors"))
    sys.path.insert(0, str(EXAMPLES))
    from drawing import Studio  # pyright: ignore[reportMissingImports]: beside the examples

    studio = Studio(recording, size=SIZE, quality=quality, legend=False, **film.studio)
    frames = range(film.first, recording.frame_count, film.every)[: film.most]
    pictures = [studio.picture(frame) for frame in frames]
    return save_moving(path, pictures, film.milliseconds)


def save_moving(path: Path, pictures: list[Any], milliseconds: int) -> Path:
    """Writes an animated WebP that plays for ever, as well as its bytes allow, and rests at its end."""
    pauses = [milliseconds] * (len(pictures) - 1) + [1000]
    for quality in (82, 72, 62, 50):
        pictures[0].save(
            path,
            save_all=True,
            append_images=pictures[1:],
            duration=pauses,
            loop=0,
            quality=quality,
            method=6,
        )
        if path.stat().st_size <= MOST_BYTES:
            break
    return path


def read_table(text: str, heading: str) -> dict[str, list[str]]:
    """The rows of the first table under a heading of a Markdown page, by their first cell."""
    lines = iter(text[text.index(f"\n{heading}\n") :].splitlines())
    rows = {}
    for line in lines:
        if line.startswith("|"):
            name, *cells = (cell.strip() for cell in line.strip("|").split("|"))
            rows[name] = cells
        elif rows:
            break
    return rows


def microseconds(cell: str) -> float:
    """The median of a cell such as ``120 µs / 138 µs 15x``."""
    number, unit = cell.split()[:2]
    return float(number) * {"µs": 1.0, "ms": 1e3, "s": 1e6}[unit]


ENGINES = {
    "voxshell in Bullet, voxels": "voxshell",
    "Bullet GImpact": "Bullet, GImpact",
    "Bullet + CoACD": "Bullet, convex decomposition",
    "Bullet convex hull": "Bullet, convex hull",
    "MuJoCo + CoACD": "MuJoCo, convex decomposition",
    "MuJoCo hull": "MuJoCo, convex hull",
    "MuJoCo SDF": "MuJoCo, signed distance field",
    "Drake hydroelastic": "Drake, hydroelastic",
}
TRUE_DEPTH = 73.6  # millimeters, of the deepest pose of docs/peers.md


def draw_peers(path: Path) -> Path:
    """Writes the chart: time of a query, and the depth that it reports, in equal poses of two bunnies."""
    import matplotlib.pyplot as plt

    text = (ROOT / "docs/peers.md").read_text(encoding="utf-8")
    times, depths = read_table(text, "## Times"), read_table(text, "## Contacts and depths")
    column = times["engine"].index("pair 73.6")
    names = list(ENGINES)
    took = [microseconds(times[name][column]) for name in names]
    told = [depths[name][depths["engine"].index("pair 73.6")] for name in names]
    deep = [float(cell.split()[1]) if "(" in cell else None for cell in told]
    colors = ["#1f6fb4", *["#b9c2cd"] * (len(names) - 1)]
    plt.rcParams.update({"font.size": 11, "svg.hashsalt": "voxshell", "svg.fonttype": "path"})
    figure, (left, right) = plt.subplots(
        1, 2, figsize=(9.6, 4.0), layout="constrained", sharey=True
    )
    places = range(len(names))
    # Dots, because a logarithmic axis has no zero from which bars could begin.
    left.hlines(places, 2, 1e6, color="#e3e8ee", linewidth=1.0, zorder=0)
    left.scatter(took, places, color=colors, s=80)
    left.set(xscale="log", xlim=(2, 1e6), xlabel="time of a query, log scale", yticks=places)
    left.set_yticklabels([ENGINES[name] for name in names])
    left.set_xticks([10, 100, 1e3, 1e4, 1e5], ["10 µs", "0.1 ms", "1 ms", "10 ms", "100 ms"])
    left.invert_yaxis()
    for place, value in enumerate(took):
        label = f"{value:.3g} µs" if value < 1e3 else f"{value / 1e3:.3g} ms"
        box = {"facecolor": "white", "edgecolor": "none", "pad": 1.5}
        left.text(value * 1.5, place, label, va="center", bbox=box)
    right.barh(places, [value or 0.0 for value in deep], color=colors, height=0.66)
    right.axvline(TRUE_DEPTH, color="#c2185b", linewidth=1.4)
    label = f"true depth {TRUE_DEPTH:g} mm"
    right.text(TRUE_DEPTH + 1.5, -0.66, label, color="#c2185b", va="center")
    right.set(xlim=(0, 135), xlabel="depth that it reports, mm")
    for place, value in enumerate(deep):
        if value is None:
            right.text(2.0, place, "reports no depth", va="center")
        elif value > 15.0:
            color = "white" if place == 0 else "#1e2733"
            right.text(value - 1.5, place, f"{value:.1f}", va="center", ha="right", color=color)
        else:
            right.text(value + 1.5, place, f"{value:.1f}", va="center")
    for axes in (left, right):
        axes.spines[["top", "right", "left"]].set_visible(False)
        axes.tick_params(axis="y", length=0)
    figure.savefig(path, metadata={"Date": None}, facecolor="white")
    plt.close(figure)
    return path


PICTURES: dict[str, tuple[str, Callable[[Path], Path]]] = {
    **{
        name: (f"{name}.webp", lambda path, one=one: film(one, path)) for name, one in FILMS.items()
    },
    "peers": ("peers.svg", draw_peers),
}


def main(arguments: list[str]) -> int:
    """The command line; returns the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, default=ROOT / "docs/pictures")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(PICTURES)}")
    options = parser.parse_args(arguments)
    unknown = sorted(set(options.names) - set(PICTURES))
    if unknown:
        parser.error(f"unknown picture {unknown[0]!r}; there are: {', '.join(PICTURES)}")
    options.out.mkdir(parents=True, exist_ok=True)
    for name in options.names or PICTURES:
        file, make = PICTURES[name]
        path = make(options.out / file)
        print(f"{path}: {path.stat().st_size / 1e3:.0f} kB", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
