"""Results and pictures of an experiment with the settings of a test."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from voxshell_studies.experiment import Experiment, Results
from voxshell_studies.part import compute_part


def compute(experiment: Experiment, settings: Any) -> Results:
    """The tables of all tasks of an experiment, by name."""
    return {part.name: compute_part(part).tables for part in experiment.plan(settings)}


def draw(experiment: Experiment, settings: Any, results: Results, folder: Path) -> None:
    """Draws an experiment's pictures into a folder, and asserts that their files exist."""
    pictures = experiment.draw(settings, results, folder)
    assert pictures
    assert all((folder / picture.path).is_file() for picture in pictures)
