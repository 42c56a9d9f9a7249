#!/usr/bin/env python3
"""Tries a wheel for another processor under qemu: its world must end with the same bits as that of this one's.

usage: tools/check_emulated_wheel.py WHEEL OWN CONSTRAINTS ROOT

OWN is the wheel for this processor and the Python that runs this script. ROOT is a Debian for the other processor
with a Python and its pip (tools/unpack_debian.sh). That pip installs WHEEL, with packages for its processor,
into a temporary folder; both wheels collide two meshes and simulate them. Fails if WHEEL has a fault
that tools/check_wheel.py finds without installing it, if pip refuses it, or if the worlds end differently.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from check_wheel import SCRIPT, find_fault, install, make_environment


def main(arguments: list[str]) -> int:
    """The command line; returns the exit code."""
    wheel, own, constraints, root = (Path(argument).resolve() for argument in arguments)
    fault = find_fault(wheel)
    if fault:
        print(fault)
        return 1
    python = emulated_python(wheel, root)
    [pip] = root.glob("usr/share/python-wheels/pip-*.whl")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve()
        here = [str(make_environment(folder / "env", own, constraints)), "-I"]
        packages = folder / "packages"
        command = install([*python, str(pip / "pip")], constraints)
        # To write the bytecode of all packages takes half a minute under qemu.
        command += ["--no-compile", "--target", str(packages)]
        subprocess.run([*command, str(wheel)], check=True)
        try:
            said = _run([*python, str(packages / "bin/voxshell"), "--version"], folder, packages)
            if said not in wheel.name:
                raise RuntimeError(f"voxshell --version said {said}")
            end = _run([*here, "-c", SCRIPT], folder)
            emulated_end = _run([*python, "-c", SCRIPT], folder, packages)
        except RuntimeError as error:
            print(error)
            return 1
    if emulated_end != end:
        print(f"the world does not end as with {own.name}:\n{emulated_end}\n{end}")
        return 1
    size = wheel.stat().st_size / 1e6
    print(f"{wheel.name}: {size:.2f} MB, its world ends with the same bits under qemu")
    return 0


def emulated_python(wheel: Path, root: Path) -> list[str]:
    """The command that runs the Python of `root` on the wheel's processor."""
    [processor] = re.findall(r"linux[0-9_]*_([a-z]\w*)$", wheel.stem)
    [python] = root.glob("usr/bin/python3.[0-9]*[0-9]")
    return [f"qemu-{processor}", "-L", str(root), str(python), "-s"]


def _run(command: list[str], folder: Path, packages: Path | None = None) -> str:
    """The last line that the command prints, which sees nothing of this checkout, but `packages`."""
    environment = {"PATH": os.defpath, "HOME": str(folder), "LANG": "C.UTF-8"}
    if packages:
        environment["PYTHONPATH"] = str(packages)
    result = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=600
    )
    if result.returncode != 0:
        raise RuntimeError(f"{command[0]}: exit code {result.returncode}\n{result.stderr}")
    return result.stdout.splitlines()[-1]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
