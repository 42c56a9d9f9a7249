"""What a measurement was made on."""

from __future__ import annotations

import os
import platform
import subprocess
from datetime import datetime, timezone
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
_VECTOR_SETS = ("sse4_2", "avx", "avx2", "fma", "avx512f", "avx512vl", "asimd", "sve")


def describe_machine() -> dict[str, object]:
    """Processor, system, commit and date, ready for JSON."""
    flags = set(_read_cpuinfo("flags").split()) | set(_read_cpuinfo("Features").split())
    return {
        "date": datetime.now(timezone.utc).isoformat(timespec="seconds"),
        "commit": _find_commit(),
        "cpu": _read_cpuinfo("model name") or platform.processor(),
        "cores": len(os.sched_getaffinity(0)),
        "vector_sets": [name for name in _VECTOR_SETS if name in flags],
        "forced_isa": os.environ.get("VOXSHELL_FORCE_ISA"),
        "system": platform.platform(),
        "load": os.getloadavg()[0],
    }


def _read_cpuinfo(field: str) -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return ""
    values = [line.split(":", 1)[1].strip() for line in lines if line.startswith(field)]
    return values[0] if values else ""


def _find_commit() -> str | None:
    """With "-dirty" where the checkout has changes; None outside of one."""
    try:
        result = subprocess.run(
            ["git", "describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"],
            cwd=ROOT,
            capture_output=True,
            text=True,
            timeout=10,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return result.stdout.strip()
