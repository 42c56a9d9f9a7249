"""Running parts: on all cores, one at a time if they are timed, or on a Dask cluster."""

from __future__ import annotations

import multiprocessing
import os
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeVar

from voxshell.errors import MissingExtraError, SettingsError, VoxshellError

from voxshell_studies.part import Outcome, Part, compute_fingerprint, compute_part
from voxshell_studies.workers import begin_worker, starting_workers

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from voxshell_studies.store import Store

    Done = Callable[[Part], object]

Item = TypeVar("Item")
Result = TypeVar("Result")


class RunError(VoxshellError, RuntimeError):
    """A part of an experiment failed; the message says which one and why."""


def run_parts(
    work: Sequence[tuple[Store, Part]],
    *,
    jobs: int | None = None,
    scheduler: str | None = None,
    done: Done | None = None,
) -> None:
    """Compute the unfinished parts and store them as they finish.

    Untimed parts come first, on all cores or on a cluster. Timed ones follow, one at a time, each
    in a separate process on this machine.

    Args:
        work: Parts, and the store of each.
        jobs: Processes for untimed parts; one per core by default.
        scheduler: Address of a Dask scheduler, such as "tcp://10.0.0.1:8786", for untimed parts.
        done: Called with each part when it is stored.

    Raises:
        RunError: A part failed.
        SettingsError: The cluster cannot be reached, or runs other code.
        MissingExtraError: A cluster is requested, but Dask is not installed.
    """
    missing = [(store, part) for store, part in work if not store.has(part)]
    # Long parts first, so that no core waits for a last long one.
    missing.sort(key=lambda each: -each[1].cost)
    for untimed_store, part, outcome in _compute(missing, jobs, scheduler):
        untimed_store.put(part, outcome)
        if done is not None:
            done(part)


def run_each(
    function: Callable[[Item], Result], items: Sequence[Item], jobs: int | None = None
) -> Iterator[Result]:
    """Yield a function's result for each item, in order, computed in as many processes as useful.

    Args:
        function: A function at a module's top level.
        items: Its arguments.
        jobs: Processes; one per core by default.

    Raises:
        RunError: A process was killed.
    """
    count = min(_count_jobs(jobs), len(items))
    if count <= 1:
        yield from map(function, items)
        return
    with _open_pool(count) as pool:
        with starting_workers():
            futures = [pool.submit(function, item) for item in items]
        for future in futures:
            yield future.result()


def _count_jobs(jobs: int | None) -> int:
    return len(os.sched_getaffinity(0)) if jobs is None else jobs


def _compute(
    missing: list[tuple[Store, Part]], jobs: int | None, scheduler: str | None
) -> Iterator[tuple[Store, Part, Outcome]]:
    untimed = [(store, part) for store, part in missing if not part.timed]
    timed = [(store, part) for store, part in missing if part.timed]
    if untimed and scheduler is not None:
        yield from _compute_on_cluster(untimed, scheduler)
    elif untimed:
        yield from _compute_here(untimed, min(_count_jobs(jobs), len(untimed)))
    if timed:
        yield from _compute_here(timed, 1)


def _compute_here(
    work: list[tuple[Store, Part]], jobs: int
) -> Iterator[tuple[Store, Part, Outcome]]:
    with _open_pool(jobs) as pool:
        with starting_workers():
            futures = {pool.submit(compute_part, part): (store, part) for store, part in work}
        for future in as_completed(futures):
            store, part = futures.pop(future)
            try:
                outcome = future.result()
            except BrokenProcessPool:
                raise  # the pool describes this error itself
            except Exception as error:
                raise RunError(f"{part.name}: {type(error).__name__}: {error}") from error
            yield store, part, outcome


@contextmanager
def _open_pool(jobs: int) -> Iterator[ProcessPoolExecutor]:
    """Yield a pool that ends at once if an error or an interrupt leaves the block.

    Raises:
        RunError: A process was killed, even before all work was handed out.
    """
    before = set(multiprocessing.active_children())
    # Forking would copy threads of Bullet's and our builds in arbitrary states.
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(jobs, mp_context=context, initializer=begin_worker)
    try:
        yield pool
    except BaseException as error:
        for process in set(multiprocessing.active_children()) - before:
            process.terminate()
        # The pool would wait for a worker's incomplete result as long as a process can write. It
        # has no
        # public way to say that none can; this private one exists in Python 3.10 to 3.13.
        results: Any = pool._result_queue
        results._writer.close()
        # Without waiting, the pool's thread and Python's exit would conflict over a closed pipe.
        pool.shutdown(cancel_futures=True)
        if isinstance(error, BrokenProcessPool):
            raise RunError("a worker process was killed; rerun the command to resume") from error
        raise
    pool.shutdown()


def _compute_on_cluster(
    work: list[tuple[Store, Part]], address: str
) -> Iterator[tuple[Store, Part, Outcome]]:
    try:
        from distributed import Client
        from distributed import as_completed as completed
    except ImportError as error:
        raise MissingExtraError(
            "a cluster needs Dask: pip install voxshell-studies[dask]"
        ) from error
    try:
        client = Client(address, timeout=5)
    except (OSError, ValueError) as error:
        raise SettingsError(f"no Dask scheduler answers at {address}: {error}") from error
    with client:
        fingerprints: Any = client.run(compute_fingerprint)
        _check_workers(fingerprints, address)
        futures = {
            client.submit(compute_part, part, key=f"{part.name}-{part.address}", pure=False): each
            for each in work
            for part in [each[1]]
        }
        for future in completed(list(futures)):
            store, part = futures.pop(future)
            try:
                outcome = future.result()
            except Exception as error:
                raise RunError(f"{part.name}: {type(error).__name__}: {error}") from error
            yield store, part, outcome


def _check_workers(fingerprints: dict[str, str], address: str) -> None:
    """Refuse workers whose results could differ."""
    if not fingerprints:
        raise SettingsError(f"the scheduler at {address} has no workers; start some first")
    other = sorted(name for name, code in fingerprints.items() if code != compute_fingerprint())
    if other:
        raise SettingsError(
            f"{len(other)} of {len(fingerprints)} workers run another build of voxshell "
            f"(first {other[0]}); install the same one everywhere"
        )
