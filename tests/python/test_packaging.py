"""What packages are made of, as far as it can be told without making one (`./dev wheel` does)."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import voxshell as vx

ROOT = Path(__file__).parents[2]


def run(code: str) -> str:
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60
    )
    assert result.returncode == 0, result.stderr
    return result.stdout.strip()


def test_command_line_starts_without_viewer_plotting_and_cluster():
    heavy = ("viser", "matplotlib", "dask", "distributed", "pyarrow", "scipy", "PIL")
    found = run(f"import sys, voxshell.cli; print([n for n in {heavy} if n in sys.modules])")
    assert found == "[]"


def test_completion_is_installed_for_a_shell_and_knows_the_commands(tmp_path):
    environment = {**os.environ, "HOME": str(tmp_path)}
    install = "from voxshell.cli import main; main(['--install-completion', '--shell', 'bash'])"
    subprocess.run([sys.executable, "-c", install], env=environment, check=True, timeout=60)
    [script] = (tmp_path / ".local/share/bash-completion/completions").iterdir()
    ask = (
        f"source {script}; COMP_WORDS=(voxshell q); COMP_CWORD=1; "
        "$(complete -p voxshell | sed 's/.*-F \\([^ ]*\\).*/\\1/') voxshell q voxshell; "
        'echo "${COMPREPLY[@]}"'
    )
    said = subprocess.run(["bash", "-c", ask], capture_output=True, text=True, timeout=60)
    assert said.stdout.split() == ["query"], said


WITHOUT_STUDIES = """
import importlib.metadata
import sys
sys.modules["voxshell_studies"] = None
importlib.metadata.entry_points = lambda **_: ()
"""


def test_package_works_without_the_studies():
    import_all = """
import importlib, pkgutil, voxshell
for module in pkgutil.walk_packages(voxshell.__path__, "voxshell."):
    importlib.import_module(module.name)
print(len(sys.modules) > 100)
"""
    assert run(WITHOUT_STUDIES + import_all) == "True"


@pytest.mark.parametrize("command", [["reproduce", "all", "--quick"], ["simulate", "drop"]])
def test_commands_of_the_studies_say_what_to_install(command):
    code = f"{WITHOUT_STUDIES}\nfrom voxshell.cli import main\nmain({command})"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert ended.returncode == 1
    said = " ".join(ended.stderr.split())
    assert "run pip install ./studies;" in said
    assert (ROOT / "studies/pyproject.toml").is_file()
    assert (
        "pip install --find-links build/dist voxshell-studies" in said
    )  # where ./dev wheel puts it


def test_both_packages_have_one_version():
    studies = (ROOT / "studies/pyproject.toml").read_text()
    assert f'\nversion = "{vx.__version__}"\n' in studies


def test_version_stands_in_one_place():
    [version] = re.findall(
        r"project\(voxshell VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()
    )
    assert vx.__version__ == version
    for name in ("pyproject.toml", "CITATION.cff", "python/voxshell/__init__.py", "dev"):
        assert version not in (ROOT / name).read_text(), name


def test_licenses_of_what_wheels_carry_are_there():
    texts = {path.stem: path.read_text() for path in (ROOT / "licenses").glob("*.txt")}
    assert texts.keys() == {"bullet", "nanobind", "robin-map"}
    for name, text in texts.items():
        assert "Copyright" in text, name
    assert "licenses/*.txt" in (ROOT / "pyproject.toml").read_text()


@pytest.mark.parametrize(
    "file", sorted((ROOT / "tools").glob("requirements*.txt")), ids=lambda f: f.stem
)
def test_tools_are_pinned_with_digests(file):
    group = file.stem.removeprefix("requirements").removeprefix("-") or "run"
    locked = (ROOT / f"tools/locked/{group}.txt").read_text()
    entries = re.findall(r"^([a-z0-9-]+)==(\S+)[^\n]*\\\n +--hash=sha256:", locked, re.MULTILINE)
    assert len(entries) == len(re.findall(r"^[a-z]", locked, re.MULTILINE))
    constraints = (ROOT / "tools/constraints.txt").read_text().splitlines()
    versions = {line.partition(" ;")[0] for line in constraints if "==" in line}
    assert {f"{name}=={version}" for name, version in entries} <= versions
    for line in file.read_text().splitlines():
        if line and not line.startswith("#"):
            assert line.partition(";")[0].strip() in {name for name, _ in entries}
