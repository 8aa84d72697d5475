"""Two members exchanged at once: two wrong ones may make up for one another, so that putting one right looks like a step back."""

from __future__ import annotations

from itertools import combinations

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.hypothesis import dear
from harness.diagnose.selection.constants.search import MOST_DEAR_EXCHANGES, MOST_EXCHANGED_PAIRS, NEAR_EVIDENCE
from harness.diagnose.selection.exchange import exchanged, swaps
from harness.diagnose.selection.rewrite import Rewrite, Room, Turn
from harness.diagnose.selection.study import Study


def _fits(study: Study, best: Fit, room: Room) -> list[Fit]:
    """Fits with two members exchanged at once, for what either exchange alone leaves nearly as good.

    Two wrong members may make up for one another, so that putting one of them right looks like a step back.
    """
    pairs = [(a, b) for a, b in combinations(swaps(study, best), 2) if a.k != b.k and a.worse + b.worse < NEAR_EVIDENCE]
    found = []
    slow = 0
    for one, two in sorted(pairs, key=lambda p: p[0].worse + p[1].worse)[:MOST_EXCHANGED_PAIRS]:
        if any(dear(swap.candidate) and not any(map(dear, best.hypothesis.members)) for swap in (one, two)):
            slow += 1
            if slow > MOST_DEAR_EXCHANGES:
                continue
        if len(study.fits) >= room.most_fits:
            break
        both = exchanged(study, best, one, two)
        found += [] if both is None else [both]
    return found


REWRITE = Rewrite("two members exchanged at once", _fits, (Turn.POLISHING,))
