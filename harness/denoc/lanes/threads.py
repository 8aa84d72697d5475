"""Pieces of compiled work shared among threads that are kept: starting them takes as long as a short piece of work."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import wait

from harness.parallel import kept_threads


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

    helpers = [kept_threads("lanes", threads - 1, os.getpid()).submit(work) for _ in range(threads - 1)]
    try:
        work()
    finally:
        wait(helpers)
    for helper in helpers:
        helper.result()
