"""What is written while system calls fail, or between two of which the writer is killed."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from pathlib import Path

import killed_commands
import pytest
from write_faults import Fault, Host, NoCompilerError

QUICK = (1, 2, 3, 5, 8, 13, 21, 34, 55, 89)
"""Calls that fail: the soak tries all."""
SLOW = (1, 15, 60)


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Host]:
    try:
        host = Host(tmp_path_factory.mktemp("writers"))
    except NoCompilerError as lack:
        pytest.skip(str(lack))
    yield host
    host.close()


def fail_at(host: Host, writer: str, numbers: tuple[int, ...], over: bool, *fault: object) -> int:
    """Lets calls fail until the writer makes fewer; returns how many failed."""
    for count, number in enumerate(numbers):
        if not host.run(writer, Fault(number, *fault), over=over):
            return count
    return len(numbers)


@pytest.mark.parametrize(
    ("error", "lasts"), [("ENOSPC", True), ("EIO", False), ("EROFS", True), ("SIGKILL", False)]
)
@pytest.mark.parametrize("writer", ["Model.save", "cache", "cache of convex parts", "part"])
def test_a_writer_leaves_nothing_torn_and_says_why(
    host: Host, writer: str, error: str, lasts: bool
):
    assert fail_at(host, writer, QUICK, True, error, lasts, lasts) >= 2


@pytest.mark.parametrize("writer", ["JSON", "picture", "animation", "figure", "report"])
def test_a_full_disk_is_named_by_every_writer(host: Host, writer: str):
    assert fail_at(host, writer, QUICK[::2], False, "ENOSPC", True) >= 2


@pytest.mark.parametrize("command", ["voxshell build", "voxshell simulate", "voxshell reproduce"])
def test_a_command_on_a_bad_disk_ends_with_one_line(host: Host, command: str):
    assert fail_at(host, command, SLOW, False, "EIO", True) >= 2


def test_a_pickled_model_needs_no_disk(host: Host):
    """It was written to a temporary folder."""
    assert host.run("pickled model", Fault(1, "ENOSPC"), over=False) == ""


@pytest.mark.parametrize("writer", ["Model.save", "cache", "part", "JSON"])
@pytest.mark.parametrize("lasts", [False, True])
def test_a_lock_that_fails_once_costs_nothing(host: Host, writer: str, lasts: bool):
    """A file that could not be locked was swept as that of a dead writer once locks worked again, by
    its own writer too; and the lock of a key stayed in the cache."""
    assert fail_at(host, writer, (1, 2, 3), True, "ENOLCK", lasts) >= 1


def test_disks_that_know_no_locks_are_written_to(host: Host):
    assert fail_at(host, "part", (1, 2), False, "ENOLCK", True) == 2


@pytest.mark.parametrize(
    ("name", "seconds", "number"),
    [
        ("build", 1.5, signal.SIGTERM),
        ("simulate", 1.5, signal.SIGKILL),
        ("reproduce", 3.0, signal.SIGKILL),
    ],
)
def test_a_killed_command_is_run_again(tmp_path: Path, name: str, seconds: float, number: int):
    folder = tmp_path / "folder"
    folder.mkdir()
    command = killed_commands.list_commands(tmp_path)[name](folder)
    killed_commands.kill(command, folder, seconds, number)
    killed_commands.run(command, folder)
