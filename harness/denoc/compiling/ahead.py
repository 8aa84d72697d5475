"""Kernels that are compiled ahead of their use, by processes beside this one, into the cache on disk that all share.

Compiling holds Python's lock, so that threads gain nothing. A kernel is a task with a name; whoever claims it first compiles
it, be it a helper or this process, and the others wait for it. Where there is one core, no helper starts; where a helper
fails, kernels are compiled when they are needed, as ever.
"""

from __future__ import annotations

import atexit
import contextlib
import json
import logging
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from harness.denoc.compiling.pipeline import fewer_collections
from harness.denoc.compiling.tasks import TASKS, missing
from harness.parallel import default_workers

#: What the commands need besides what they compile themselves meanwhile, the longest first.
SIMULATE = ("dop853",)
DIAGNOSE = ("lane_parameters", "lanes")
EVERYTHING = tuple(TASKS)

_MOST_HELPERS = 3
_LONGEST = 300.0  # that another process is waited for [s]
_log = logging.getLogger(__name__)
_claims: Path | None = None
_helpers: list[subprocess.Popen[bytes]] = []
_own: set[str] = set()
_needed: set[str] = set()
_announced = False


def start(tasks: Sequence[str], *, most: int = 1, beside: bool = False) -> None:
    """Let helpers compile those of the tasks that are not on disk yet; returns at once.

    most: helpers started at most; with this process they never outnumber the cores.
    beside: this process works through the same tasks, so that helpers take them in other orders (``_orders``).
    """
    global _claims
    left = missing(tasks)
    count = min(most, default_workers() - 1, len(left))
    if _claims is not None or count < 1:
        return
    _claims = Path(tempfile.mkdtemp(prefix="kernels"))
    atexit.register(_end)
    for order in _orders(left)[1 : count + 1] if beside else [left] * count:
        code = (
            f"import sys; sys.path[:] = {sys.path!r}; from harness.denoc.compiling.ahead import work; "
            f"work({json.dumps(order)}, {str(_claims)!r})"
        )
        with contextlib.suppress(OSError):
            _helpers.append(
                subprocess.Popen(
                    [sys.executable, "-c", code],
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                )
            )


def _orders(tasks: list[str]) -> list[list[str]]:
    """The tasks as up to four processes take them that share them: from the first, from the last, from the middle either way.

    Neighbours call the same functions, which a process compiles once.
    """
    middle = len(tasks) // 2
    around = tasks[middle:] + tasks[:middle]
    return [tasks, tasks[::-1], around, around[::-1]]


def announce(tasks: Sequence[str]) -> list[str]:
    """Say once that something has to be compiled, if something has; returns which of the tasks."""
    global _announced
    left = missing(tasks)
    if left and not _announced:
        _announced = True
        _log.warning(
            "compiling kernels, which are kept (about %s) …", "twenty seconds" if len(left) > 4 else "ten seconds"
        )
    return left


def ready(task: str) -> None:
    """Return when a task is done or this process may do it: waits for a helper that is at it.

    That something is compiled is said only here, where a kernel is needed: what a helper has begun and a run never came to need
    would be announced again by the next.
    """
    if task in TASKS and task not in _needed:
        _needed.add(task)
        announce([task])
    if _claims is None or task in _own:
        return
    if _claim(_claims, task):
        _own.add(task)
        return
    done = _claims / f"{task}.done"
    until = time.monotonic() + _LONGEST
    while not done.exists() and any(helper.poll() is None for helper in _helpers) and time.monotonic() < until:
        time.sleep(0.01)


def everything() -> None:
    """Compile all kernels that are not on disk, on up to four cores; for what goes on in many processes afterwards."""
    announce(EVERYTHING)
    start(EVERYTHING, most=_MOST_HELPERS, beside=True)
    if _claims is not None:
        work(EVERYTHING, str(_claims))
        for task in EVERYTHING:
            ready(task)


def work(tasks: Sequence[str], claims: str) -> None:
    """Compile what nobody has claimed yet, one task after the other."""
    folder = Path(claims)
    with fewer_collections():
        for task in tasks:
            if _claim(folder, task):
                _own.add(task)
                TASKS[task].compile()
                with contextlib.suppress(OSError):
                    (folder / f"{task}.done").touch()


def _claim(folder: Path, task: str) -> bool:
    """Whether the task was free; it is this process's now. A folder that is gone leaves nothing to claim."""
    try:
        os.close(os.open(folder / task, os.O_CREAT | os.O_EXCL))
    except OSError:
        return False
    return True


def _end() -> None:
    """Helpers work for nobody once this process ends."""
    for helper in _helpers:
        if helper.poll() is None:
            helper.terminate()
        helper.wait()
    if _claims is not None:
        shutil.rmtree(_claims, ignore_errors=True)
