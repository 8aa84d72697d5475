"""What else it could be: effects that could stand in the place of a member, weighed on training and held-out data alike.

Two laws that leave the same trace on the training recordings often part on a recording of another amplitude or drive.
The data held out are fitted by nothing but initial states, so what they say adds to the criterion of the training data.
"""

from __future__ import annotations

from harness.diagnose.fit import Fit
from harness.diagnose.investigate import Outcome, judge

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


def weight(outcome: Outcome, fitted: Fit) -> float:
    """Criterion of the training data plus cost of the data held out: smaller is better."""
    return outcome.study.criterion(fitted) + judge(outcome, fitted).cost


def near(outcome: Outcome, best: Fit, k: int) -> list[Fit]:
    """Rivals of member ``k`` that neither training nor held-out data part from the best set, likeliest first."""
    study = outcome.study
    limit = study.criterion(best) + APART
    close = [f for f in in_place_of(outcome, best, k) if study.criterion(f) < limit]
    bound = weight(outcome, best) + APART if close else 0.0
    weighed = sorted(((weight(outcome, f), id(f), f) for f in close), key=lambda item: item[:2])
    return [f for value, _, f in weighed if value < bound]


def preferred(outcome: Outcome, best: Fit) -> Fit:
    """The best set with each member that the training data leave open chosen by what the data held out say."""
    study = outcome.study
    for _ in range(len(best.hypothesis.members)):
        now = weight(outcome, best)
        better = best
        for k in range(len(best.hypothesis.members)):
            for other in in_place_of(outcome, best, k):
                if study.criterion(other) < study.criterion(best) + APART and weight(outcome, other) < now - 1e-9:
                    better, now = other, weight(outcome, other)
        if better is best:
            break
        best = better
    return best


def ranking(outcome: Outcome, best: Fit, count: int) -> list[Fit]:
    """The likeliest hypotheses fitted, by training and held-out data; the one claimed comes first."""
    study = outcome.study
    shortlist = sorted(study.fits.values(), key=study.criterion)[:count]
    others = sorted((f for f in shortlist if f is not best), key=lambda f: weight(outcome, f))
    return [best, *others][:count]
