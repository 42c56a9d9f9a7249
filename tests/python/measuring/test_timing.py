from __future__ import annotations

import os

import pytest
from voxshell.measuring.timing import pinned


def test_one_core_within_the_block_and_all_after_it():
    before = os.sched_getaffinity(0)
    with pinned():
        assert os.sched_getaffinity(0) == {max(before)}
    assert os.sched_getaffinity(0) == before


def test_all_cores_after_a_failure():
    before = os.sched_getaffinity(0)
    with pytest.raises(KeyError), pinned():
        raise KeyError
    assert os.sched_getaffinity(0) == before


def test_nothing_happens_where_the_system_cannot(monkeypatch: pytest.MonkeyPatch):
    before = os.sched_getaffinity(0)
    monkeypatch.delattr(os, "sched_setaffinity")
    with pinned():
        assert os.sched_getaffinity(0) == before
