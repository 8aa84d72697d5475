"""Nearly as good sets without one of the members that they share with the best one."""

from __future__ import annotations

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.exchange import swaps
from harness.diagnose.selection.rewrite import Rewrite, Room, Turn
from harness.diagnose.selection.study import FAR, Study

MOST_REDUCED, NEARLY_BEST = 6, 20.0  # sets, in the criterion


def _fits(study: Study, best: Fit, room: Room) -> list[Fit]:
    """Fits of nearly as good sets without one of the members that they share with the best one.

    What stands in a member's place may do without the others; none that the best set cannot do without are tried.
    """
    base, found = best.hypothesis, []
    for swap in swaps(study, best)[:MOST_REDUCED]:
        if swap.worse > NEARLY_BEST:
            break
        for k, key in enumerate(base.keys):
            if k != swap.k and study.reduce(best, k).score < FAR * best.score:
                found.append(study.reduce(swap.fit, swap.fit.hypothesis.keys.index(key)))
    return found


REWRITE = Rewrite("a nearly as good set without a member", _fits, (Turn.POLISHING, Turn.FEWER))
