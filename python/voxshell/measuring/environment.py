"""The environment of a measurement."""

from __future__ import annotations

import os
import platform
import subprocess
from importlib import metadata
from pathlib import Path

import voxshell
from voxshell.simulation.world import BULLET_VERSION

_LIBRARIES = (
    "coacd",
    "coal",
    "manifold3d",
    "mujoco",
    "numpy",
    "trimesh",
    "vhacdx",
    "matplotlib",
    "pyarrow",
    "viser",
)


def describe_environment() -> dict[str, object]:
    """Return versions, machine and commit, ready for JSON."""
    return {
        "voxshell": voxshell.__version__,
        "commit": _find_commit(),
        "bullet": BULLET_VERSION,
        "python": platform.python_version(),
        "libraries": {name: _find_version(name) for name in _LIBRARIES},
        "system": platform.platform(),
        "cpu": read_cpuinfo("model name") or platform.processor(),
        "cores": len(os.sched_getaffinity(0)),
    }


def read_cpuinfo(field: str) -> str:
    """Return a field of the system's first processor; empty if it is unknown."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return ""
    values = [line.split(":", 1)[1].strip() for line in lines if line.startswith(field)]
    return values[0] if values else ""


def _find_commit() -> str | None:
    """Return the commit of the package's checkout, with "-dirty" if it has changes, or None."""
    try:
        result = subprocess.run(
            ["git", "describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"],
            cwd=Path(__file__).parent,
            capture_output=True,
            text=True,
            timeout=10,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return result.stdout.strip()


def _find_version(library: str) -> str | None:
    try:
        return metadata.version(library)
    except metadata.PackageNotFoundError:
        return None
