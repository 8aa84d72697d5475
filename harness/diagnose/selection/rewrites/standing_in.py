"""What could do a member's work where everything else in a set stands, told by a linear view made there."""

from __future__ import annotations

import numpy as np

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.problem.hypothesis import compatible, dear
from harness.diagnose.selection.constants.search import (
    HOPELESS_COST_RATIO,
    MOST_STANDING_IN,
    NOTICEABLE_GAIN,
    STANDING_IN_SHARE,
)
from harness.diagnose.selection.rewrite import Rewrite, Room, Turn
from harness.diagnose.selection.score_tests import Score, nuisance, score
from harness.diagnose.selection.study import Study


def _fits(study: Study, best: Fit, room: Room) -> list[Fit]:
    """Fits with the member replaced by candidates that do its work where all others, the nominal quantities among them, stand.

    The set fitted without the member has bent what it could to do without, so that another effect seen from there seems to explain
    little, and a fit begun there ends in a valley of its own. Only what is not dear to fit is tried, and nothing where the set
    without the member is neither bent nor far off: there its own score tests say as much.
    """
    k = room.member
    rest, without = best.hypothesis.without(k), study.reduce(best, k)
    if (not study.stretched(without) and without.score < HOPELESS_COST_RATIO * study.samples) or any(
        map(dear, rest.members)
    ):
        return []
    x = study.without(best, k)
    left, tests = _tested(study, best, k)
    found: list[Fit] = []
    for scored in tests:
        if (
            scored.gain < STANDING_IN_SHARE * left
            or len(found) >= MOST_STANDING_IN
            or len(study.fits) >= room.most_fits
        ):
            break
        hypothesis = rest.with_(scored.candidate)
        known = study.known(hypothesis)
        near = known is not None and known.score < best.score + NOTICEABLE_GAIN
        if near or study.was_exchanged(best, scored.candidate, " standing in"):
            continue
        start = np.concatenate([x, to_internal(scored.candidate, scored.start)])
        found.append(study.fit(hypothesis, [start], best, target=best.score))
    return found


def _tested(study: Study, best: Fit, k: int) -> tuple[float, list[Score]]:
    """What all others leave beyond the best set where they stand without member ``k``, and tests of candidates there."""
    member, rest = best.hypothesis.members[k], best.hypothesis.without(k)
    key = (best.hypothesis.identity, member.key, best.score)
    if key not in study.substitutes:
        here = study.standing_without(best, k)
        space = nuisance(here, study.predictor)
        open_ones = [c for c in study.candidates if c.key != member.key and not dear(c) and compatible(rest, c)]
        found = score(here, study.predictor, study.likelihood, open_ones, study.problem, [space])
        study.substitutes[key] = float(space.residual @ space.residual) - best.score, found
    return study.substitutes[key]


REWRITE = Rewrite("what does a member's work where all others stand", _fits, (Turn.IN_PLACE,), every_member=True)
