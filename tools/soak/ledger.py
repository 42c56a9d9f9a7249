"""What has been counted so far, on the disk: build/soak/CODE/NAME.json.

CODE is a digest of the sources that a counter speaks of, so that counters add up over commits that
change none of them, and begin at zero where one does. The figures of other code stay in their folders.
"""

from __future__ import annotations

import hashlib
import inspect
import json
import os
import subprocess
from dataclasses import asdict, dataclass, field
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from voxshell.measuring.environment import read_cpuinfo

from soak.task import Task, Totals

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "build/soak"
SOURCES = (
    *("core", "bullet", "python", "cmake", "fuzz", "CMakeLists.txt"),
    *("tests/python/support", "tests/cpp/core/support", "tests/cpp/soak"),
)
MOST_FAULTS = 20  # of a task that are kept with their text; all are counted


@dataclass
class Record:
    """The counter of one task.

    Attributes:
        check: Digest of the task's own source.
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

    check: str
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

    def note_fault(self, case: int, what: str) -> None:
        """Counts one more finding."""
        self.found += 1
        if len(self.faults) < MOST_FAULTS:
            self.faults.append({"case": case, "what": what})

    def stamp(self) -> None:
        """Says when, where and on which commit."""
        self.last = datetime.now(timezone.utc).strftime("%Y-%m-%d %H:%M")
        self.first = self.first or self.last
        self.commit, self.machine = name_commit(), name_machine()


class Ledger:
    """The records of the code as it is now.

    Args:
        folder: Where they are kept.
    """

    def __init__(self, folder: Path = FOLDER) -> None:
        self.folder = folder / digest_of_code()

    def load(self, name: str, task: Task) -> Record:
        """What was counted with this code and this task; an empty record otherwise."""
        check = hashlib.sha256(Path(inspect.getfile(task.prepare)).read_bytes()).hexdigest()[:12]
        try:
            found = json.loads(self._path(name).read_text())
        except FileNotFoundError:
            return Record(check)
        if found["check"] != check:
            return Record(check)
        return Record(**{**found, "totals": Totals(**found["totals"])})

    def save(self, name: str, record: Record) -> None:
        """Replaces the file at once, so that a kill leaves the old one or the new one."""
        self.folder.mkdir(parents=True, exist_ok=True)
        unfinished = self._path(name).with_suffix(f".{os.getpid()}")
        unfinished.write_text(json.dumps(asdict(record), indent=1))
        unfinished.replace(self._path(name))

    def _path(self, name: str) -> Path:
        return self.folder / f"{name}.json"


def digest_of_code() -> str:
    """Of all files that a counter speaks of, tracked or not."""
    listed = _git("ls-files", "--cached", "--others", "--exclude-standard", "--", *SOURCES)
    digest = hashlib.sha256()
    for name in sorted(set(listed.splitlines())):
        path = ROOT / name
        if path.is_file():
            digest.update(name.encode() + b"\0" + hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:12]


def name_commit() -> str:
    """The commit, with "-dirty" where the sources of the counters are not as it has them."""
    changed = _git("status", "--porcelain", "--", *SOURCES)
    return _git("rev-parse", "--short=12", "HEAD").strip() + ("-dirty" if changed else "")


def name_machine() -> str:
    """Processor and number of cores."""
    cpu = read_cpuinfo("model name") or "unknown processor"
    return f"{cpu}, {len(os.sched_getaffinity(0))} cores"


def _git(*arguments: str) -> str:
    command = ["git", "-C", str(ROOT), *arguments]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout
