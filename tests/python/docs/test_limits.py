"""The page of limits names scenes of the study that measures it, so that anyone can run them."""

from __future__ import annotations

import re
from pathlib import Path

from voxshell_studies.scenes.limits import SCENES

PAGE = Path(__file__).resolve().parents[3] / "docs/limits.md"
COLUMNS = 7


def rows() -> list[list[str]]:
    """Of the tables with a column for each rate, without their heads."""
    cells = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in PAGE.read_text(encoding="utf-8").splitlines()
        if line.startswith("| ")
    ]
    return [row for row in cells if len(row) == COLUMNS and row[0] != "limit"]


def test_every_row_is_a_scene_with_its_measure():
    measures = {
        f"{scene.name}: {scene.measured}" + (f", {scene.unit}" if scene.unit else "")
        for scene in SCENES.values()
    }
    shown = [re.sub(r" \([\d.]+ is true\)$", "", row[1]) for row in rows()]
    assert len(shown) > 30
    assert [text for text in shown if text not in measures] == []
    assert len(set(shown)) == len(shown)


def test_a_row_says_what_is_true_unless_it_is_clear():
    """The page says that fractions should be 1 and all else 0."""
    for row in rows():
        scene = next(scene for scene in SCENES.values() if row[1].startswith(f"{scene.name}: "))
        told = re.search(r"\(([\d.]+) is true\)$", row[1])
        if told is not None:
            assert float(told[1]) == scene.truth, scene.name
        else:
            shares = re.search(r"fraction|over|share", scene.measured)
            assert scene.truth == (1.0 if shares else 0.0), scene.name


def test_cells_are_empty_only_where_a_scene_does_not_run():
    for row in rows():
        scene = next(scene for scene in SCENES.values() if row[1].startswith(f"{scene.name}: "))
        filled = [rate for rate, cell in zip((1000, 200, 60, 30), row[2:6], strict=True) if cell]
        assert filled == list(scene.rates), scene.name


def test_titles_are_groups_of_the_study():
    named = {row[0].split("**")[1].rstrip(".") for row in rows() if row[0]}
    assert named <= {scene.group for scene in SCENES.values()}


def test_the_page_counts_the_scenes():
    told = re.search(r"which runs (\d+) scenes", PAGE.read_text(encoding="utf-8"))
    assert told is not None
    assert int(told[1]) == len(SCENES)
