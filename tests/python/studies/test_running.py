from __future__ import annotations

import multiprocessing
import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import toy_parts
from voxshell.base.outputs import filling
from voxshell_studies import part as part_module
from voxshell_studies.part import Part, compute_part
from voxshell_studies.running import RunError, run_each, run_parts
from voxshell_studies.store import Store

SQUARES = Part("squares", toy_parts.squares, {"count": 5})


def test_parts_are_kept_whole_with_what_made_them(tmp_path):
    store = Store(tmp_path)
    store.put(SQUARES, compute_part(SQUARES))
    table = store.get(SQUARES)["numbers"]
    np.testing.assert_array_equal(table["square"], [0.0, 1.0, 4.0, 9.0, 16.0])
    assert table["n"].dtype == np.int64
    manifest = store.manifest(SQUARES)
    assert manifest["arguments"] == {"count": 5}
    assert manifest["environment"]["cpu"]
    assert manifest["environment"]["libraries"]["numpy"] == np.__version__
    assert [path.name for path in tmp_path.iterdir()] == [f"squares-{SQUARES.address}"]


def test_address_tells_settings_and_code_apart(monkeypatch):
    assert SQUARES.address == Part("other name", toy_parts.squares, {"count": 5}).address
    assert SQUARES.address != replace(SQUARES, arguments={"count": 6}).address
    assert SQUARES.address != replace(SQUARES, function=toy_parts.fail).address
    before = SQUARES.address
    monkeypatch.setattr(part_module, "compute_fingerprint", lambda: "other code")
    assert SQUARES.address != before


def test_uneven_columns_are_an_error():
    with pytest.raises(
        ValueError, match=r"columns of numbers differ in length: \{'a': 2, 'b': 3\}"
    ):
        compute_part(Part("uneven", toy_parts.uneven))


def test_finished_parts_are_not_run_again(tmp_path):
    store = Store(tmp_path / "store")
    parts = [
        Part(f"note-{i}", toy_parts.note, {"folder": str(tmp_path), "name": f"{i}"})
        for i in range(3)
    ]
    run_parts([(store, part) for part in parts[:2]], jobs=2)
    finished = []
    run_parts([(store, part) for part in parts], jobs=2, done=finished.append)
    assert finished == parts[2:]
    assert [len((tmp_path / f"{i}").read_text().splitlines()) for i in range(3)] == [1, 1, 1]


def test_timed_parts_run_alone_and_last(tmp_path):
    store = Store(tmp_path / "store")
    parts = [
        Part(
            f"note-{i}",
            toy_parts.note,
            {"folder": str(tmp_path), "name": "spans" if i % 2 else "untimed"},
            timed=bool(i % 2),
        )
        for i in range(6)
    ]
    run_parts([(store, part) for part in parts], jobs=2)
    spans = np.loadtxt(tmp_path / "spans")
    untimed = np.loadtxt(tmp_path / "untimed")
    assert len(set(spans[:, 2])) == 1  # one process
    assert (spans[1:, 0] >= spans[:-1, 1]).all()
    assert spans[0, 0] >= untimed[:, 1].max()


def test_failed_part_is_named(tmp_path):
    with pytest.raises(RunError, match="bad: ValueError: the ball is square"):
        run_parts([(Store(tmp_path), Part("bad", toy_parts.fail))], jobs=1)


def test_killed_worker_is_an_error_and_the_next_run_goes_on(tmp_path):
    store = Store(tmp_path / "store")
    work = [
        (store, SQUARES),
        (store, Part("deadly", toy_parts.die_once, {"folder": str(tmp_path)})),
    ]
    with pytest.raises(RunError, match="worker process was killed"):
        run_parts(work, jobs=1)
    run_parts(work, jobs=1)
    assert all(store.has(part) for _, part in work)


class SlowlyGiven(list):
    """Gives its second item when the process that read the first is dead, and so all are ended."""

    def __iter__(self):
        before = set(multiprocessing.active_children())
        yield self[0]
        patience = time.monotonic() + 60.0
        while set(multiprocessing.active_children()) - before:
            assert time.monotonic() < patience, "a worker lives on"
            time.sleep(0.01)
        yield from self[1:]


@pytest.mark.parametrize("given", [list, SlowlyGiven])
def test_worker_killed_while_work_is_handed_out_is_an_error(given):
    with pytest.raises(RunError, match="worker process was killed"):
        list(run_each(toy_parts.name_process, given([toy_parts.Deadly(), 1, 2]), 2))


def test_interrupt_amid_a_large_result_ends_the_run():
    """As it was once: half a result in the pipe of a dead worker was waited for in vain."""
    program = (
        "import toy_parts\n"
        "from voxshell_studies.running import run_each\n"
        "for _ in run_each(toy_parts.make_much, range(10), 2): raise KeyboardInterrupt\n"
    )
    folder = str(Path(toy_parts.__file__).parent)
    result = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": folder},
        stderr=subprocess.PIPE,
        text=True,
        timeout=60,
    )
    assert "KeyboardInterrupt" in result.stderr


@pytest.mark.parametrize("jobs", [1, 2])
def test_each_is_run_in_order_in_as_many_processes(jobs):
    made = list(run_each(toy_parts.name_process, [3, 2, 1, 0], jobs))
    assert [item for item, _ in made] == [3, 2, 1, 0]
    here = os.getpid()
    assert ({process for _, process in made} == {here}) == (jobs == 1)


def test_error_of_a_process_is_the_callers(tmp_path):
    with pytest.raises(ValueError, match="0 is too small"):
        list(run_each(toy_parts.refuse_zero, [1, 0], 2))


def test_what_a_killed_run_left_is_swept(tmp_path):
    store = Store(tmp_path)
    child = os.fork()
    if child == 0:
        with filling(store.place(SQUARES)):
            os._exit(0)
    os.waitpid(child, 0)
    assert len(list(tmp_path.iterdir())) == 1
    with filling(tmp_path / "of a living writer"):
        store.sweep()
        assert len(list(tmp_path.iterdir())) == 1
    assert [path.name for path in tmp_path.iterdir()] == ["of a living writer"]
