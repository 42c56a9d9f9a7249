"""Shares time among tasks: whoever had least of it takes the next turn."""

from __future__ import annotations

import threading
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Mapping
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from dataclasses import dataclass, field

from soak.ledger import Ledger, Record
from soak.task import Outcome, Task, UnavailableError
from soak.worker import CaseError, PrepareError, Worker

TURNS = 4  # of each task in a run, so that a short run gives some time to all
LONGEST_TURN = 20.0  # seconds; a kill loses at most one turn
MANY_FAULTS = 1000  # a task that has found so many is not run any more
IDLE = 0.2  # seconds after which a job without a task looks for one again


@dataclass
class Shift:
    """What the jobs of a run share. All but the names, the end and `over` needs the lock.

    Attributes:
        registry: The module that `tasks` are from; workers import it.
        tasks: By name.
        records: By name.
        end: When the run is over, by the monotonic clock.
        turn: Seconds of a turn.
        spent: Seconds that each task has had, turns under way included.
        running: How many workers of each task are in a turn.
        idle: Workers of each task that are in none.
        made: All workers.
        over: Set once the jobs are to stop at once.
    """

    registry: str
    tasks: Mapping[str, Task]
    records: dict[str, Record]
    end: float
    turn: float
    spent: defaultdict[str, float] = field(default_factory=lambda: defaultdict(float))
    running: Counter[str] = field(default_factory=Counter)
    idle: dict[str, list[Worker]] = field(default_factory=dict)
    made: list[Worker] = field(default_factory=list)
    over: threading.Event = field(default_factory=threading.Event)
    lock: threading.Lock = field(default_factory=threading.Lock)

    def wants_more(self, name: str) -> bool:
        """Whether a task can run and its target is ahead."""
        return not self.records[name].unavailable and wants_more(
            self.tasks[name], self.records[name]
        )

    def take(self) -> tuple[str, Worker] | None:
        """Chooses the task of the next turn, and charges it for the turn.

        Returns its name and an idle or new worker, or None if no task can run at the moment.
        """
        free = [
            name
            for name, task in self.tasks.items()
            if self.wants_more(name) and not (task.alone and self.running[name])
        ]
        if not free:
            return None
        name = min(free, key=lambda name: self.spent[name])
        self.running[name] += 1
        self.spent[name] += self.turn
        if self.idle.get(name):
            return name, self.idle[name].pop()
        self.made.append(Worker(self.registry, name, self.tasks[name].patience))
        return name, self.made[-1]


def run(
    registry: str,
    tasks: Mapping[str, Task],
    ledger: Ledger,
    seconds: float,
    report: Callable[[str, Record], None],
    jobs: int = 1,
) -> None:
    """Runs the tasks of a registry until all have met their target or the time is over.

    Every turn ends with a saved record. Whatever ends the run, what was counted is kept.

    Args:
        registry: The module that `tasks` are from; workers import it.
        tasks: By name.
        ledger: Where the counters are.
        seconds: How long, about: cases are not cut off.
        report: Called after every turn, by one job at a time.
        jobs: How many cases run at the same time.
    """
    records = {name: ledger.load(name, task) for name, task in tasks.items()}
    for record in records.values():
        record.unavailable = ""  # what was missing may be there now
    turn = min(seconds * jobs / len(tasks) / TURNS, LONGEST_TURN)
    shift = Shift(registry, tasks, records, time.monotonic() + seconds, turn)
    try:
        with ThreadPoolExecutor(jobs) as threads:
            futures = [threads.submit(take_turns, shift, ledger, report) for _ in range(jobs)]
            try:
                wait(futures, return_when=FIRST_EXCEPTION)
            finally:
                shift.over.set()
                while any(not future.done() for future in futures):
                    for worker in list(shift.made):
                        worker.kill()
                    wait(futures, IDLE)
        for future in futures:
            future.result()
    finally:
        for worker in shift.made:
            worker.close()
        for name, record in records.items():
            if record.has_run:
                ledger.save(name, record)


def wants_more(task: Task, record: Record) -> bool:
    """Whether its target is still ahead."""
    return task.done(record.totals) < task.target and record.found < MANY_FAULTS


def take_turns(shift: Shift, ledger: Ledger, report: Callable[[str, Record], None]) -> None:
    """One job: turns of the tasks until the run is over."""
    while not shift.over.is_set() and (now := time.monotonic()) < shift.end:
        with shift.lock:
            taken = shift.take()
            nobody_runs = not shift.running.total()
        if taken is None:
            if nobody_runs:
                return
            shift.over.wait(IDLE)
            continue
        name, worker = taken
        task, record = shift.tasks[name], shift.records[name]
        take_turn(task, worker, record, min(now + shift.turn, shift.end), shift)
        with shift.lock:
            shift.running[name] -= 1
            shift.spent[name] += time.monotonic() - now - shift.turn
            if shift.wants_more(name):
                shift.idle.setdefault(name, []).append(worker)
            else:
                worker.stop()
            ledger.save(name, record)
            if not shift.over.is_set():
                report(name, record)


def take_turn(task: Task, worker: Worker, record: Record, until: float, shift: Shift) -> None:
    """Runs cases until that time or the target, at least one.

    Stamps the record once a case has run: what cannot run here leaves the stamp of its figures.
    """
    is_stamped = False
    while True:
        began = time.monotonic()
        with shift.lock:
            number = record.next_case
            record.next_case = number + 1
        found: Outcome | CaseError | UnavailableError
        try:
            found = worker.run(number)
        except (CaseError, UnavailableError) as why:
            found = why
        with shift.lock:
            if shift.over.is_set():
                return  # the worker may have been killed
            if isinstance(found, UnavailableError):
                record.unavailable = str(found)
                record.next_case = number
                return
            if not is_stamped:
                record.stamp(task.sources)
                is_stamped = True
            if isinstance(found, PrepareError):
                record.note_fault(number, str(found))
                record.unavailable = "cannot be prepared"
                return
            if isinstance(found, CaseError):
                record.note_fault(number, str(found))
            else:
                record.totals.add(found)
            record.seconds += time.monotonic() - began
            if time.monotonic() >= until or not wants_more(task, record):
                record.stamp(task.sources)
                return
