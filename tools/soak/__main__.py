"""The command line: `./dev soak --help`."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Mapping

from soak import page, runner
from soak.ledger import DamagedFileError, Ledger, Record
from soak.task import Task, UnavailableError
from soak.tasks import TASKS
from soak.worker import CaseError, Worker

REGISTRY = "soak.tasks"
DESCRIPTION = """\
Checks every promise of voxshell against its oracle in random cases, and counts.

Counters stay in build/soak, and --write puts them into docs/evidence.json: run the command again, here or
elsewhere, to add to them, as often and as long as you like, and interrupt it with Ctrl-C whenever you
like. A change to the sources that a promise is about starts its counter again. Tasks share the time:
whoever had least of it takes the next turn, until its target is met.
"""
EPILOG = """\
examples:
  ./dev soak                            ten minutes for all tasks together
  ./dev soak --minutes 600 --write      a night, then docs/evidence.md
  ./dev soak --only kills cold_keys     two tasks alone
  ./dev soak --only kills --case 17     one case again, as a finding asks for
  ./dev soak --minutes 0 --write        only writes the page

Exits with 1 if anything was ever found with these sources, or a task's cases prove little.
"""


def main(arguments: list[str] | None = None) -> int:
    """Returns the exit code."""
    options = parse(arguments)
    names = options.only or list(TASKS)
    tasks = {name: TASKS[name] for name in names}
    if options.case is not None:
        return run_case(names[0], options.case)
    ledger = Ledger()
    try:
        return count(options, tasks, ledger)
    except DamagedFileError as error:
        print(error, file=sys.stderr)
        return 2


def count(options: argparse.Namespace, tasks: Mapping[str, Task], ledger: Ledger) -> int:
    """Runs the tasks and writes the page; returns the exit code."""
    code = 0
    lacks: dict[str, str] = {}

    def take_report(name: str, record: Record) -> None:
        report(name, record)
        if record.unavailable:
            lacks[name] = record.unavailable

    try:
        if options.minutes > 0:
            print(f"counting in {ledger.folder}")
            runner.run(REGISTRY, tasks, ledger, 60.0 * options.minutes, take_report, options.jobs)
    except KeyboardInterrupt:
        print("\ninterrupted; rerun the command to resume")
        code = 130
    records = {name: ledger.load(name, task) for name, task in TASKS.items()}
    if options.write:
        latest = {name: ledger.load_latest(name, task) for name, task in TASKS.items()}
        ledger.commit(latest)
        page.write_page(TASKS, latest)
        print(f"wrote {page.PAGE} and {ledger.committed.name}")
    for name, lack in lacks.items():
        print(f"{name} was not run, and its figures stay what they were: {lack}", file=sys.stderr)
    return code or sum_up(tasks, records)


def parse(arguments: list[str] | None) -> argparse.Namespace:
    """Says what is wrong with them, and exits, where something is."""
    listed = "".join(
        f"  {name:16}{task.target:>13,.0f} {task.unit:23}{task.promise}\n"
        for name, task in TASKS.items()
    )
    cores = len(os.sched_getaffinity(0))
    parser = argparse.ArgumentParser(
        prog="./dev soak",
        description=DESCRIPTION,
        epilog=f"tasks, and what a release asks for:\n{listed}\n{EPILOG}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--minutes", type=float, default=10.0, help="how long, 10 by default")
    parser.add_argument(
        "--jobs",
        type=int,
        default=cores,
        help=f"cases at the same time, by default {cores}: one per core",
    )
    parser.add_argument(
        "--only", nargs="+", choices=list(TASKS), metavar="NAME", help="tasks to run"
    )
    parser.add_argument(
        "--write", action="store_true", help="then write docs/evidence.md and .json"
    )
    parser.add_argument(
        "--case", type=int, metavar="NUMBER", help="run this case of the --only task, uncounted"
    )
    options = parser.parse_args(arguments)
    if options.jobs < 1:
        parser.error(f"--jobs is {options.jobs}: give 1 or more")
    if options.case is not None and len(options.only or []) != 1:
        parser.error("--case is a case of one task: name it with --only")
    return options


def run_case(name: str, case: int) -> int:
    """One case again, in a process that may crash."""
    worker = Worker(REGISTRY, name, TASKS[name].patience)
    try:
        print(worker.run(case))
    except (CaseError, UnavailableError) as why:
        print(why)
        return 1
    finally:
        worker.close()
    return 0


def report(name: str, record: Record) -> None:
    """A line after each turn."""
    task = TASKS[name]
    done = f"{task.done(record.totals):,.0f} of {task.target:,.0f} {task.unit}"
    found = f"  FOUND {record.found}" if record.found else ""
    lack = f"  not run: {record.unavailable}" if record.unavailable else ""
    print(f"  {name:16} {done}{found}{lack}", flush=True)


def sum_up(tasks: Mapping[str, Task], records: Mapping[str, Record]) -> int:
    """Says what was found; returns the exit code."""
    code = 0
    for name, task in tasks.items():
        record = records[name]
        for fault in record.faults:
            print(f"\n{name}, case {fault['case']}:\n{fault['what']}", file=sys.stderr)
        doubt = task.doubt(record.totals) if record.totals.count else ""
        if doubt:
            print(f"{name} proves little: {doubt}", file=sys.stderr)
        if record.found or doubt:
            code = 1
    short = sum(runner.wants_more(task, records[name]) for name, task in tasks.items())
    found = sum(records[name].found for name in tasks)
    print(f"{found} found; {short} of {len(tasks)} counters are short of their targets")
    return code


if __name__ == "__main__":
    sys.exit(main())
