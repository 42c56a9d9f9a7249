"""Writers whose system calls fail, or which are killed between two calls.

Each case takes the next writer; with each round of all writers, each meets the next kind of fault.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from soak.task import Check, Outcome, Task, Totals, UnavailableError

STRIDE = 7  # of commands, which take long; other cases meet the calls in between
MANY = 1_000  # points of failure after which each kind of fault has happened


def prepare() -> Check:
    from write_faults import SIGNALS, Fault, Host, NoCompilerError

    try:
        host = Host(Path(tempfile.mkdtemp(prefix="voxshell-soak-")))
    except NoCompilerError as lack:
        raise UnavailableError(str(lack)) from lack

    # A model is pickled without a file, so no call can fail.
    writers = [writer for writer in host.writers if writer != "pickled model"]

    def check(case: int) -> Outcome:
        rng = np.random.default_rng([case, 11])
        writer, error = choose(case, writers)
        lasts = error not in SIGNALS and bool(rng.integers(2))
        takes_half, over = bool(rng.integers(2)), bool(rng.integers(2))
        tallies = {writer: 0.0, error: 0.0}
        is_command, locks_fail = writer.startswith("voxshell "), error == "ENOLCK"
        stride = STRIDE if is_command and not locks_fail else 1  # there are few locks
        number = int(rng.integers(1, stride + 1))
        while host.run(writer, Fault(number, error, lasts, takes_half), over=over):
            tallies[writer] += 1
            tallies[error] += 1
            number += stride
        return Outcome(tallies[writer], tallies)

    return check


def choose(case: int, writers: list[str]) -> tuple[str, str]:
    """The writer of a case, and the kind of fault that it meets."""
    from write_faults import ERRORS, SIGNALS

    kinds = [*ERRORS, *SIGNALS]
    rounds, place = divmod(case, len(writers))
    return writers[place], kinds[(place + rounds) % len(kinds)]


def describe(totals: Totals) -> str:
    from write_faults import ERRORS, SIGNALS

    def list_tallies(names: tuple[str, ...]) -> str:
        return ", ".join(f"{name} {totals.tallies.get(name, 0):,.0f}" for name in names)

    writers = sorted({*totals.tallies} - {*ERRORS, *SIGNALS})
    return f"{list_tallies((*ERRORS, *SIGNALS))}; {list_tallies(tuple(writers))}"


def doubt(totals: Totals) -> str:
    from write_faults import ERRORS, SIGNALS

    missing = [kind for kind in (*ERRORS, *SIGNALS) if not totals.tallies.get(kind)]
    return f"no case met {', '.join(missing)}" if totals.count >= MANY and missing else ""


TASK = Task(
    promise="If a writer is killed or its system calls fail, it leaves no incomplete file and says why",
    oracle="the files before and after, the error, and a second run without a fault",
    unit="points of failure",
    target=1_000,
    prepare=prepare,
    describe=describe,
    doubt=doubt,
)
