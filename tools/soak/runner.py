"""Shares time among tasks: whoever had least of it takes the next turn."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping

from soak.ledger import Ledger, Record
from soak.task import Task, UnavailableError
from soak.worker import CaseError, Worker

TURNS = 4  # of each task in a run, so that a short run gives some time to all
LONGEST_TURN = 20.0  # seconds; a kill loses at most one turn
MANY_FAULTS = 1000  # a task that has found so many is not run any more


def run(
    registry: str,
    tasks: Mapping[str, Task],
    ledger: Ledger,
    seconds: float,
    report: Callable[[str, Record], None],
) -> None:
    """Runs the tasks of a registry until all have met their target or the time is over.

    Every turn ends with a saved record. Whatever ends the run, what was counted is kept.

    Args:
        registry: The module that `tasks` are from; workers import it.
        tasks: By name.
        ledger: Where the counters are.
        seconds: How long, about: cases are not cut off.
        report: Called after every turn.
    """
    records = {name: ledger.load(name, task) for name, task in tasks.items()}
    workers = {name: Worker(registry, name, task.patience) for name, task in tasks.items()}
    spent = dict.fromkeys(tasks, 0.0)
    turn = min(seconds / len(tasks) / TURNS, LONGEST_TURN)
    end = time.monotonic() + seconds
    try:
        while (now := time.monotonic()) < end:
            waiting = [name for name in tasks if wants_more(tasks[name], records[name])]
            if not waiting:
                return
            name = min(waiting, key=lambda name: spent[name])
            take_turn(tasks[name], workers[name], records[name], min(now + turn, end))
            spent[name] += time.monotonic() - now
            ledger.save(name, records[name])
            report(name, records[name])
            if records[name].unavailable or not wants_more(tasks[name], records[name]):
                workers[name].stop()
                spent[name] += seconds if records[name].unavailable else 0.0
            if all(records[name].unavailable for name in waiting):
                return
    finally:
        for name, worker in workers.items():
            worker.close()
            if records[name].last:
                ledger.save(name, records[name])


def wants_more(task: Task, record: Record) -> bool:
    """Whether its target is still ahead."""
    return task.done(record.totals) < task.target and record.found < MANY_FAULTS


def take_turn(task: Task, worker: Worker, record: Record, until: float) -> None:
    """Runs cases until that time or the target, at least one."""
    record.stamp()
    try:
        worker.start()
    except UnavailableError as lack:
        record.unavailable = str(lack)
        return
    except CaseError as fault:
        record.note_fault(record.next_case, f"cannot be prepared: {fault}")
        return
    record.unavailable = ""
    while True:
        began = time.monotonic()
        case = record.next_case
        try:
            record.totals.add(worker.run(case))
        except CaseError as fault:
            record.note_fault(case, str(fault))
        except UnavailableError as lack:
            record.unavailable = str(lack)
            return
        record.next_case = case + 1
        record.seconds += time.monotonic() - began
        if time.monotonic() >= until or not wants_more(task, record):
            record.stamp()
            return
