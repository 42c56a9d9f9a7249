"""What a measurement was made on."""

from __future__ import annotations

import os
from datetime import datetime, timezone
from pathlib import Path

from voxshell.measuring.environment import describe_environment, read_cpuinfo

ROOT = Path(__file__).resolve().parent.parent
_VECTOR_SETS = ("sse4_2", "avx", "avx2", "fma", "avx512f", "avx512vl", "asimd", "sve")


def describe_machine() -> dict[str, object]:
    """The environment, and what times depend on besides, ready for JSON."""
    flags = set(read_cpuinfo("flags").split()) | set(read_cpuinfo("Features").split())
    return {
        **describe_environment(),
        "date": datetime.now(timezone.utc).isoformat(timespec="seconds"),
        "vector_sets": [name for name in _VECTOR_SETS if name in flags],
        "forced_isa": os.environ.get("VOXSHELL_FORCE_ISA"),
        "load": os.getloadavg()[0],
    }
