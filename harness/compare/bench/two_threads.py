"""What a second thread gains: the native code with one thread and with two, and whether the machine had two cores for it."""

from __future__ import annotations

from collections.abc import Callable

from harness.compare.bench.measure import processor_time, side_by_side
from harness.compare.bench.row import Row

WANTED = 1.8


def two_threads(
    what: str, n: int, one: Callable[[], object], two: Callable[[], object], *, items: int, rounds: int, note: str
) -> Row:
    """A row whose ratio is the gain of the second thread.

    one, two: the same work on one thread and on two. items: how many a call deals with; times are for one of them.
    Of a poor ratio the note says which it is: more processor time for the same work where both cores are one that is shared, a
    smaller part of two cores where other work had them or a thread waited for the other.
    """
    timings = side_by_side({"one": one, "two": two}, rounds=rounds)
    alone, _ = processor_time(one, rounds)
    together, running = processor_time(two, rounds)
    return Row.timed(
        what,
        n,
        "denoc on one thread",
        timings["two"].per(items),
        timings["one"].per(items),
        note=f"{note}; the ratio is the gain of the second thread, which took {together / alone:.2f} times the processor time "
        f"of one (up to 2 where both cores are one) and had {running / 2.0:.0%} of two cores",
        wanted=WANTED,
    )
