from __future__ import annotations

import pytest

COMMANDS = ("build", "info", "query", "bench", "simulate", "simulate drop")


@pytest.mark.parametrize("command", COMMANDS)
def test_help_teaches_by_example(voxshell, command):
    ended = voxshell(*command.split(), "--help")
    assert (ended.code, ended.err) == (0, "")
    assert f"\n voxshell {command} " in ended.out
    assert "--json" in ended.out
    assert max(map(len, ended.out.splitlines())) <= 80


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
