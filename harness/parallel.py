"""One parallel map for all wide work: processes on this machine, or an existing Dask cluster by its address.

Results are in the order of the items and identical either way; what a task does must depend on its item alone.
"""

from __future__ import annotations

import os
import signal
import threading
import time
import warnings
from collections.abc import Callable, Collection, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import copy_context
from functools import lru_cache
from itertools import islice
from typing import Any, TypeVar

from harness.errors import InputError, install

T = TypeVar("T")
R = TypeVar("R")


def default_workers() -> int:
    """Number of processes used when none is asked for: the cores this process may run on."""
    if hasattr(os, "sched_getaffinity"):
        return max(1, len(os.sched_getaffinity(0)))
    return max(1, os.cpu_count() or 1)


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Linear algebra of small matrices on one thread: handing it to several takes many times as long as doing it."""
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1, user_api="blas"):
        yield


MOST_THREADS = 4  # of one piece of work; more cores are better used by more pieces


def threads_allowed() -> int:
    """Threads that compiled code inside one piece of work may use: OMP_NUM_THREADS if set (workers here run with 1), else
    the cores, up to four."""
    stated = os.environ.get("OMP_NUM_THREADS", "").split(",")[0].strip()
    cores = default_workers()
    return max(1, min(int(stated) if stated.isdecimal() else MOST_THREADS, cores))


def meanwhile(threads: int, function: Callable[..., R], *arguments: Any) -> Callable[[], R]:
    """Begin a call on another thread, if there are two, and return what waits for its result (and raises what it raises).

    Worth it for what is mostly compiled code: of Python one thread runs at a time.
    """
    if threads < 2:
        return lambda: function(*arguments)
    return kept_threads("meanwhile", 1, os.getpid()).submit(copy_context().run, function, *arguments).result


@lru_cache(maxsize=8)
def kept_threads(what: str, count: int, process: int) -> ThreadPoolExecutor:
    """So many threads of this process for one kind of work, kept from call to call; a forked one has none of its parent's."""
    return ThreadPoolExecutor(count, thread_name_prefix=what)


def parallel_map(
    function: Callable[[T], R],
    items: Sequence[T],
    *,
    workers: int | None = None,
    dask: str | None = None,
    done: Callable[[int, R], None] | None = None,
) -> list[R]:
    """Apply a function to every item, on several processes.

    function: picklable, or of a module that workers can import. workers: processes on this machine, default all
    cores; 1 runs in this process. dask: address of a scheduler (``tcp://host:8786``), overrides ``workers``.
    done: called in this process with (index, result) as each result arrives, in order of arrival (progress, saving).
    Raises what the function raises; InputError if the address cannot be reached. Ctrl-C stops the workers.
    """
    results: dict[int, R] = {}
    for index, result in _stream(function, items, workers, dask):
        results[index] = result
        if done is not None:
            done(index, result)
    return [results[index] for index in range(len(items))]


def _stream(
    function: Callable[[T], R], items: Sequence[T], workers: int | None, dask: str | None
) -> Iterator[tuple[int, R]]:
    if dask is not None:
        return _on_cluster(function, items, dask)
    count = default_workers() if workers is None else workers
    if count < 1:
        raise InputError(f"{count} workers", mend="give a number of at least 1")
    if count == 1 or len(items) <= 1:
        return ((index, function(item)) for index, item in enumerate(items))
    return _on_processes(function, items, min(count, len(items)))


def _indexed(function: Callable[[Any], Any], index: int, item: Any) -> tuple[int, Any]:
    return index, function(item)


# One thread a process: nested threads of BLAS or numba would only fight over the same cores.
_ONE_THREAD = {f"{pool}_NUM_THREADS": "1" for pool in ("OMP", "OPENBLAS", "MKL", "NUMBA")}


@contextmanager
def _interrupts_ignored() -> Iterator[None]:
    """Processes started inside ignore Ctrl-C for good: it is this process's to handle, and it stops them."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _end_without(parent: int) -> None:
    """Let this worker end as soon as its parent has: one that was killed could not stop it, and nobody waits for its result."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    threading.Thread(target=watch, name="parent", daemon=True).start()


def _on_processes(function: Callable[[T], R], items: Sequence[T], count: int) -> Iterator[tuple[int, R]]:
    from concurrent.futures import FIRST_COMPLETED, wait

    from joblib.externals.loky import get_reusable_executor

    # A worker whose memory has grown is replaced by a fresh one; nothing is lost by that, and nobody needs to be warned.
    warnings.filterwarnings("ignore", message="A worker stopped while some jobs", category=UserWarning)
    waiting = enumerate(items)
    running: set[Future[tuple[int, R]]] = set()
    # Only what the workers can hold is handed out: a pool that is stopped with a queue of work stumbles over it.
    with _interrupts_ignored():
        executor = get_reusable_executor(
            max_workers=count, env=_ONE_THREAD, timeout=120, initializer=_end_without, initargs=(os.getpid(),)
        )
        for index, item in islice(waiting, count + 1):
            running.add(executor.submit(_indexed, function, index, item))
    try:
        while running:
            done, running = wait(running, return_when=FIRST_COMPLETED)
            for index, item in islice(waiting, len(done)):
                running.add(executor.submit(_indexed, function, index, item))
            for future in done:
                yield future.result()
    except BaseException:
        # Whatever went wrong (Ctrl-C included), no worker goes on computing for nobody.
        try:
            _passed_on(running)
        finally:
            executor.shutdown(wait=True, kill_workers=True)
        raise


def _passed_on(calls: Collection[Future[Any]], patience: float = 2.0) -> None:
    """Wait until all calls are with the workers: loky's manager ends in a KeyError of its own where it is stopped before.

    patience: longest wait [s], for a pool that is broken and passes on nothing.
    """
    until = time.monotonic() + patience
    while time.monotonic() < until and not all(call.running() or call.done() for call in calls):
        time.sleep(1e-3)


def _on_cluster(function: Callable[[T], R], items: Sequence[T], address: str) -> Iterator[tuple[int, R]]:
    try:
        from distributed import Client, as_completed
    except ImportError as error:
        raise InputError(
            "a Dask address was given, but the package distributed is missing",
            mend=install("cluster"),
        ) from error
    try:
        client = Client(address, timeout="5s", set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(
            f"no Dask scheduler answers at {address}", mend="start one with `dask scheduler`, or check the address"
        ) from error
    with client:
        # pure=False: two equal items are two tasks, as on local processes.
        futures = client.map(_indexed, [function] * len(items), range(len(items)), items, pure=False)
        try:
            for future in as_completed(futures, loop=client.loop):
                yield future.result()
                future.release()
        except BaseException:
            client.cancel(futures)
            raise
