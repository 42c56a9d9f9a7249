"""The committed pictures: where they come from, and how large they are."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pictures
import pytest
from PIL import Image

ROOT = Path(pictures.ROOT)
MOST_BYTES = 2_500_000


def test_every_picture_that_pages_show_is_one_that_the_tool_makes():
    made = {file for file, _ in pictures.PICTURES.values()}
    kept = {path.name for path in (ROOT / "docs/pictures").iterdir()}
    assert kept == made
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert set(re.findall(r'src="docs/pictures/([^"]+)"', readme)) <= made
    index = (ROOT / "docs/index.md").read_text(encoding="utf-8")
    assert set(re.findall(r'src="_static/([^"]+)"', index)) <= made


def test_pictures_are_small_and_moving_ones_move():
    paths = list((ROOT / "docs/pictures").iterdir())
    assert sum(path.stat().st_size for path in paths) < MOST_BYTES
    for path in paths:
        if path.suffix == ".webp":
            with Image.open(path) as image:
                assert image.n_frames > 20
                assert image.size == pictures.SIZE


def test_the_chart_reads_the_tables_of_the_comparison(tmp_path: Path):
    page = (ROOT / "docs/peers.md").read_text(encoding="utf-8")
    for heading in ("## Times", "## Contacts and depths"):
        rows = pictures.read_table(page, heading)
        assert set(pictures.ENGINES) <= set(rows)
        assert "pair 73.6" in rows["engine"]
    assert f"pair {pictures.TRUE_DEPTH:.2f}" in page
    chart = pictures.draw_peers(tmp_path / "peers.svg").read_text(encoding="utf-8")
    assert chart == (ROOT / "docs/pictures/peers.svg").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("cell", "expected"), [("120 µs / 138 µs 15x", 120.0), ("4.61 ms / 4.81 ms 14x", 4610.0)]
)
def test_times_of_cells(cell: str, expected: float):
    assert pictures.microseconds(cell) == pytest.approx(expected)


def test_a_moving_picture_becomes_coarser_where_it_would_be_too_large(tmp_path: Path, monkeypatch):
    rng = np.random.default_rng(0)
    noise = [Image.fromarray(rng.integers(0, 255, (64, 64, 3), np.uint8)) for _ in range(3)]
    fine = pictures.save_moving(tmp_path / "fine.webp", noise, 40).stat().st_size
    monkeypatch.setattr(pictures, "MOST_BYTES", fine - 1)
    assert pictures.save_moving(tmp_path / "coarse.webp", noise, 40).stat().st_size < fine


def test_an_unknown_picture_is_refused(capsys):
    with pytest.raises(SystemExit):
        pictures.main(["cat"])
    assert "there are: nut" in capsys.readouterr().err
