"""Two warm processes, which open the files of the collected cases ahead of the tests."""

from __future__ import annotations

import os
import tempfile
import threading
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import pytest

from .case import Case
from .watched import STATED_SECONDS, Ending, Watched

PROCESSES = 2


class Endings:
    """How cases end, each opened once."""

    def __init__(self) -> None:
        self._local = threading.local()
        self._watched: list[Watched] = []
        self._pool = ThreadPoolExecutor(PROCESSES)
        self._futures: dict[tuple[str, bool], Future[Ending]] = {}

    def begin(self, case: Case, program: bool) -> Future[Ending]:
        """Opens a case's file as soon as a process is free."""
        key = case.id, program
        if key not in self._futures:
            self._futures[key] = self._pool.submit(self._open, case, program)
        return self._futures[key]

    def _open(self, case: Case, program: bool) -> Ending:
        if not hasattr(self._local, "watched"):
            self._local.watched = Watched()
            self._watched.append(self._local.watched)
        with tempfile.TemporaryDirectory(prefix="hostile-") as folder:
            case.write(Path(folder))
            return self._local.watched.open(case.entrance, Path(folder, case.file), program)

    def list_slow(self) -> list[str]:
        """Those above the stated time."""
        done = [(key, future.result()) for key, future in self._futures.items() if future.done()]
        return [
            f"{ending.seconds:.1f} s of processor time: {name}{', command line' if program else ''}"
            for (name, program), ending in done
            if ending.seconds > STATED_SECONDS
        ]

    def close(self) -> None:
        self._pool.shutdown(cancel_futures=True)
        for each in self._watched:
            each.close()


@pytest.fixture(scope="session")
def endings(request: pytest.FixtureRequest) -> Iterator[Endings]:
    made = Endings()
    if "PYTEST_XDIST_WORKER" not in os.environ:
        for item in request.session.items:
            settings = getattr(getattr(item, "callspec", None), "params", {})
            if isinstance(settings.get("hostile_case"), Case):
                made.begin(settings["hostile_case"], settings["by_program"])
    yield made
    made._pool.shutdown(cancel_futures=True)
    reporter = request.config.pluginmanager.get_plugin("terminalreporter")
    for line in made.list_slow():
        reporter.write_line(f"\nhostile input, {line}")
    made.close()
