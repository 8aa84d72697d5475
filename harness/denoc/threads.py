"""Pieces of compiled work shared among threads that are kept: starting them takes as long as a short piece of work."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from functools import lru_cache


def share(part: Callable[[int, int], None], pieces: Sequence[tuple[int, int]], threads: int) -> None:
    """Call ``part(first, last)`` for all pieces on so many threads, this one among them; raises what a piece raises."""
    left = deque(pieces)

    def work() -> None:
        while True:
            try:
                first, last = left.popleft()
            except IndexError:
                return
            part(first, last)

    helpers = [_helpers(threads - 1, os.getpid()).submit(work) for _ in range(threads - 1)]
    try:
        work()
    finally:
        wait(helpers)
    for helper in helpers:
        helper.result()


@lru_cache(maxsize=4)
def _helpers(count: int, process: int) -> ThreadPoolExecutor:
    """So many threads of this process; a forked one has none of its parent's."""
    return ThreadPoolExecutor(count, thread_name_prefix="lanes")
