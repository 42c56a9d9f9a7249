from __future__ import annotations

from pathlib import Path

import check_sizes
import pytest


def write(root: Path, name: str, text: str) -> None:
    path = root / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def function_of(lines: int, docstring: int = 0) -> str:
    """A function of so many lines beside its docstring."""
    said = (
        f'    """Says.\n{"more" * 3}\n' + "\n" * (docstring - 3) + '    """\n' if docstring else ""
    )
    return "def f():\n" + said + "    x = 1\n" * (lines - 1)


def test_short_modules_and_functions_pass(tmp_path: Path):
    write(tmp_path, "python/voxshell/world.py", function_of(80) + "\n" * 340)
    write(tmp_path, "studies/voxshell_studies/ball.py", function_of(80) + "\n" * 1000)
    assert check_sizes.check(tmp_path) == []


def test_a_docstring_does_not_count(tmp_path: Path):
    write(tmp_path, "python/voxshell/world.py", function_of(80, docstring=60))
    assert check_sizes.check(tmp_path) == []


@pytest.mark.parametrize("package", check_sizes.PACKAGES)
def test_a_long_function_is_named(tmp_path: Path, package: str):
    write(tmp_path, f"{package}/part.py", "x = 1\n" + function_of(81, docstring=10))
    [line] = check_sizes.check(tmp_path)
    assert line.startswith(f"{package}/part.py:2: f has 81 lines without its docstring")


def test_a_long_module_of_the_product_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    write(tmp_path, "python/voxshell/world.py", "x = 1\n" * 421)
    assert check_sizes.main([str(tmp_path)]) == 1
    assert capsys.readouterr().out.startswith("python/voxshell/world.py:1: has 421 lines")


def test_the_packages_pass():
    assert check_sizes.main([]) == 0
