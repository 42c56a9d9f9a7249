from __future__ import annotations

from pathlib import Path

import check_tests_mirror
import pytest
from trees import write_tree

CLEAN = {
    "core/src/field/grid.cpp": "int f(int a) { return a < 0 ? -a : a; }\n",
    "tests/cpp/core/field/grid_test.cpp": "",
    "core/src/field/constants.cpp": "// if, for\nint x = 1;\n",
    "bullet/src/hull.cpp": "void f() { for (;;) {} }\n",
    "tests/cpp/bullet/hull_test.cpp": "",
    "python/voxshell/__init__.py": "if True:\n    pass\n",
    "python/voxshell/model/shell.py": "x = 1 if True else 2\n",
    "tests/python/model/test_shell.py": "",
    "python/voxshell/model/parts.py": (
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import os\nx = 1\n"
    ),
    "studies/voxshell_studies/ball.py": "for _ in range(2):\n    pass\n",
    "tests/python/studies/test_ball.py": "",
}


def test_what_has_its_test_passes(tmp_path: Path):
    write_tree(tmp_path, CLEAN)
    assert check_tests_mirror.check(tmp_path) == []


@pytest.mark.parametrize(
    ("source", "test"),
    [
        ("core/src/field/grid.cpp", "tests/cpp/core/field/grid_test.cpp"),
        ("bullet/src/hull.cpp", "tests/cpp/bullet/hull_test.cpp"),
        ("python/voxshell/model/shell.py", "tests/python/model/test_shell.py"),
        ("studies/voxshell_studies/ball.py", "tests/python/studies/test_ball.py"),
    ],
)
def test_what_has_none_is_named_with_the_file_to_write(tmp_path: Path, source: str, test: str):
    write_tree(tmp_path, CLEAN)
    (tmp_path / test).unlink()
    line = f"{source}:1: has no test file of its own: write {test}"
    assert check_tests_mirror.check(tmp_path) == [line]
    write_tree(tmp_path, {check_tests_mirror.LISTED: f"# excused\n{source}\n"})
    assert check_tests_mirror.check(tmp_path) == []


def test_the_list_of_excused_files_must_shrink(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    listed = "python/voxshell/model/shell.py\npython/voxshell/model/none.py\n"
    write_tree(tmp_path, {**CLEAN, check_tests_mirror.LISTED: listed})
    assert check_tests_mirror.main([str(tmp_path)]) == 1
    assert capsys.readouterr().out.splitlines() == [
        "tests/without_own_tests.txt:1: python/voxshell/model/shell.py has one; remove its line",
        "tests/without_own_tests.txt:1: python/voxshell/model/none.py is gone; remove its line",
    ]


def test_this_repository_passes():
    assert check_tests_mirror.main([]) == 0
