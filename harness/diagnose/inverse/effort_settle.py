"""What of a set of effects stands: every member pays, improves data held out, and is not better told by something else."""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2

from harness.diagnose.inverse.constants import FROM_NOTHING_SIGMAS, HELD_OUT_SIGMAS, STRETCHED_CHANCE, THROUGHOUT_SIGMAS
from harness.diagnose.inverse.effort_fit import EffortFit
from harness.diagnose.inverse.effort_search import EffortStudy
from harness.diagnose.problem.constants import UNPARTED_EVIDENCE


def _needed(smaller: EffortFit, larger: EffortFit) -> float:
    """Standard deviations by which data held out must improve.

    What the nominal model had to be stretched far beyond its tolerance to imitate cannot show there: the stretched model predicts
    them as well. The stretch is then the evidence.
    """
    stretched = chi2.sf(max(smaller.prior - larger.prior, 0.0), larger.hypothesis.size) < STRETCHED_CHANCE
    return -HELD_OUT_SIGMAS if stretched else HELD_OUT_SIGMAS


def settle(study: EffortStudy, fitted: EffortFit) -> EffortFit:
    """What stands of a set (``standing``) with rivals weighed, grown again by what stands the same judgement beside it.

    A member may have been dropped for what others did.
    """
    fitted = _swapped(study, fitted)
    while True:
        grown = [
            study.extend(fitted, candidate, start) for candidate, start in study.promising(fitted, study.ranked(fitted))
        ]
        best = min(grown, key=study.criterion, default=fitted)
        if study.criterion(best) >= study.criterion(fitted):
            return fitted
        judged = standing(study, best)
        if study.criterion(judged) >= study.criterion(fitted) - UNPARTED_EVIDENCE:
            return fitted
        fitted = judged


def standing(study: EffortStudy, fitted: EffortFit) -> EffortFit:
    """The set less what does not plainly pay, or does not improve data held out, or may as well be absent.

    What has a special case stands against that, however sure it is that something is there.
    """
    while fitted.hypothesis.members:
        doubtful = [
            k
            for k, member in enumerate(fitted.hypothesis.members)
            if member.effect.simpler or _stands(study, fitted, k, study.seen_without(fitted, k)) < UNPARTED_EVIDENCE
        ]
        judged = [
            (_stands(study, fitted, k, smaller), k, smaller) for k in doubtful for smaller in [study.plainer(fitted, k)]
        ]
        worst, _, smaller = min(judged, key=lambda item: item[0], default=(np.inf, 0, fitted))
        if worst > 0.0:
            break
        fitted = smaller
    return fitted


def surely_standing(study: EffortStudy, fitted: EffortFit) -> EffortFit:
    """The set less the more doubtful half of what is doubtful, round by round: for one fit a round, where ``standing`` takes one a
    member.

    All that is left stands by what a linear step makes up for. Of several that could each do without the others, dropped together
    none would be left.
    """
    while fitted.hypothesis.members:
        firm = {
            k: _stands(study, fitted, k, study.seen_without(fitted, k)) for k in range(len(fitted.hypothesis.members))
        }
        doubtful = sorted((k for k, value in firm.items() if value < UNPARTED_EVIDENCE), key=firm.__getitem__)
        if not doubtful:
            break
        hypothesis, x = fitted.hypothesis, fitted.x
        for k in sorted(doubtful[: (len(doubtful) + 1) // 2], reverse=True):
            span = hypothesis.span(k)
            x = np.delete(x, slice(study.nominal + span.start, study.nominal + span.stop))
            hypothesis = hypothesis.without(k)
        fitted = study.fit(hypothesis, [x])
    return fitted


def _stands(study: EffortStudy, fitted: EffortFit, k: int, smaller: EffortFit) -> float:
    """How firmly member ``k`` stands against a fit without it; not at all where this is negative."""
    pays = study.criterion(smaller) - study.criterion(fitted) - UNPARTED_EVIDENCE
    needed = _needed(smaller, fitted)
    carries = 100.0 * (study.heldout_z(smaller, fitted) - needed)
    clear = 100.0 * (study.from_nothing(fitted, k) - FROM_NOTHING_SIGMAS)
    if needed > 0.0:
        # What pays by a few stretches makes up for what a law has wrong there.
        clear = min(clear, 100.0 * (study.parting(fitted, smaller) - THROUGHOUT_SIGMAS))
    return min(pays, carries, clear)


def _swapped(study: EffortStudy, fitted: EffortFit) -> EffortFit:
    """The set with rivals in the place of members that are less likely than they, and plain laws in that of what is no better.

    Of what efforts do not part, a plain law of the joint says most: that a wrist rubs comes before that its drive is deaf.
    """
    for _ in range(len(fitted.hypothesis.members)):
        options = [f for k in range(len(fitted.hypothesis.members)) for _, f in study.rivals(fitted, k)]
        better = min(options, key=lambda f: (_curious(f), study.weight(f)), default=fitted)
        if (_curious(better), study.weight(better)) >= (_curious(fitted), study.weight(fitted) - 1e-9):
            break
        fitted = better
    return fitted


def _curious(fitted: EffortFit) -> int:
    """How many members are no plain laws."""
    return sum(not member.effect.plain for member in fitted.hypothesis.members)
