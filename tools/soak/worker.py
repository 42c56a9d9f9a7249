"""A process of its own for the cases of one task, so that a crash or a hang is a finding.

usage: python -m soak.worker REGISTRY NAME

REGISTRY is a module with `TASKS`. Says {"ready": true}, or what is missing; then reads the number of a
case a line and answers each with a line of JSON.
"""

from __future__ import annotations

import faulthandler
import importlib
import json
import os
import select
import signal
import subprocess
import sys
import tempfile
import traceback
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

from soak.task import Outcome, Task, UnavailableError

STARTS_WITHIN = 600.0  # seconds in which a task is prepared
TEXT = 2000  # characters of a finding that are kept


def main(registry: str, name: str) -> None:
    """The process; ends when its input does."""
    faulthandler.enable()
    # What a library prints must not get between the answers.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)

    def answer(what: dict[str, Any]) -> None:
        print(json.dumps(what), file=answers, flush=True)

    task: Task = importlib.import_module(registry).TASKS[name]
    try:
        check = task.prepare()
    except UnavailableError as lack:
        answer({"unavailable": str(lack)})
        return
    answer({"ready": True})
    for line in sys.stdin:
        try:
            answer(asdict(check(int(line))))
        except Exception:
            answer({"fault": traceback.format_exc()[-TEXT:]})


class CaseError(Exception):
    """What a case found, as a text."""


class PrepareError(CaseError):
    """The task cannot be prepared, so none of its cases can run."""


class Worker:
    """The other end: starts the process again where it has died.

    Args:
        registry: The module with `TASKS`.
        name: Of the task.
        patience: Seconds after which a case hangs.
    """

    def __init__(self, registry: str, name: str, patience: float) -> None:
        self._command = [sys.executable, "-m", "soak.worker", registry, name]
        self._patience = patience
        self._process: subprocess.Popen[str] | None = None
        self._folder = tempfile.TemporaryDirectory(prefix="voxshell-soak-")
        self._errors = Path(self._folder.name, "errors")

    def start(self) -> None:
        """Prepares the task where that has not been done.

        Raises:
            UnavailableError: The task cannot run here.
            PrepareError: It cannot be prepared.
        """
        if self._process is not None:
            return
        with self._errors.open("w") as errors:
            self._process = subprocess.Popen(
                self._command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=errors,
                text=True,
                start_new_session=True,  # Ctrl-C is for the runner, and it ends what a task has started
                env={**os.environ, "TMPDIR": self._folder.name, "VOXSHELL_CACHE_SIZE": "0"},
            )
        try:
            said = self._read(STARTS_WITHIN)
        except CaseError as fault:
            raise PrepareError(f"cannot be prepared: {fault}") from fault
        if "unavailable" in said:
            self.stop()
            raise UnavailableError(said["unavailable"])

    def run(self, case: int) -> Outcome:
        """One case.

        Raises:
            CaseError: The promise does not hold, the process has died, or it hangs.
        """
        self.start()
        assert self._process is not None
        assert self._process.stdin is not None
        with suppress(BrokenPipeError):  # the answer says so
            self._process.stdin.write(f"{case}\n")
            self._process.stdin.flush()
        said = self._read(self._patience)
        if "fault" in said:
            raise CaseError(said["fault"])
        return Outcome(**said)

    def stop(self) -> None:
        """Ends the process and all that it has started."""
        if self._process is None:
            return
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.communicate()
        self._process = None

    def kill(self) -> None:
        """Ends them at once, from another thread; what waits for an answer raises a CaseError."""
        process = self._process
        if process is not None:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)

    def close(self) -> None:
        """Ends the process for good."""
        self.stop()
        self._folder.cleanup()

    def _read(self, patience: float) -> dict[str, Any]:
        assert self._process is not None
        assert self._process.stdout is not None
        ready, _, _ = select.select([self._process.stdout], [], [], patience)
        if not ready:
            self.stop()
            raise CaseError(f"no answer within {patience:g} s")
        line = self._process.stdout.readline()
        if line:
            return json.loads(line)
        code = self._process.wait()
        self.stop()
        ended = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        stack = self._errors.read_text(errors="replace")[-TEXT:]
        raise CaseError(f"{stack}\nthe process ended with {ended}")


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
    main(*sys.argv[1:])
