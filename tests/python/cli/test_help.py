from __future__ import annotations

import pytest

TELLING = ("build", "info", "query", "bench", "simulate", "simulate drop", "reproduce peers")
"""Commands that answer programs, too."""


@pytest.mark.parametrize("command", ["", *TELLING, "view", "reproduce", "cache"])
def test_help_teaches_by_example(voxshell, command):
    ended = voxshell(*command.split(), "--help")
    assert (ended.code, ended.err) == (0, "")
    assert ended.out.startswith(f"Usage: voxshell {command}".strip() + " ")
    assert f"\n voxshell {command}".rstrip() + " " in ended.out
    assert ("--json" in ended.out) == (command in TELLING)
    assert max(map(len, ended.out.splitlines())) <= 80
    for odd in ("[ARGS]", "None", "[default: (", "True", "False", "empty"):
        assert odd not in ended.out


@pytest.mark.parametrize("command", ["", "reproduce", "cache", "reproduce ball", "reproduce peers"])
def test_all_that_help_lists_is_described(voxshell, command):
    ended = voxshell(*command.split(), "--help")
    assert ended.code == 0
    lines = [line for line in ended.out.splitlines() if line.startswith("│ ")]
    assert len(lines) >= 4
    for line in lines:
        words = line.strip("│ ").partition("[default")[0].split()
        told = [word for word in words if not word.startswith("-") and not word.isupper()]
        assert line.startswith("│   ") or len(told) >= 2, line
