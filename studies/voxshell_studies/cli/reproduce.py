"""``voxshell reproduce``: the experiments of the thesis' section 5.3, and beyond it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import App, Parameter
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from voxshell.base.outputs import check_output_folder, make_folder
from voxshell.errors import SettingsError
from voxshell.measuring.files import finite

from voxshell_studies.cli.verdict_table import make_table
from voxshell_studies.report.catalog import EXPERIMENTS

if TYPE_CHECKING:
    from voxshell_studies.experiment import Experiment
    from voxshell_studies.reproduction import Finding, Study

reproduce = App(
    name="reproduce",
    help="""Run experiments of the thesis' section 5.3, and compare with what was published.

    For example, all of them within minutes, and one at its full size:

        voxshell reproduce all --quick --out reproduction
        voxshell reproduce bunny --out reproduction
    """,
)


@Parameter(name="*")
@dataclass(frozen=True)
class Options:
    """What all experiments take.

    Attributes:
        out: The folder to write to. Parts that are complete there do not run again.
        quick: Run fewer orientations, phases and steps.
        settings: A TOML file with one table per experiment; its keys override settings.
        scheduler: Address of a Dask scheduler that runs the untimed parts, such as
            tcp://10.0.0.1:8786.
        jobs: Number of processes for untimed parts and figures; one per core by default.
        json_only: Print only JSON: the rows of the report.
    """

    out: Path = Path("reproduction")
    quick: Annotated[bool, Parameter(negative="")] = False
    settings: Path | None = None
    scheduler: str | None = None
    jobs: int | None = None
    json_only: Annotated[bool, Parameter(name="--json", negative="")] = False


DEFAULTS = Options()

OTHER_TABLES = ("peers",)
"""Tables of a settings file for other commands."""


def run(experiments: tuple[Experiment, ...], options: Options) -> list[Finding]:
    """Plan, run what is missing, conclude, and print a table for each experiment."""
    from voxshell_studies.reproduction import conclude, describe_rows, plan_studies
    from voxshell_studies.running import run_each
    from voxshell_studies.settings import read_settings_file

    if options.jobs is not None and options.jobs < 1:
        raise SettingsError(f"jobs must be at least 1, not {options.jobs}")
    overrides = {} if options.settings is None else read_settings_file(options.settings)
    try:
        studies = plan_studies(
            experiments,
            options.out,
            quick=options.quick,
            overrides=overrides,
            known=[*(each.name for each in EXPERIMENTS), *OTHER_TABLES],
        )
    except SettingsError as error:
        if options.settings is None:
            raise
        raise SettingsError(f"{options.settings}: {error}") from error
    check_output_folder(options.out)
    make_folder(options.out)
    progress_console = Console(quiet=options.json_only, stderr=True)
    _run_missing(studies, options, progress_console)
    findings = []
    with progress_console.status("") as status:
        concluded = run_each(conclude, studies, options.jobs)
        for study in studies:
            status.update(f"{study.experiment.name}: table and figures")
            findings.append(next(concluded))
    if options.json_only:
        rows = [row for each in findings for row in describe_rows(each.study, each.rows)]
        print(json.dumps(finite(rows)))
        return findings
    console = Console(highlight=False)
    for finding in findings:
        console.print(make_table(finding.study.experiment.title, finding.rows))
        console.print(f"  {finding.study.folder}", soft_wrap=True)
    return findings


def _run_missing(studies: list[Study], options: Options, console: Console) -> None:
    """Run parts with a progress bar and the remaining time."""
    from voxshell_studies.reproduction import run_studies

    missing = [part for s in studies for part in s.parts if not s.store.has(part)]
    count = sum(len(study.parts) for study in studies)
    with Progress(
        TextColumn("{task.description}"),
        BarColumn(bar_width=24),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(elapsed_when_finished=False),
        TextColumn("[dim]{task.fields[last]}"),
        console=console,
        disable=not console.is_terminal,
    ) as progress:
        known = count - len(missing)
        task = progress.add_task(
            f"{len(missing)} part{'' if len(missing) == 1 else 's'} to run"
            + (f", {known} done before" if known else ""),
            total=sum(part.cost for part in missing) or 1.0,
            last="",
        )
        run_studies(
            studies,
            jobs=options.jobs,
            scheduler=options.scheduler,
            done=lambda part: progress.update(task, advance=part.cost, last=part.name),
        )
        progress.update(task, completed=progress.tasks[0].total, last="")


def _add_command(experiment: Experiment) -> None:
    def command(*, options: Options = DEFAULTS) -> None:
        run((experiment,), options)

    command.__doc__ = f"{experiment.title}: {experiment.question}"
    reproduce.command(command, name=experiment.name)


for _experiment in EXPERIMENTS:
    _add_command(_experiment)


@reproduce.command(name="all")
def everything(*, options: Options = DEFAULTS) -> None:
    """Run all experiments, and write one report: index.html, an offline page, and report.json."""
    from voxshell_studies.report.page import PAGE, ROWS, write_report

    findings = run(EXPERIMENTS, options)
    command = "voxshell reproduce all" + (" --quick" if options.quick else "")
    write_report(options.out, findings, command=command)
    if not options.json_only:
        print(f"  {options.out / PAGE}, {ROWS}")
