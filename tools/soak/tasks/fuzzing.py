"""Executions of the fuzz targets, built with clang, AddressSanitizer and UndefinedBehaviorSanitizer.

Each case is some seconds of libFuzzer. The first starts from fuzz/seeds; what is worth keeping stays in
build/fuzz/corpus, where the next starts and where `./dev fuzz --keep` takes it.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

from soak.task import CORE, Check, Outcome, Task, Totals, UnavailableError

ROOT = Path(__file__).resolve().parents[3]
SECONDS = 5  # a case
LARGEST = 200_000  # bytes of a file; the targets start from one of 19,000


def fuzz(target: str) -> Check:
    program = ROOT / f"build/fuzz/fuzz/voxshell_fuzz_{target}"
    if not program.is_file():
        clang = "" if shutil.which("clang++") else "install clang, then "
        raise UnavailableError(f"{program.name} is not built; {clang}run ./dev fuzz 1 to build it")
    corpus, found = ROOT / "build/fuzz/corpus" / target, ROOT / "build/fuzz/found"
    for folder in (corpus, found):
        folder.mkdir(parents=True, exist_ok=True)

    def check(case: int) -> Outcome:
        run = subprocess.run(
            [
                *(str(program), f"-seed={case + 1}", f"-max_len={LARGEST}", "-timeout=2"),
                *(f"-max_total_time={SECONDS}", "-print_final_stats=1", "-rss_limit_mb=2048"),
                *(f"-artifact_prefix={found}/", str(corpus)),
            ],
            capture_output=True,
            text=True,
            check=False,
            errors="replace",
        )
        assert run.returncode == 0, f"{program.name} failed: {run.stderr[-1500:]}"
        executions = re.search(r"number_of_executed_units: (\d+)", run.stderr)
        coverage = re.findall(r"cov: (\d+)", run.stderr)
        assert executions, f"{program.name} says nothing of executions: {run.stderr[-500:]}"
        return Outcome(int(executions[1]), {}, {"coverage": float(coverage[-1]) if coverage else 0})

    return check


def describe(totals: Totals) -> str:
    return f"{totals.peaks['coverage']:,.0f} edges of the code reached"


def make_task(target: str, promise: str, executions: float) -> Task:
    return Task(
        promise=promise,
        oracle="libFuzzer with ASan and UBSan",
        unit="executions",
        target=executions,
        prepare=lambda: fuzz(target),
        describe=describe,
        sources=(*CORE, "fuzz"),
    )


PARSING = make_task(
    "model_parsing", "A damaged model file is read as a valid model or refused", 100_000_000
)
QUERIES = make_task(
    "model_file", "Queries of a model from a damaged file read nothing beyond it", 10_000_000
)
