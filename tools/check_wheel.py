#!/usr/bin/env python3
"""Checks that a wheel stands on its own: in a fresh environment, with a Bullet that nobody else sees.

usage: tools/check_wheel.py WHEEL CONSTRAINTS

Installs the wheel, and pybullet if it has a wheel for this Python, into a new environment in a temporary
folder, and there collides two meshes and simulates them: alone, beside pybullet, and beside the system's
Bullet where that is installed,
with all symbols of these in everybody's sight. Fails if the world does not end the same in each
case, if the wheel brings or loads shared libraries of Bullet, if a module shows other symbols than the one
that Python calls, if Bullet calls functions of the C library whose last bits differ between processors,
if the wheel is 6 MB or larger, if its bill of materials or a license of what is on it
is missing, or if it brings packages whose licenses ask something of programs that use them.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
import venv
import zipfile
from pathlib import Path

MOST_BYTES = 6_000_000
# Of what `pip install voxshell` brings: what asks nothing of programs that use it.
LICENSES = re.compile(
    r"\b(MIT|0?BSD|Apache|ISC|PSF|Python Software Foundation|Zlib)\b", re.IGNORECASE
)
TELL_LICENSES = """
from importlib.metadata import distributions
for package in distributions():
    told = [package.metadata["License-Expression"], package.metadata["License"]]
    told += [c for c in package.metadata.get_all("Classifier", []) if c.startswith("License")]
    print(package.name, "".join(" " + str(text).split("\\n")[0] for text in told if text))
"""
# Functions of the C library whose last bits differ between processors: our own Bullet brings its own.
REPLACED = set(
    re.findall(
        r"set\(replaced ([a-z0-9 ]+)\)",
        (Path(__file__).parents[1] / "cmake/pinned_bullet.cmake").read_text(),
    )[0].split()
)
# What is in the process with the world: a script's argument each.
COMPANY = ("nobody", "pybullet before", "pybullet after", "the system's")

SCRIPT = Path(__file__).with_name("try_installed.py").read_text()


def main(arguments: list[str]) -> int:
    """The command line; returns the exit code."""
    wheel, constraints = Path(arguments[0]).resolve(), Path(arguments[1]).resolve()
    fault = find_fault(wheel)
    if fault:
        print(fault)
        return 1
    with tempfile.TemporaryDirectory() as folder:
        python = make_environment(Path(folder).resolve() / "env", wheel, constraints)
        company_here = COMPANY if _add_pybullet(python, constraints) else ("nobody", "the system's")
        # Nothing of this checkout, and no settings that could bring another copy.
        environment = {"PATH": os.defpath, "HOME": folder, "LANG": "C.UTF-8"}
        licenses = subprocess.run(
            [str(python), "-I", "-c", TELL_LICENSES], check=True, capture_output=True, text=True
        ).stdout.splitlines()
        unknown = [line for line in licenses if not LICENSES.search(line)]
        if unknown:
            print("packages that come with it have other licenses: " + "; ".join(unknown))
            return 1
        results = set()
        for company in company_here:
            command = [str(python), "-I", "-c", SCRIPT, company]
            result = subprocess.run(
                command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300
            )
            if result.returncode != 0:
                print(f"beside {company}: exit code {result.returncode}\n{result.stderr}")
                return 1
            results.add(result.stdout.splitlines()[-1])
        if len(results) != 1:
            print("the world does not end the same beside other builds of Bullet")
            return 1
        told = subprocess.run(
            [str(python.with_name("voxshell")), "--version"], env=environment, capture_output=True
        )
        if told.returncode != 0 or told.stdout.decode().strip() not in wheel.name:
            print(f"voxshell --version said {told.stdout!r} {told.stderr!r}")
            return 1
    version = f"Python {sys.version_info.major}.{sys.version_info.minor}"
    others = f" and beside {', '.join(company_here[1:])}"
    print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.2f} MB, works with {version} alone{others}")
    return 0


def find_fault(wheel: Path) -> str | None:
    """What is wrong with the wheel's files, as far as they tell without being installed."""
    size = wheel.stat().st_size
    if size >= MOST_BYTES:
        return f"{wheel.name} has {size / 1e6:.1f} MB; it must stay below {MOST_BYTES / 1e6:g} MB"
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    modules = [n for n in names if re.fullmatch(r"voxshell/_(core|bullet)\.[^/]*\.so", n)]
    foreign = [n for n in names if n.endswith((".a", ".h", ".cmake", ".pc")) or ".so" in n]
    foreign = sorted(set(foreign) - set(modules))
    if foreign:
        return f"{wheel.name} holds what is no part of the package: {', '.join(foreign)}"
    lacking = _lacking_licenses(wheel)
    if lacking:
        return f"{wheel.name} says nothing of {', '.join(lacking)}"
    for name in modules:
        shown = _symbols(wheel, name, "--defined-only")
        if shown != {"PyInit_" + Path(name).name.partition(".")[0]}:
            return f"{name} shows {len(shown)} symbols: {', '.join(sorted(shown)[:10])}"
        called = _symbols(wheel, name, "--undefined-only") & REPLACED
        if "_bullet." in name and called:
            return (
                f"{name} calls the C library, whose last bits differ: {', '.join(sorted(called))}"
            )
    return None


def _lacking_licenses(wheel: Path) -> list[str]:
    """Parts that do not have both an entry with a version in the bill of materials, and a license."""
    with zipfile.ZipFile(wheel) as archive:
        [bill] = [n for n in archive.namelist() if n.endswith("/sboms/voxshell.cdx.json")]
        parts = {part["bom-ref"]: part for part in json.loads(archive.read(bill))["components"]}
        names = [Path(name) for name in archive.namelist() if "/licenses/licenses/" in name]
        licenses = {name.stem for name in names if name.suffix == ".txt"}
    expected = {"bullet", "nanobind", "robin-map"}
    versioned = {
        name for name, part in parts.items() if re.fullmatch(r"\d+(\.\d+)+", part["version"])
    }
    return sorted((expected ^ versioned) | (expected ^ licenses))


def _symbols(wheel: Path, name: str, which: str) -> set[str]:
    """Names that a shared library in the wheel defines for others, or takes from them, without versions."""
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(wheel) as archive:
        library = archive.extract(name, folder)
        told = subprocess.run(
            ["nm", "--dynamic", which, library], check=True, capture_output=True, text=True
        )
    return {line.split()[-1].partition("@")[0] for line in told.stdout.splitlines()}


def make_environment(folder: Path, wheel: Path, constraints: Path) -> Path:
    """A new environment with the wheel; its interpreter."""
    venv.create(folder, with_pip=True, symlinks=True)
    python = folder / "bin" / "python"
    subprocess.run([*install([str(python), "-m", "pip"], constraints), str(wheel)], check=True)
    return python


def _add_pybullet(python: Path, constraints: Path) -> bool:
    """Whether pybullet has a wheel for this Python; to build it would take longer than all else."""
    pip = [str(python), "-m", "pip"]
    command = [*install(pip, constraints), "--only-binary", "pybullet", "pybullet"]
    return subprocess.run(command, capture_output=True).returncode == 0


def install(pip: list[str], constraints: Path) -> list[str]:
    """The command that has `pip` install what is appended."""
    quiet = ["--disable-pip-version-check", "--no-input", "--quiet"]
    return [*pip, "install", *quiet, "--constraint", str(constraints)]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
