"""What has been counted so far: build/soak/NAME.json on this machine, docs/evidence.json in the repository.

A counter speaks of some of the sources (`Task.sources`) and of the source of its task. It adds up over
commits and machines that change none of them, and begins at zero where one does.
"""

from __future__ import annotations

import hashlib
import inspect
import json
import os
import subprocess
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from voxshell.measuring.environment import read_cpuinfo

from soak.task import Task, Totals

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "build/soak"
COMMITTED = ROOT / "docs/evidence.json"
MOST_FAULTS = 20  # of a task that are kept with their text; all are counted


@dataclass
class Record:
    """The counter of one task.

    Attributes:
        code: Digest of the sources that it speaks of, the task's own among them.
        next_case: Where the next turn begins.
        totals: Of all cases so far.
        seconds: That they took.
        found: Cases in which the promise did not hold.
        faults: The first of them: their number and what was wrong.
        unavailable: What this machine lacks for it, or "".
        commit: That it ran on last.
        machine: Likewise.
        first: When it began, UTC.
        last: When it ended last.
    """

    code: str
    next_case: int = 0
    totals: Totals = field(default_factory=Totals)
    seconds: float = 0.0
    found: int = 0
    faults: list[dict[str, Any]] = field(default_factory=list)
    unavailable: str = ""
    commit: str = ""
    machine: str = ""
    first: str = ""
    last: str = ""

    @property
    def has_run(self) -> bool:
        """Whether any case did."""
        return self.seconds > 0 or self.found > 0

    def note_fault(self, case: int, what: str) -> None:
        """Counts one more finding."""
        self.found += 1
        if len(self.faults) < MOST_FAULTS:
            self.faults.append({"case": case, "what": what})

    def stamp(self, sources: tuple[str, ...]) -> None:
        """Says when, where and on which commit."""
        self.last = datetime.now(timezone.utc).strftime("%Y-%m-%d %H:%M")
        self.first = self.first or self.last
        self.commit, self.machine = name_commit(sources), name_machine()


class DamagedFileError(Exception):
    """A file of counters cannot be read; the message names it."""


class Ledger:
    """The records of the code as it is now.

    Args:
        folder: Where this machine keeps them.
        committed: The file of those that the repository has.
    """

    def __init__(self, folder: Path = FOLDER, committed: Path = COMMITTED) -> None:
        self.folder = folder
        self.committed = committed

    def load(self, name: str, task: Task) -> Record:
        """What was counted with this code and this task, here or by whoever committed more of it."""
        code = digest(task)
        fitting = [record for record in self._find(name) if record.code == code]
        return max(fitting, key=lambda record: record.next_case, default=Record(code))

    def load_latest(self, name: str, task: Task) -> Record:
        """The same; of older code where no case ran with this code yet."""
        record = self.load(name, task)
        older = [each for each in self._find(name) if each.has_run]
        return record if record.has_run or not older else max(older, key=lambda each: each.last)

    def save(self, name: str, record: Record) -> None:
        """Replaces the file at once, so that a kill leaves the old one or the new one.

        A record of which no case ran never replaces one with figures, of older code.
        """
        if not record.has_run and any(each.has_run for each in self._find(name)):
            return
        self.folder.mkdir(parents=True, exist_ok=True)
        _replace(self._path(name), asdict(record))

    def _find(self, name: str) -> list[Record]:
        """What this machine has of a task, and what the repository has."""
        found = []
        for path, keys in ((self._path(name), ()), (self.committed, (name,))):
            content = _read(path)
            try:
                for key in keys:
                    content = content.get(key)
                if content:
                    found.append(Record(**{**content, "totals": Totals(**content["totals"])}))
            except (AttributeError, KeyError, TypeError) as error:
                raise _damaged(path, error) from error
        return found

    def commit(self, records: Mapping[str, Record]) -> None:
        """Replaces the repository's file, for others to go on from.

        Of a fault it gets the last line alone: the lines above it name files of this machine.
        """
        content = {name: asdict(record) for name, record in records.items()}
        for record in content.values():
            for fault in record["faults"]:
                fault["what"] = last_line(fault["what"])
        _replace(self.committed, content)

    def _path(self, name: str) -> Path:
        return self.folder / f"{name}.json"


def last_line(text: str) -> str:
    """The last line of an error, short enough for a list."""
    return (text.strip().splitlines() or ["?"])[-1][:200].replace("`", "'")


def _read(path: Path) -> Any:
    try:
        return json.loads(path.read_text()) if path.is_file() else {}
    except ValueError as error:
        raise _damaged(path, error) from error


def _damaged(path: Path, error: Exception) -> DamagedFileError:
    return DamagedFileError(f"{path} holds no counters ({error}); delete it to count from zero")


def _replace(path: Path, content: dict[str, Any]) -> None:
    unfinished = path.with_suffix(f".{os.getpid()}")
    unfinished.write_text(json.dumps(content, indent=1) + "\n")
    unfinished.replace(path)


def digest(task: Task) -> str:
    """Of all files that a counter speaks of, tracked or not."""
    listed = _git("ls-files", "--cached", "--others", "--exclude-standard", "--", *task.sources)
    combined = hashlib.sha256(Path(inspect.getfile(task.prepare)).read_bytes())
    for name in sorted(set(listed.splitlines())):
        path = ROOT / name
        if path.is_file():
            combined.update(name.encode() + b"\0" + hashlib.sha256(path.read_bytes()).digest())
    return combined.hexdigest()[:12]


def name_commit(sources: tuple[str, ...]) -> str:
    """The commit, with "-dirty" where these sources are not as it has them."""
    changed = _git("status", "--porcelain", "--", *sources)
    return _git("rev-parse", "--short=12", "HEAD").strip() + ("-dirty" if changed else "")


def name_machine() -> str:
    """Processor and number of cores."""
    cpu = read_cpuinfo("model name") or "unknown processor"
    return f"{cpu}, {len(os.sched_getaffinity(0))} cores"


def _git(*arguments: str) -> str:
    command = ["git", "-C", str(ROOT), *arguments]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout
