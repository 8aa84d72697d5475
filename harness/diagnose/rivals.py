"""What else it could be: effects that could stand in the place of a member, weighed on all recordings."""

from __future__ import annotations

from harness.diagnose.fit import Fit
from harness.diagnose.investigate import Outcome

MOST = 9  # rivals fitted for each member
WORTH_FITTING = (
    0.5  # share of a member's gain that a rival's score test must promise; the test is linear, the truth is not
)
APART = 6.0  # difference in the criterion (odds of twenty to one) below which hypotheses cannot be told apart


def in_place_of(outcome: Outcome, best: Fit, k: int) -> list[Fit]:
    """Fits with member ``k`` replaced by each candidate whose score test promises a similar gain."""
    study = outcome.study
    without = study.reduce(best, k)
    member = best.hypothesis.members[k]
    own = without.score - best.score
    found: list[Fit] = []
    for scored in study.ranked(without):
        if scored.candidate.key == member.key:
            continue
        if len(found) >= MOST or scored.gain < WORTH_FITTING * own:
            break
        found.append(study.extend(without, scored))
    return found


def near(outcome: Outcome, best: Fit, k: int) -> list[Fit]:
    """Rivals of member ``k`` that the recordings do not part from the best set, likeliest first."""
    study = outcome.study
    limit = study.evidence(best) + APART
    return sorted((f for f in in_place_of(outcome, best, k) if study.evidence(f) < limit), key=study.evidence)


def preferred(outcome: Outcome, best: Fit) -> Fit:
    """The best set with each member exchanged for a rival that does better, if there is one."""
    study = outcome.study
    for _ in range(len(best.hypothesis.members)):
        better = min((f for k in range(len(best.hypothesis.members)) for f in in_place_of(outcome, best, k)),
                     key=study.criterion, default=best)  # fmt: skip
        if study.criterion(better) > study.criterion(best) - 1e-6:
            break
        best = better
    return best


def ranking(outcome: Outcome, best: Fit, count: int) -> list[Fit]:
    """The likeliest hypotheses fitted; the one claimed comes first."""
    shortlist = sorted(outcome.study.fits.values(), key=outcome.study.criterion)[: count + 1]
    return [best, *(f for f in shortlist if f is not best)][:count]
