"""Whether one error of a known shape explains what a fit leaves, though no law of the catalogue does."""

from __future__ import annotations

from harness.diagnose.criticism.check import Asked, left_by
from harness.diagnose.criticism.remainder import answers, asked_of
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.study import Study


def worth_of_structure(study: Study, fitted: Fit, *, of_state: bool) -> float:
    """What the likeliest such error gains in the criterion beyond its price; nothing where none does.

    of_state: whether forces over the state are among them. A linear gain cannot take away more than what is above the noise.
    """
    quick = [check for check in asked_of(Asked.BESIDE_A_REMAINDER) if check.quick(study)]
    asked = [check for check in (*asked_of(Asked.OF_EVERY_FIT), *quick) if of_state or not check.of_state]
    tests = [test for _, test in answers(left_by(study, fitted), asked)]
    there = max(fitted.score - study.samples, 0.0)
    worths = [min(t.gain, there) - t.price(study.samples) for t in tests if t.places >= 0]
    worths += [min(t.together[0], there) - t.price_together(study.samples) for t in tests if t.places >= 0]
    return max([0.0, *worths])
