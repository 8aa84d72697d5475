"""Nearly as good sets with another one of their members exchanged for a relative too."""

from __future__ import annotations

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.hypothesis import dear
from harness.diagnose.selection.constants.search import MOST_SECOND_SETS, NEAR_EVIDENCE
from harness.diagnose.selection.exchange import swaps
from harness.diagnose.selection.rewrite import Rewrite, Room, Turn
from harness.diagnose.selection.rewrites.relatives import relatives
from harness.diagnose.selection.study import Study


def _fits(study: Study, best: Fit, room: Room) -> list[Fit]:
    """Fits of nearly as good sets with another one of their members exchanged for a relative too.

    What looks like a step back may open the way to a relative of what the best set does not even need.
    """
    found = []
    for swap in swaps(study, best)[:MOST_SECOND_SETS]:
        keys = swap.fit.hypothesis.keys
        if swap.worse > NEAR_EVIDENCE or any(map(dear, swap.fit.hypothesis.members)):
            continue
        for k, key in enumerate(keys):
            if key != swap.candidate.key and len(study.fits) < room.most_fits:
                found += relatives(study, swap.fit, k, room.most_fits)
    return found


REWRITE = Rewrite("a relative in a nearly as good set", _fits, (Turn.POLISHING,))
