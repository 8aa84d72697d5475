"""Nearly as good sets without one of the members that they share with the best one."""

from __future__ import annotations

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.constants.search import FAR_COST_RATIO, MOST_REDUCED_SETS, NEARLY_BEST_EVIDENCE
from harness.diagnose.selection.exchange import swaps
from harness.diagnose.selection.rewrite import Rewrite, Room, Turn
from harness.diagnose.selection.study import Study


def _fits(study: Study, best: Fit, room: Room) -> list[Fit]:
    """Fits of nearly as good sets without one of the members that they share with the best one.

    What stands in a member's place may do without the others; none that the best set cannot do without are tried.
    """
    base, found = best.hypothesis, []
    for swap in swaps(study, best)[:MOST_REDUCED_SETS]:
        if swap.worse > NEARLY_BEST_EVIDENCE:
            break
        for k, key in enumerate(base.keys):
            if k != swap.k and study.reduce(best, k).score < FAR_COST_RATIO * best.score:
                found.append(study.reduce(swap.fit, swap.fit.hypothesis.keys.index(key)))
    return found


REWRITE = Rewrite("a nearly as good set without a member", _fits, (Turn.POLISHING, Turn.FEWER))
