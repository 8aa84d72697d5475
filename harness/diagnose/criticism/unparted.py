"""Laws that a remainder does not part: the one that fits best may only be the one that soaks up most of it."""

from __future__ import annotations

from harness.diagnose.criticism.constants import AMPLY_CARRIES_RATIO, FAKED_RATIO, MOST_UNPARTED
from harness.diagnose.criticism.held_out import carries
from harness.diagnose.criticism.remainder import Remains, excess
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.hypothesis import Candidate
from harness.diagnose.selection.exchange import known_in_place_of, related
from harness.diagnose.selection.outcome import Outcome
from harness.diagnose.selection.rewrites.relatives import relatives
from harness.diagnose.selection.rewrites.special_case import specialized


def special_case(outcome: Outcome, best: Fit, remains: Remains) -> Fit | None:
    """The set with a law replaced by a special case of it, where beside a remainder nothing establishes the more general one.

    What makes a law more general is then weighed as an effect of its own would be: its other numbers may have gone to whatever
    nobody has named.
    """
    if not remains.significant:
        return None
    limit = best.score + FAKED_RATIO * excess(outcome.study, best, remains)
    plainer = sorted(specialized(outcome.study, best), key=lambda f: f.score)
    return next((f for f in plainer if f.score < limit and not carries(outcome, best, f, AMPLY_CARRIES_RATIO)), None)


def unparted(outcome: Outcome, best: Fit, k: int, remains: Remains) -> list[Candidate]:
    """Relatives of member ``k`` that beside a remainder might as well be the law, by what they leave and by what they predict.

    Likelihoods part laws as if nothing but noise were left; beside a remainder the best one may have taken up most of it.
    """
    if not remains.significant:
        return []
    study, member = outcome.study, best.hypothesis.members[k]
    relatives(study, best, k, len(study.fits) + MOST_UNPARTED)
    limit = best.score + FAKED_RATIO * excess(study, best, remains)
    likeliest = sorted(known_in_place_of(study, best, k), key=lambda pair: pair[1].score)[: 2 * MOST_UNPARTED]
    return [
        new
        for new, other in likeliest
        if related(member, new) and other.score < limit and not carries(outcome, best, other, AMPLY_CARRIES_RATIO)
    ]
