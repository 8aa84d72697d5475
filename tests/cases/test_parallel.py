"""The parallel map: order, errors, and the same results here and on a cluster."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness.errors import InputError
from harness.parallel import meanwhile, parallel_map, stream


def square(x: int) -> int:
    return x * x


def process(_: int) -> int:
    return os.getpid()


def fails(x: int) -> int:
    if x == 3:
        raise InputError("three is not wanted")
    return x


ITEMS = [5, 3, 8, 1, 9, 2]
SQUARES = [25, 9, 64, 1, 81, 4]


@pytest.mark.parametrize("workers", [1, 2])
def test_results_are_in_the_order_of_the_items(workers):
    seen: dict[int, int] = {}
    assert parallel_map(square, ITEMS, workers=workers, done=seen.__setitem__) == SQUARES
    assert seen == dict(enumerate(SQUARES))


def test_one_worker_stays_in_this_process():
    assert set(parallel_map(process, [1, 2], workers=1)) == {os.getpid()}
    assert os.getpid() not in parallel_map(process, [1, 2], workers=2)


def test_nothing_to_do():
    assert parallel_map(square, []) == []


@pytest.mark.parametrize("workers", [1, 2])
def test_an_error_comes_through_and_the_map_works_afterwards(workers):
    with pytest.raises(InputError, match="three"):
        parallel_map(fails, [1, 2, 3, 4], workers=workers)
    assert parallel_map(square, ITEMS, workers=workers) == SQUARES


def waits(x: int) -> int:
    time.sleep(0.02 if x == 0 else 0.2)
    if x == 0:
        raise InputError("the first is not wanted")
    return x


@pytest.mark.parametrize("again", range(3))
def test_an_error_while_work_is_left_is_all_that_is_said(again, monkeypatch):
    """loky's manager, stopped with a call that it has not passed on, ends in a KeyError that Python prints with its traceback."""
    said: list[object] = []
    monkeypatch.setattr(threading, "excepthook", said.append)
    with pytest.raises(InputError, match="the first"):
        parallel_map(waits, range(20), workers=2)
    assert not said


def test_no_workers_are_refused():
    with pytest.raises(InputError, match="at least 1"):
        parallel_map(square, ITEMS, workers=0)


def test_a_cluster_gives_the_same():
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None, protocol="tcp"
    ) as cluster:
        seen: list[int] = []
        assert parallel_map(square, ITEMS, dask=cluster.scheduler_address, done=lambda i, r: seen.append(i)) == SQUARES
        assert sorted(seen) == list(range(len(ITEMS)))
        with pytest.raises(InputError, match="three"):
            parallel_map(fails, [1, 2, 3, 4], dask=cluster.scheduler_address)


def test_a_cluster_that_is_not_there_is_one_line():
    pytest.importorskip("distributed")
    with pytest.raises(InputError, match="no Dask scheduler answers") as caught:
        parallel_map(square, ITEMS, dask="tcp://127.0.0.1:9")
    assert "\n" not in str(caught.value)


def test_a_word_that_is_no_address_is_one_line():
    pytest.importorskip("distributed")
    with pytest.raises(InputError, match="no Dask scheduler answers"):
        parallel_map(square, ITEMS, dask="nonsense")


def ident(_: int) -> int:
    return threading.get_ident()


@pytest.mark.parametrize("threads", [1, 2])
def test_what_runs_meanwhile_returns_and_raises_the_same(threads):
    assert meanwhile(threads, square, 7)() == 49
    assert (meanwhile(threads, ident, 0)() == threading.get_ident()) == (threads == 1)
    waiting = meanwhile(threads, fails, 3)
    with pytest.raises(InputError, match="three"):
        waiting()


def test_floating_point_warnings_are_taken_meanwhile_as_they_are_here():
    with np.errstate(over="raise"):
        waiting = meanwhile(2, np.square, np.array([1e300]))
    with pytest.raises(FloatingPointError):
        waiting()


KILLED = """
import sys, time
sys.path[:0] = [{folder!r}]
from harness.parallel import parallel_map
from test_parallel import tells_and_sleeps
parallel_map(tells_and_sleeps, [{folder_of_pids!r}] * 2, workers=2)
"""


def tells_and_sleeps(folder: str) -> None:
    """Write its own number, and do nothing for longer than anybody waits."""
    Path(folder, str(os.getpid())).touch()
    time.sleep(600.0)


def gone(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    # Nobody may wait for what lost its parent, where there is no init: it is dead all the same.
    status = Path(f"/proc/{pid}/stat")
    return status.exists() and status.read_text().rpartition(")")[2].split()[0] == "Z"


@pytest.mark.skipif(os.name != "posix", reason="SIGKILL")
def test_workers_end_with_a_parent_that_was_killed(tmp_path):
    script = KILLED.format(folder=str(Path(__file__).parent), folder_of_pids=str(tmp_path))
    parent = subprocess.Popen([sys.executable, "-c", script])
    until = time.monotonic() + 120.0
    while len(list(tmp_path.iterdir())) < 2:
        assert parent.poll() is None and time.monotonic() < until
        time.sleep(0.05)
    parent.kill()
    parent.wait()
    workers = [int(path.name) for path in tmp_path.iterdir()]
    while not all(map(gone, workers)):
        assert time.monotonic() < until, "a worker goes on without its parent"
        time.sleep(0.05)


def ends(x: int) -> int:
    if x == 3:
        os._exit(9)  # as a crash or the system's hand on a process out of memory does
    return x * x


def test_an_item_that_ends_its_worker_is_told_and_the_others_come():
    def lost(index: int, why: str) -> int:
        assert "worker ended" in why
        return -index

    found = dict(stream(ends, ITEMS, workers=2, lost=lost))
    assert found == {k: -1 if x == 3 else x * x for k, x in enumerate(ITEMS)}


class Watched(Sequence[int]):
    """Items that count how many of them were asked for."""

    def __init__(self, count: int) -> None:
        self.size, self.asked = count, 0

    def __len__(self) -> int:
        return self.size

    def __getitem__(self, index: Any) -> Any:
        self.asked += 1
        return index


@pytest.mark.parametrize("where", ["processes", "cluster"])
def test_no_more_is_handed_out_than_the_workers_can_hold(where):
    """A map over ten thousand items holds a few of them: two for each thread of a cluster, one more than processes here."""
    items = Watched(10_000)
    if where == "processes":
        arriving = stream(square, items, workers=2)
        next(arriving)
        assert items.asked <= 3 + 3  # all three that were out may come back at once
        arriving.close()
        return
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None, protocol="tcp"
    ) as cluster:
        arriving = stream(square, items, dask=cluster.scheduler_address)
        for _ in range(20):
            next(arriving)
        assert items.asked <= 20 + 2
        arriving.close()
