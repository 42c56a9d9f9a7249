"""Experiments: questions, the parts that answer them, and the evaluation of the parts' data."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

from voxshell_studies.part import Part, Tables
from voxshell_studies.verdict import Row

if TYPE_CHECKING:
    from pathlib import Path

Results: TypeAlias = Mapping[str, Tables]
"""The tables of every part, by the part's name."""


@dataclass(frozen=True)
class Picture:
    """A file beside the report.

    Attributes:
        path: Relative to the experiment's folder.
        caption: A sentence.
    """

    path: str
    caption: str


@dataclass(frozen=True)
class Experiment:
    """A question with typed settings.

    Attributes:
        name: Name on the command line and in files.
        title: Title for people.
        question: The question, a sentence or two.
        describe: Describes the set-up in words, from the settings.
        settings: Full settings.
        quick: Settings for a first look.
        plan: Returns the parts.
        reduce: Returns the rows, from the parts' data alone.
        draw: Writes figures, animations and replays into a folder, from the data alone.
        published: True if the thesis' section contains it; other experiments go beyond.
    """

    name: str
    title: str
    question: str
    describe: Callable[[Any], str]
    settings: Any
    quick: Any
    plan: Callable[[Any], list[Part]]
    reduce: Callable[[Any, Results], list[Row]]
    draw: Callable[[Any, Results, Path], list[Picture]]
    published: bool = True
