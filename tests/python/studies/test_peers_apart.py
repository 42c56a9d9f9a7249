from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import pytest
import toy_peers
from voxshell_studies.peers.apart import Ending, run_apart


@pytest.fixture
def run(tmp_path):
    """Runs work; what it yielded, and how it ended."""

    def run(work, limit=60.0, **arguments):
        received = []
        ending = run_apart(work, arguments, received.append, limit=limit, log=tmp_path / "work.log")
        return received, ending

    return run


def test_everything_that_work_yields_is_received_in_order(run):
    assert run(toy_peers.count_up, count=5) == ([0, 1, 2, 3, 4], Ending("done"))


def test_files_that_libraries_leave_are_beside_the_log(run, tmp_path):
    assert run(toy_peers.leave_a_file) == ([str(tmp_path)], Ending("done"))
    assert (tmp_path / "LIBRARY_LOG.TXT").is_file()


def test_log_that_cannot_be_written_is_an_ending_that_names_it(run, tmp_path, capfd):
    """A traceback went to standard error, and the ending named nothing."""
    (tmp_path / "work.log").mkdir()
    received, ending = run(toy_peers.count_up, count=5)
    assert received == []
    assert ending.how == "failed"
    assert ending.reason.endswith(f"Is a directory: '{tmp_path}/work.log'")
    assert capfd.readouterr().err == ""


def test_crash_is_an_ending_that_names_the_signal(run):
    received, ending = run(toy_peers.abort)
    assert received == ["before"]
    assert ending.how == "failed"
    assert "crashed with SIGABRT (Fatal Python error: Aborted" in ending.reason


def test_process_that_leaves_is_an_ending_with_its_last_words(run):
    received, ending = run(toy_peers.print_and_leave)
    assert received == []
    assert ending == Ending("failed", "its process ended with code 3 (the disk is full)")


def test_work_that_hangs_is_killed_at_the_limit(run):
    start = time.monotonic()
    received, ending = run(toy_peers.sleep, limit=3.0)
    assert received == ["before"]
    assert ending == Ending("timed out", "killed after 3 s")
    assert time.monotonic() - start < 30.0


def test_library_that_hangs_at_the_end_keeps_nobody(run):
    start = time.monotonic()
    assert run(toy_peers.finish_and_hang) == (["all"], Ending("done"))
    assert time.monotonic() - start < 30.0


def test_work_ends_with_a_parent_that_is_killed(tmp_path):
    program = (
        "import sys; sys.path.insert(0, sys.argv[1])\n"
        "import pathlib, toy_peers\n"
        "from voxshell_studies.peers.apart import run_apart\n"
        "import multiprocessing\n"
        "def tell(message):\n"
        "    print(multiprocessing.active_children()[0].pid, flush=True)\n"
        "if __name__ == '__main__':\n"
        "    run_apart(toy_peers.sleep, {}, tell, limit=600.0, log=pathlib.Path(sys.argv[2]))\n"
    )
    script = tmp_path / "program.py"
    script.write_text(program)
    support = os.path.dirname(toy_peers.__file__)
    parent = subprocess.Popen(
        [sys.executable, script, support, tmp_path / "log"], stdout=subprocess.PIPE, text=True
    )
    assert parent.stdout is not None
    child = int(parent.stdout.readline())
    parent.send_signal(signal.SIGKILL)
    parent.wait()
    parent.stdout.close()
    deadline = time.monotonic() + 30.0
    while _runs(child) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not _runs(child)


def _runs(pid):
    try:
        with open(f"/proc/{pid}/stat") as stat:
            return stat.read().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False
