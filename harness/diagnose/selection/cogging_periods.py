"""Other places of a force over the angle: numbers of periods a turn that the recordings hardly part."""

from __future__ import annotations

import numpy as np

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.hypothesis import whole_numbers
from harness.diagnose.selection.constants.search import COGGING_PLACE_PROMISE, MOST_COGGING_PLACES, NOTICEABLE_GAIN
from harness.diagnose.selection.score_tests import by_place
from harness.diagnose.selection.study import Study


def replaced(study: Study, best: Fit) -> Fit:
    """The set fitted with every force over the angle at the other places that promise about as much too; the best of all.

    Where a swing stays within a part of a turn, waves of quite different length may fit nearly alike. Where they end is kept with
    the study, for the intervals.
    """
    base = best.hypothesis
    for k, member in enumerate(base.members):
        if not whole_numbers(member).any() or study.was_exchanged(best, member, " elsewhere"):
            continue
        place = int(np.flatnonzero(whole_numbers(member))[0])
        seen = {round(float(study.predictor.effect_values(base, k, best.x)[place]))}
        without = study.reduce(best, k)
        scores = by_place(without, study.predictor, study.likelihood, member, study.problem)
        enough = max((s.gain for s in scores), default=0.0) * COGGING_PLACE_PROMISE
        for scored in scores:
            count = round(float(scored.start[place]))
            if scored.gain < enough or len(seen) > MOST_COGGING_PLACES:
                break
            if any(abs(count - other) <= 1 for other in seen):
                continue
            seen.add(count)
            start = study.predictor.with_values(base, k, best.x, scored.start)
            best = study.fit(base, [start], best, target=best.score + NOTICEABLE_GAIN)
    return best
