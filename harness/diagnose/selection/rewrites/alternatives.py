"""Another candidate in the place of a member: the most promising ones by their score tests beside the others."""

from __future__ import annotations

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.hypothesis import dear
from harness.diagnose.selection.constants.search import (
    ALTERNATIVE_PROMISE,
    COMPLETE_COST_RATIO,
    DEAR_ALTERNATIVE_PROMISE,
    MOST_DEAR_EXCHANGES,
)
from harness.diagnose.selection.rewrite import Rewrite, Room, Turn
from harness.diagnose.selection.study import Study


def alternatives(study: Study, best: Fit, k: int, count: int, most_fits: int) -> list[Fit]:
    """Fits with member ``k`` of the best set replaced by another candidate, the ``count`` most promising ones, best first.

    Nothing further is fitted once the study has ``most_fits``.
    """
    without = study.reduce(best, k)
    member = best.hypothesis.members[k]
    needed = study.criterion(without) - study.criterion(best)
    found = []
    tried = slow = 0
    # Where the set leaves more than noise, of what is dear to fit only the likeliest is worth it.
    most_slow = (
        count if best.score < COMPLETE_COST_RATIO * study.samples and not study.left_out else MOST_DEAR_EXCHANGES
    )
    for scored in study.ranked(without):
        if scored.candidate.key == member.key or tried >= count:
            continue
        if len(study.fits) >= most_fits:
            break
        share = scored.gain / max(min(needed, without.score - best.score), 1e-300)
        if share < ALTERNATIVE_PROMISE:
            break
        if dear(scored.candidate) and (share < DEAR_ALTERNATIVE_PROMISE or slow >= most_slow):
            continue
        slow += dear(scored.candidate)
        tried += 1
        found.append(study.extend(without, scored))
    return sorted(found, key=study.criterion)


def _fits(study: Study, best: Fit, room: Room) -> list[Fit]:
    return alternatives(study, best, room.member, room.count, room.most_fits)


REWRITE = Rewrite("another candidate for a member", _fits, (Turn.POLISHING,), every_member=True)
