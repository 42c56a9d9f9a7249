from __future__ import annotations

import errno
import fcntl
import os
import threading
from pathlib import Path

import pytest
from voxshell.model.file_lock import FileLock


def test_one_holds_it_until_the_block_ends(tmp_path: Path):
    path = tmp_path / "key.lock"
    with FileLock(path) as first:
        assert first.try_acquire()
        with FileLock(path) as second:
            assert not second.try_acquire()
        assert path.exists()  # the second one did not hold it
    assert not path.exists()
    with FileLock(path) as third:
        assert third.try_acquire()


def test_one_at_a_time_of_many_threads(tmp_path: Path):
    inside, most, total = [], [], []

    def work() -> None:
        while len(total) < 200:
            with FileLock(tmp_path / "key.lock") as lock:
                if lock.try_acquire():
                    inside.append(1)
                    most.append(len(inside))
                    total.append(1)
                    inside.pop()

    threads = [threading.Thread(target=work) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert max(most) == 1
    assert len(total) >= 200


def test_where_there_can_be_none_the_system_says_why(tmp_path: Path):
    with pytest.raises(FileNotFoundError), FileLock(tmp_path / "none" / "key.lock") as lock:
        lock.try_acquire()


@pytest.mark.parametrize("was_there", [False, True])
def test_a_disk_without_locks_keeps_no_new_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, was_there: bool
):
    """Each model left an empty file behind, which nothing could remove without a lock."""

    def fail(*_: object) -> None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    path = tmp_path / "key.lock"
    if was_there:  # another process may hold it
        path.touch()
    monkeypatch.setattr(fcntl, "flock", fail)
    with pytest.raises(OSError, match="No locks"), FileLock(path) as lock:
        lock.try_acquire()
    assert path.exists() == was_there
