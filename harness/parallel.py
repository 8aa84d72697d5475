"""One parallel map for all wide work: processes on this machine, or an existing Dask cluster by its address.

Results are in the order of the items and identical either way; what a task does must depend on its item alone.
"""

from __future__ import annotations

import logging
import os
import signal
import threading
import time
import warnings
from collections import deque
from collections.abc import Callable, Collection, Iterator, Sequence
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
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
    for index, result in stream(function, items, workers=workers, dask=dask):
        results[index] = result
        if done is not None:
            done(index, result)
    return [results[index] for index in range(len(items))]


Lost = Callable[[int, str], R]


def stream(
    function: Callable[[T], R],
    items: Sequence[T],
    *,
    workers: int | None = None,
    dask: str | None = None,
    lost: Lost[R] | None = None,
) -> Iterator[tuple[int, R]]:
    """(index, result) as the results of a parallel map arrive; no more is handed out or kept than the workers can hold.

    lost: what stands for an item whose worker ended each time it was tried (a crash, out of memory), called with its index and a
    line that says so; without it that is an error. Everything else as in ``parallel_map``.
    """
    if dask is not None:
        return _on_cluster(function, items, dask, lost)
    count = default_workers() if workers is None else workers
    if count < 1:
        raise InputError(f"{count} workers", mend="give a number of at least 1")
    if count == 1 or len(items) <= 1:
        return ((index, function(item)) for index, item in enumerate(items))
    return _on_processes(function, items, min(count, len(items)), lost)


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


def _on_processes(
    function: Callable[[T], R], items: Sequence[T], count: int, lost: Lost[R] | None
) -> Iterator[tuple[int, R]]:
    from concurrent.futures.process import BrokenProcessPool

    waiting = deque(range(len(items)))
    while waiting:
        # What has been handed out and not come back.
        out: set[int] = set()
        try:
            yield from _of_a_pool(function, items, count, waiting, out)
        except BrokenProcessPool:
            if lost is None:
                raise
            # A worker that ends takes its pool along: which item that was shows when each is tried by itself.
            for index in sorted(out):
                try:
                    yield from _of_a_pool(function, items, 1, deque([index]), set())
                except BrokenProcessPool:
                    yield index, lost(index, WORKER_ENDED)


WORKER_ENDED = "its worker ended each time: it crashed, or was out of memory"


def _of_a_pool(
    function: Callable[[T], R], items: Sequence[T], count: int, waiting: deque[int], out: set[int]
) -> Iterator[tuple[int, R]]:
    """Results of one pool of processes. waiting: what is still to be handed out; out: what is, and not back."""
    from concurrent.futures import FIRST_COMPLETED, wait

    from joblib.externals.loky import get_reusable_executor

    # A worker whose memory has grown is replaced by a fresh one; nothing is lost by that, and nobody needs to be warned.
    warnings.filterwarnings("ignore", message="A worker stopped while some jobs", category=UserWarning)
    running: set[Future[tuple[int, R]]] = set()

    def hand_out(most: int) -> None:
        for _ in range(min(most, len(waiting))):
            index = waiting.popleft()
            out.add(index)
            running.add(executor.submit(_indexed, function, index, items[index]))

    # Only what the workers can hold is handed out: a pool that is stopped with a queue of work stumbles over it.
    with _interrupts_ignored():
        executor = get_reusable_executor(
            max_workers=count, env=_ONE_THREAD, timeout=120, initializer=_end_without, initargs=(os.getpid(),)
        )
        hand_out(count + 1)
    try:
        while running:
            done, running = wait(running, return_when=FIRST_COMPLETED)
            hand_out(len(done))
            for future in done:
                index, result = future.result()
                out.discard(index)
                yield index, result
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


AHEAD = 2  # tasks for each thread of a cluster: one to run, one to go on with
COUNTED = 5.0  # s, after which the threads of a cluster are counted again: workers come and go


def _on_cluster(
    function: Callable[[T], R], items: Sequence[T], address: str, lost: Lost[R] | None
) -> Iterator[tuple[int, R]]:
    try:
        from distributed import Client, KilledWorker, as_completed
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
    gone = InputError(
        f"the Dask scheduler at {address} is gone",
        mend="start it again, and give the same command: what is kept is not done twice",
    )
    waiting = iter(range(len(items)))
    indices: dict[Any, int] = {}
    with _nothing_logged("distributed"), client:
        arriving = as_completed(loop=client.loop)

        def hand_out(most: int) -> None:
            for index in islice(waiting, most):
                # pure=False: two equal items are two tasks, as on local processes.
                future = client.submit(_indexed, function, index, items[index], pure=False)
                indices[future] = index
                arriving.add(future)

        try:
            counted, room = time.monotonic(), _room(client)
            hand_out(room)
            for future in arriving:
                index = indices.pop(future)
                try:
                    yield future.result()
                except KilledWorker:
                    if lost is None:
                        raise
                    yield index, lost(index, WORKER_ENDED)
                future.release()
                if time.monotonic() - counted > COUNTED:
                    counted, room = time.monotonic(), _room(client, room)
                hand_out(room - len(indices))
        except CancelledError as error:
            # Nobody here cancels: a client does, once it has waited in vain for its scheduler to come back.
            raise gone from error
        except BaseException:
            client.cancel(list(indices))
            raise


@contextmanager
def _nothing_logged(package: str) -> Iterator[None]:
    """Inside, the package's own handlers print nothing: what of it matters is raised, and said in one line."""
    handlers = list(logging.getLogger(package).handlers)

    def nothing(_: logging.LogRecord) -> bool:
        return False

    for handler in handlers:
        handler.addFilter(nothing)
    try:
        yield
    finally:
        for handler in handlers:
            handler.removeFilter(nothing)


def _room(client: Any, before: int = AHEAD) -> int:
    """Tasks that a cluster can be given to hold, a few where it has no worker yet; as before where it does not answer now."""
    try:
        return max(AHEAD * sum(client.nthreads().values()), AHEAD)
    except (OSError, TimeoutError):
        return before
