"""Report of the geometry study."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from voxshell_studies.experiment import Experiment, Picture
from voxshell_studies.geometry import study
from voxshell_studies.geometry.contacts import MET, MET_DEPTH
from voxshell_studies.geometry.costs import COMPARED
from voxshell_studies.geometry.models import RETRIANGULATED
from voxshell_studies.geometry.study import GeometrySettings, name_contacts, name_pair, name_scene
from voxshell_studies.report.figures import FAINT, OURS, PEERS, open_figure
from voxshell_studies.report.geometry.costs import judge_builds, judge_costs
from voxshell_studies.report.geometry.pairs import (
    judge_bounds,
    judge_sharpness,
    judge_violations,
    tell_worst,
)
from voxshell_studies.scenes.geometry import (
    COINCIDENT,
    FRACTION_OF_OBJECT,
    LEAST_BAR,
    PAIRS,
    SCENES,
    THIN,
    GeometryScene,
)
from voxshell_studies.verdict import Row, at_most, format_value, in_mm

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from voxshell_studies.experiment import Results
    from voxshell_studies.part import Columns

NORMAL_BAR = 10.0
"""Degrees."""

FRACTION_BAR = 99.0
"""Percent of contacts that must be correct."""

VOXEL_FRACTION_BAR = 0.25
"""Largest error of points on b, in voxels of the field."""

_GROUNDS = ("slab", "table", "stairs", "terrain")
_GROUPS = {
    "rest": "bodies at rest",
    "edges": "edges, corners and tips",
    "thin": "thin parts",
    "inside": "bodies within others",
}
_SHOWN_LEAST = 1e-6
"""Errors below this are drawn here, meters."""


def describe(settings: GeometrySettings) -> str:
    """Return the setup as text."""
    held_out = sum(SCENES[name].held_out for name in settings.chosen)
    compared = (
        f" Two of {COMPARED}, 1 mm deep in each other, are queried in {settings.compared_poses} poses. "
        "Queries of uniform models, of models to a tolerance that makes them as exact, and of default "
        "models alternate."
    )
    return (
        f"{len(settings.chosen)} scenes of two meshes that approach each other, {held_out} of them "
        f"chosen by someone who did not write the code, run in {settings.poses} poses each, in both "
        f"orders of the bodies, with {settings.rotations} rotated copies and {settings.retriangulated} "
        "with other triangles. Models and queries have default settings. The truth comes from the "
        "meshes: the first touch of their triangles along the approach, the shortest separating "
        f"translation, and the faces nearest to each contact. {settings.pairs} pairs of mixed size meet "
        f"in {settings.pair_poses:,} poses. A search of {settings.optimized} steps makes the worst of "
        "these poses worse." + (compared if settings.compared_poses else "")
    )


# ---- rows ----------------------------------------------------------------------------------------


def reduce(settings: GeometrySettings, results: Results) -> list[Row]:
    """Return the verdicts."""
    chosen = [SCENES[name] for name in settings.chosen]
    scenes = {scene.name: results[name_scene(scene.name)] for scene in chosen}
    pairs = {
        " and ".join(PAIRS[index]): results[name_pair(index)]
        for index in range(settings.pairs)
        if len(results[name_pair(index)]["poses"]["offset"])
    }
    # Quantities begin with the titles of their groups.
    groups: dict[str, Sequence[Row | None]] = {
        "Wrong answers at least the bar off the first touch": [
            _judge_answers(group, chosen, results) for group in _GROUPS
        ],
        "Approaches with an overlap that is denied": [
            _judge_unseen(group, chosen, results) for group in _GROUPS
        ],
        "First contact beyond the first touch": [
            _judge_onset(scene, scenes[scene.name]["approaches"]) for scene in chosen
        ],
        "Deepest contact off the true depth at most": [
            _judge_depth(scene, scenes[scene.name]["depths"])
            for scene in chosen
            if scene.group == "rest" and scene.b.startswith(_GROUNDS)
        ],
        "Normals and places of contacts": [
            *(
                row
                for body in THIN
                if settings.judged_pairs
                for row in _judge_thin(body, results[name_contacts(body)]["contacts"])
            ),
            *(
                row
                for scene in chosen
                if scene.judge_normals
                for row in _judge_normals(scene, scenes[scene.name]["contacts"])
            ),
            *(_tell_normals(group, chosen, results) for group in _GROUPS),
        ],
        "Bodies in the same pose": [_judge_coincident(results["coincident"]["bodies"])],
        "Answers wrong beyond the stated bounds": [
            judge_violations(name, tables) for name, tables in pairs.items()
        ],
        "Worst overlap that is denied": [
            tell_worst(name, tables["worst"]) for name, tables in pairs.items()
        ],
        "Stated bounds at most": [
            judge_bounds(name, tables["poses"]) for name, tables in pairs.items()
        ],
        "Stated bound over the worst overlap that is denied": [
            judge_sharpness(settings, name, tables) for name, tables in pairs.items()
        ],
        "Default builds": judge_builds(results["builds"]["builds"]) if settings.builds else [],
        "Costs beside a uniform model that is as exact": (
            judge_costs(settings, results["costs"]) if settings.compared_poses else []
        ),
    }
    return [
        replace(row, group=group)
        for group, rows in groups.items()
        for row in rows
        if row is not None
    ]


def _mark(scene: GeometryScene) -> str:
    return f"{scene.name}, held out" if scene.held_out else scene.name


def _judge_answers(group: str, chosen: list[GeometryScene], results: Results) -> Row | None:
    """Return overlaps at least as deep as the scene's bar that ``collide`` denies."""
    denied = asked = early = apart = 0
    for scene in chosen:
        if scene.group != group:
            continue
        table = results[name_scene(scene.name)]["depths"]
        deep = table["depth"] >= 0.999 * scene.onset_bar
        asked += int(deep.sum())
        denied += int((table["yes"][deep] == 0.0).sum())
        apart += int((table["apart_yes"][deep] >= 0.0).sum())
        early += int((table["apart_yes"][deep] == 1.0).sum())
    if asked == 0:
        return None
    return Row(
        f"wrong answers at least the bar off the first touch, {_GROUPS[group]}",
        None,
        denied + early,
        f"of {asked + apart}",
        bar="0",
        holds=denied + early == 0,
        note=f"{denied} overlaps denied, {early} gaps taken for contact",
    )


def _judge_unseen(group: str, chosen: list[GeometryScene], results: Results) -> Row | None:
    """Return approaches on which ``collide`` denies an overlap at any place."""
    unseen = asked = 0
    worst, where = 0.0, ""
    for scene in chosen:
        if scene.group != group:
            continue
        table = results[name_scene(scene.name)]["approaches"]
        asked += len(table["unseen"])
        unseen += int((table["unseen"] * table["slope"] > scene.onset_bar).sum())
        deepest = float(table["unseen"].max(initial=0.0))
        if deepest > worst:
            worst, where = deepest, scene.name
    if asked == 0:
        return None
    return Row(
        f"approaches with an overlap that is denied, {_GROUPS[group]}",
        None,
        unseen,
        f"of {asked}",
        bar="0",
        holds=unseen == 0,
        note=f"at most {format_value(worst * 1e3)} mm beyond the first touch, {where}"
        if where
        else "",
    )


def _judge_onset(scene: GeometryScene, table: Columns) -> Row:
    """Return the error of the first contact, compared with the true first touch."""
    onset = _correct(table)
    worst = float(onset[np.argmax(np.abs(onset))]) if len(onset) else np.nan
    notes = []
    never = int(np.isinf(onset).sum())
    if never:
        notes.append(f"never in {never} of {len(onset)} approaches")
    for name, of_kind in (
        ("as it is", table["copy"] == 0),
        ("rotated", table["copy"] > 0),
        ("other triangles", table["copy"] == RETRIANGULATED),
    ):
        if of_kind.any():
            notes.append(f"{name} {in_mm(np.abs(onset[of_kind]).max())}")
    notes.append(f"deepest overlap denied {in_mm(table['unseen'].max(initial=0.0))}")
    return Row(
        f"first contact beyond the first touch, {_mark(scene)}",
        None,
        worst * 1e3,
        "mm",
        bar=f"<= {format_value(scene.onset_bar * 1e3)}",
        holds=at_most(abs(worst), scene.onset_bar),
        note="; ".join(notes),
    )


def _correct(table: Columns) -> NDArray[np.float64]:
    """Return first contacts beyond the touch as lengths of the separating translation, meters."""
    return table["onset"] * table["slope"]


def _judge_depth(scene: GeometryScene, table: Columns) -> Row:
    """Return the error of the deepest contact, compared with the true depth.

    Where edges cross or a body is wedged in, no point is as deep as the shortest separating
    translation: any value from the largest depth to that length is correct.
    """
    deepest = _deepest(table)
    off = np.maximum(table["reach"] - deepest, deepest - table["way_out"]).clip(min=0.0)
    bar = max(LEAST_BAR, FRACTION_OF_OBJECT * scene.size)
    worst = float(off.max()) if len(off) else np.nan
    return Row(
        f"deepest contact off the true depth at most, {_mark(scene)}",
        None,
        worst * 1e3,
        "mm",
        bar=f"<= {format_value(bar * 1e3)}",
        holds=at_most(worst, bar),
        note=f"median {in_mm(np.median(off))}, at depths up to {in_mm(table['way_out'].max())}"
        if len(off)
        else "",
    )


def _deepest(table: Columns) -> NDArray[np.float64]:
    """Return the deepest contact of each pose, or 0 if there is none."""
    return np.where(table["count"] > 0.0, table["deepest"], 0.0)


def _leave_out_ambiguous(table: Columns) -> tuple[Columns, str]:
    """Return the contacts that are not ambiguous, and the number of others."""
    is_clear = table["ambiguous"] == 0.0
    left_out = len(is_clear) - int(is_clear.sum())
    said = f"; {left_out:,} more say that they are ambiguous" if left_out else ""
    return {name: column[is_clear] for name, column in table.items()}, said


def _judge_normals(scene: GeometryScene, table: Columns) -> list[Row]:
    """Return rows on normals and points of contacts of a scene made for them."""
    table, said = _leave_out_ambiguous(table)
    if len(table["angle"]) == 0:
        return []
    angles = np.degrees(table["angle"])
    angle = float(np.percentile(angles, 99))
    off = float((table["b_off"] / table["voxel"]).max())
    return [
        Row(
            f"normals off the nearest surface's cone, 99 %, {_mark(scene)}",
            None,
            angle,
            "degrees",
            bar=f"<= {NORMAL_BAR:g}",
            holds=at_most(angle, NORMAL_BAR),
            note=f"{len(angles):,} contacts, median {format_value(float(np.median(angles)))}, worst "
            f"{format_value(float(angles.max()))}{said}",
        ),
        Row(
            f"points_b off b at most, {_mark(scene)}",
            None,
            off,
            "voxels",
            bar=f"<= {VOXEL_FRACTION_BAR:g}",
            holds=at_most(off, VOXEL_FRACTION_BAR),
            note=in_mm(table["b_off"].max()),
        ),
    ]


def _judge_thin(body: str, table: Columns) -> list[Row]:
    """Return the fractions of correct contacts of a thin body, in any pose."""
    table, said = _leave_out_ambiguous(table)
    angles = np.degrees(table["angle"])
    offs = table["b_off"] / table["voxel"]
    others = " or ".join(MET)
    return [
        Row(
            f"{name}, {body}, {MET_DEPTH * 1e3:g} mm deep in any pose",
            None,
            100.0 * float((values <= bar).mean()) if len(values) else np.nan,
            "%",
            bar=f">= {FRACTION_BAR:g}",
            holds=len(values) > 0 and float((values <= bar).mean()) >= 0.01 * FRACTION_BAR,
            note=f"{len(values):,} contacts with the {others}; median {format_value(float(np.median(values)))}, "
            f"worst {format_value(float(values.max()))} {unit}{said}"
            if len(values)
            else "",
        )
        for name, values, bar, unit in (
            (
                "normals within 10 degrees of the nearest surface's cone",
                angles,
                NORMAL_BAR,
                "degrees",
            ),
            ("points_b within a quarter voxel of b", offs, VOXEL_FRACTION_BAR, "voxels"),
        )
    ]


def _tell_normals(group: str, chosen: list[GeometryScene], results: Results) -> Row | None:
    """Return rows on normals of all contacts of a group, for information."""
    tables = [
        _leave_out_ambiguous(results[name_scene(s.name)]["contacts"])[0]
        for s in chosen
        if s.group == group
    ]
    angles = np.degrees(np.concatenate([np.zeros(0), *(table["angle"] for table in tables)]))
    if len(angles) == 0:
        return None
    off = np.concatenate([table["b_off"] for table in tables])
    return Row(
        f"normals off the nearest surface's cone, 99 %, {_GROUPS[group]}",
        None,
        float(np.percentile(angles, 99)),
        "degrees",
        note=f"{len(angles):,} contacts, median {format_value(float(np.median(angles)))}; points_b off b "
        f"by up to {in_mm(off.max())}",
    )


def _judge_coincident(table: Columns) -> Row:
    seen = (table["yes"] == 1.0) & (table["count"] > 0.0)
    unseen = [body for body, yes in zip(COINCIDENT, seen, strict=True) if not yes]
    return Row(
        "two bodies in the same pose, no contact",
        None,
        len(unseen),
        f"of {len(seen)}",
        bar="0",
        holds=not unseen,
        note=", ".join(unseen),
    )


# ---- figures -------------------------------------------------------------------------------------


def draw(settings: GeometrySettings, results: Results, folder: Path) -> list[Picture]:
    """Draw the error of each first contact, a line for each scene."""
    scenes = [SCENES[name] for name in settings.chosen]
    with open_figure(folder / "onset.png", width=10, height=1.2 + 0.2 * len(scenes)) as figure:
        axes = figure.subplots()
        never = 0.1
        for line, scene in enumerate(scenes):
            onset = np.abs(_correct(results[name_scene(scene.name)]["approaches"]))
            seen = np.isfinite(onset)
            late = onset > scene.onset_bar
            for chosen, color, marker in (
                (seen & ~late, OURS, "o"),
                (seen & late, PEERS[0], "o"),
                (~seen, PEERS[0], ">"),
            ):
                where = np.where(seen, np.maximum(onset, _SHOWN_LEAST), never)[chosen]
                axes.plot(
                    where * 1e3, np.full(len(where), line), marker, color=color, ms=4, alpha=0.6
                )
            bar = scene.onset_bar * 1e3
            axes.plot([bar, bar], [line - 0.4, line + 0.4], color="black", lw=1.5)
        axes.set_yticks(range(len(scenes)), [_mark(scene) for scene in scenes], fontsize=7)
        axes.set(
            xscale="log",
            xlabel="first contact off the true first touch, mm",
            ylim=(len(scenes) - 0.5, -0.5),
        )
        axes.axvline(never * 1e3, color=FAINT, lw=0.8)
        axes.text(never * 1e3, -0.7, "never", ha="center", fontsize=7)
        axes.grid(axis="y", color=FAINT, alpha=0.2)
    return [
        Picture(
            "onset.png",
            "First contact off the true first touch as a separating translation, a dot a pose, copy and order of "
            "the bodies; the black lines are the bars, and smaller errors than 1 \N{MICRO SIGN}m are drawn there.",
        )
    ]


GEOMETRY = Experiment(
    name="geometry",
    title="Geometry",
    question="How accurate are yes-or-no answers, depths, normals and places at default settings?",
    describe=describe,
    settings=GeometrySettings(),
    quick=replace(
        GeometrySettings(),
        poses=2,
        rotations=0,
        retriangulated=0,
        judged=8,
        judged_pairs=4,
        pairs=4,
        pair_poses=400,
        optimized=0,
        compared_poses=20,
    ),
    plan=study.plan,
    reduce=reduce,
    draw=draw,
    published=False,
)
