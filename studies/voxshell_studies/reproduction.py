"""Experiments from settings to report: missing parts are computed, and all results are written."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from voxshell.errors import SettingsError
from voxshell.measuring.environment import describe_environment
from voxshell.measuring.files import write_csv, write_json

from voxshell_studies.part import plain
from voxshell_studies.running import run_parts
from voxshell_studies.settings import override
from voxshell_studies.store import Store

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence
    from pathlib import Path

    from voxshell_studies.experiment import Experiment, Picture, Results
    from voxshell_studies.part import Part
    from voxshell_studies.verdict import Row

TABLE, RESULTS = "table.csv", "results.json"


@dataclass(frozen=True)
class Study:
    """An experiment with its settings.

    Attributes:
        experiment: The experiment.
        settings: Settings of its type.
        parts: The parts of its data.
        folder: The folder of its outputs.
    """

    experiment: Experiment
    settings: Any
    parts: tuple[Part, ...]
    folder: Path

    @property
    def store(self) -> Store:
        """The finished parts."""
        return Store(self.folder / "data")


@dataclass(frozen=True)
class Finding:
    """A study and its results."""

    study: Study
    rows: list[Row]
    pictures: list[Picture]


def plan_studies(
    experiments: Iterable[Experiment],
    out: Path,
    *,
    quick: bool,
    overrides: Mapping[str, Mapping[str, Any]],
    known: Iterable[str],
) -> list[Study]:
    """Decide the settings of experiments.

    Args:
        experiments: The chosen experiments.
        out: The common folder; each experiment gets a folder in it.
        quick: Start from the quick settings.
        overrides: Tables of settings by experiment.
        known: Names of all experiments; other tables are errors.

    Raises:
        SettingsError: A table or a setting is invalid; the message names it.
    """
    names = set(known)
    for table in overrides:
        if table not in names:
            raise SettingsError(
                f"[{table[:80]}] is an unknown table; valid tables: {', '.join(sorted(names))}"
            )
    studies = []
    for each in experiments:
        base = each.quick if quick else each.settings
        settings = override(base, overrides.get(each.name, {}), each.name)
        studies.append(Study(each, settings, tuple(each.plan(settings)), out / each.name))
    return studies


def run_studies(
    studies: Sequence[Study],
    *,
    jobs: int | None = None,
    scheduler: str | None = None,
    done: Callable[[Part], object] | None = None,
) -> None:
    """Compute the missing parts; see :func:`voxshell_studies.running.run_parts`."""
    for study in studies:
        study.store.sweep()
    work = [(study.store, part) for study in studies for part in study.parts]
    run_parts(work, jobs=jobs, scheduler=scheduler, done=done)


def conclude(study: Study) -> Finding:
    """Reduce a study's data to rows, draw it, and write table, results and pictures."""
    results: Results = {part.name: study.store.get(part) for part in study.parts}
    rows = study.experiment.reduce(study.settings, results)
    pictures = study.experiment.draw(study.settings, results, study.folder)
    _write_table(study.folder / TABLE, rows)
    write_json(
        study.folder / RESULTS,
        {
            "experiment": study.experiment.name,
            "settings": plain(study.settings),
            "rows": describe_rows(study, rows),
            "pictures": [asdict(picture) for picture in pictures],
            "parts": {part.name: str(study.store.place(part).name) for part in study.parts},
            "environment": describe_environment(),
        },
    )
    return Finding(study, rows, pictures)


def describe_rows(study: Study, rows: Iterable[Row]) -> list[dict[str, Any]]:
    """Return rows ready for JSON."""
    return [
        {"experiment": study.experiment.name, **asdict(row), "verdict": row.verdict} for row in rows
    ]


def _write_table(path: Path, rows: list[Row]) -> None:
    write_csv(
        path,
        ("quantity", "published", "here", "unit", "reproduced", "bar", "holds", "verdict", "note"),
        (
            [
                *(row.quantity, row.published, row.here, row.unit),
                *(row.reproduced, row.bar, row.holds, row.verdict, row.note),
            ]
            for row in rows
        ),
    )
