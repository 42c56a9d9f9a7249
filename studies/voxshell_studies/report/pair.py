"""Report of bunny on bunny."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from voxshell_studies import pair
from voxshell_studies.experiment import Experiment, Picture
from voxshell_studies.pair import PairSettings
from voxshell_studies.report.drop import COLORS
from voxshell_studies.report.figures import FAINT, OURS_PLANE, open_figure
from voxshell_studies.scenes.drop import METHODS
from voxshell_studies.timing import STAGES
from voxshell_studies.verdict import Row, at_least, format_value

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from voxshell_studies.experiment import Results

LEAST_OVER_GIMPACT, LEAST_OVER_PARTS = 600.0, 15.0
BARS_AT_REST = {("decomposition", "vps-fine"): LEAST_OVER_PARTS, ("hull", "vps-fine"): None}
BARS_FALLING = {
    ("decomposition", "vps-fine"): None,
    ("decomposition", pair.UNFOLLOWED): None,
    ("decomposition", "vps-coarse"): None,
}
"""Required ratio of a peer's time to a model's, by their keys."""

LABELS = {method.key: method.label for method in METHODS} | {
    pair.UNFOLLOWED: "VPS fine, not followed",
    "collide": "VPS fine, yes/no (from Python)",
    "coal": "coal, yes/no (from Python)",
}


def describe(settings: PairSettings) -> str:
    """Return the setup as text."""
    return (
        f"Two bunnies of {settings.size * 1e3:g} mm overlap by {settings.least_depth * 1e3:g} to "
        f"{settings.most_depth * 1e3:g} mm in {settings.poses} relative poses, the same for every method "
        "in one process. At each pose the bunny moves back and forth by "
        f"{settings.drift * 1e3:g} mm, as in a simulation. Figures are medians over poses of the least "
        f"of {settings.repeats} repeats. In each repeat the fast methods run {settings.turns} times, and "
        "GImpact and the yes/no queries once, so that a busy machine affects all of them alike. The "
        "yes/no queries of voxshell and coal are called from Python (coal uses trees of oriented boxes "
        "with swept spheres)."
        f" Falling: one bunny falls {settings.falls} times onto the other, which is fixed. The steps in "
        "which they touch are timed, at the speed that the bunny has there. Models that move by more "
        "than a voxel in a step get continuous collision detection, and hulls do not. The fine shell "
        "therefore falls once more without it (`ccd_motion_threshold`)."
        + (_describe_rest(settings) if pair.rests(settings) else "")
    )


def _describe_rest(settings: PairSettings) -> str:
    return (
        " At rest: the four pairs of a stack of five bunnies that has stood for "
        f"{settings.rest_seconds:g} s are timed in the poses of its next {settings.rest_steps} steps."
    )


def reduce(settings: PairSettings, results: Results) -> list[Row]:
    """Return the verdicts."""
    times = {key: _median(results, key) for key in (*pair.PAIRED, "collide", "coal")}
    over_gimpact = times["gimpact"] / times["vps-fine"]
    over_parts = times["decomposition"] / times["vps-fine"]
    rows = [
        Row(
            "GImpact / VPS fine, bunny on bunny",
            None,
            over_gimpact,
            "times",
            bar=f">= {LEAST_OVER_GIMPACT:g}",
            holds=at_least(over_gimpact, LEAST_OVER_GIMPACT),
        ),
        Row(
            "decomposition / VPS fine, bunny on bunny",
            None,
            over_parts,
            "times",
            bar=f">= {LEAST_OVER_PARTS:g}",
            holds=at_least(over_parts, LEAST_OVER_PARTS),
            note=_explain_fine(results),
        ),
        Row(
            "GJK on the hull / VPS fine, bunny on bunny",
            None,
            times["hull"] / times["vps-fine"],
            "times",
        ),
        *(
            _tell_part(results, "at-rest", "at rest", "pairs", BARS_AT_REST)
            if pair.rests(settings)
            else ()
        ),
        *_tell_part(results, "falling", "falling", "steps", BARS_FALLING),
        Row(
            "coal / ours, yes/no from Python",
            None,
            times["coal"] / times["collide"],
            "times",
            note="" if np.isfinite(times["coal"]) else "coal is not installed: pip install coal",
        ),
    ]
    found = results["times"]["contacts"]
    for key, seconds in times.items():
        mine = found["method"] == key
        note = ""
        if mine.any():
            note = (
                f"in contact in {int((found['contacts'][mine] > 0).sum())} of {int(mine.sum())} poses, "
                f"deepest {format_value(_deepest(results, key))} mm"
            )
        rows.append(
            Row(f"median time, {LABELS[key]}", None, seconds * 1e6, "\N{MICRO SIGN}s", note=note)
        )
    return rows


def _tell_part(
    results: Results,
    part: str,
    state: str,
    poses: str,
    bars: Mapping[tuple[str, str], float | None],
) -> list[Row]:
    """Return the ratios of bodies that rest or fall.

    Args:
        results: Results of the experiment.
        part: Name of the part.
        state: State of the bodies, in words.
        poses: Origin of its poses, in words.
        bars: As BARS_AT_REST.
    """
    rows = []
    for (peer, model), bar in bars.items():
        theirs, ours = (_median(results, key, part) for key in (peer, model))
        each = _of_poses(results, peer, part) / _of_poses(results, model, part)
        low, high = (format_value(float(x)) for x in (each.min(), each.max()))
        rows.append(
            Row(
                f"{LABELS[peer]} / {LABELS[model]}, bunny on bunny, {state}",
                None,
                theirs / ours,
                "times",
                bar="" if bar is None else f">= {bar:g}",
                holds=None if bar is None else at_least(theirs / ours, bar),
                note=f"{low} to {high} over the {poses}; {format_value(theirs * 1e6)} to {format_value(ours * 1e6)} "
                f"\N{MICRO SIGN}s, of which, each at its least, {_list_stages(results, part, model)}",
            )
        )
    return rows


def _list_stages(results: Results, part: str, model: str = "vps-fine") -> str:
    return ", ".join(
        f"{stage} {format_value(1e6 * _median(results, f'{model}-{stage}', part))}"
        for stage in STAGES
    )


def _explain_fine(results: Results) -> str:
    """Return the stages of the fine shell's time, and its number of contacts beside the hulls'."""
    found = results["times"]["contacts"]
    fine, hulls = (
        float(found["contacts"][found["method"] == key].mean())
        for key in ("vps-fine", "decomposition")
    )
    return (
        f"VPS takes {_list_stages(results, 'times')} \N{MICRO SIGN}s for {fine:.1f} contacts; the hulls have {hulls:.1f}, "
        f"deepest {format_value(_deepest(results, 'decomposition'))} mm instead of "
        f"{format_value(_deepest(results, 'vps-fine'))}"
    )


def _deepest(results: Results, key: str) -> float:
    """Return the largest depth of all poses, millimeters."""
    found = results["times"]["contacts"]
    return float(found["depth"][found["method"] == key].max()) * 1e3


def draw(settings: PairSettings, results: Results, folder: Path) -> list[Picture]:
    """Draw times of all poses, a box for each method."""
    del settings
    with open_figure(folder / "times.png", width=9, height=3.8) as figure:
        axes = figure.subplots()
        keys = [key for key in LABELS if len(_of_poses(results, key))]
        for place, key in enumerate(keys):
            color = COLORS.get(key, OURS_PLANE if key == "collide" else FAINT)
            values = np.sort(_of_poses(results, key)) * 1e6
            axes.plot(values, np.full(len(values), place), "|", color=color, ms=14)
            axes.plot(np.median(values), place, "o", color=color)
        axes.set_yticks(range(len(keys)), [LABELS[key] for key in keys])
        axes.set(xscale="log", xlabel="time of a pose, \N{MICRO SIGN}s")
    return [Picture("times.png", "Narrow phase of bunny on bunny: a line a pose, the dot their median.")]  # fmt: skip


def _of_poses(results: Results, key: str, part: str = "times") -> NDArray[np.float64]:
    """Return seconds, (poses,): the shortest time of each, which other load affects least."""
    table = results[part]["times"]
    mine = table["method"] == key
    if not mine.any():
        return np.zeros(0)
    poses = int(table["pose"][mine].max()) + 1
    return np.min(table["seconds"][mine].reshape(-1, poses), axis=0)


def _median(results: Results, key: str, part: str = "times") -> float:
    values = _of_poses(results, key, part)
    return float(np.median(values)) if len(values) else float("nan")


PAIR = Experiment(
    name="pair",
    title="Bunny on bunny",
    question="How long does the narrow phase of two meshes take, compared with Bullet's methods and coal?",
    describe=describe,
    settings=PairSettings(),
    quick=replace(PairSettings(), poses=8, repeats=2),
    plan=pair.plan,
    reduce=reduce,
    draw=draw,
    published=False,
)
