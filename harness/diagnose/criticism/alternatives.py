"""Whether something that nobody has named does better than what members of a set do."""

from __future__ import annotations

from collections.abc import Sequence

from harness.diagnose.criticism.check import Asked, Check, Test, left_by
from harness.diagnose.criticism.remainder import answers, asked_of
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.study import Study
from harness.effects.effect import Effect


def imitated(study: Study, best: Fit, smaller: Fit, margin: float = 0.0, *, exact: bool = False) -> bool:
    """Whether a force, or error of a reading, that nobody has named does better by ``margin`` than what a member does.

    exact: ask only for what brings what it promises.
    """
    absent = missing(best, smaller)
    asked = [c for c in asked_of(Asked.OF_EVERY_FIT) if c.may_stand_for(absent) and (c.exact or not exact)]
    named = [test for test in tests_of(study, smaller, asked) if test.places >= 0]
    return do_better(study, best, smaller, named, margin)


def missing(best: Fit, smaller: Fit) -> list[Effect]:
    """Effects of a set that a smaller one does without."""
    return [m.effect for m in best.hypothesis.members if m.key not in smaller.hypothesis.keys]


def tests_of(study: Study, fitted: Fit, asked: Sequence[Check]) -> list[Test]:
    """Tests of some checks of what a fit leaves."""
    return [test for _, test in answers(left_by(study, fitted), asked)] if asked else []


def do_better(study: Study, best: Fit, smaller: Fit, tests: Sequence[Test], margin: float = 0.0) -> bool:
    """Whether what one of the tests names, beside ``smaller``, does better by ``margin`` than what ``best`` has more."""
    own = smaller.score - best.score
    there = max(smaller.score - study.samples, own)

    def worth(gain: float, exact: bool) -> float:
        # A linear gain that promises more than there is says only that it might do as well.
        return gain if exact or gain < there else own

    worths = [worth(t.gain, t.exact) - t.price(study.samples) for t in tests]
    worths += [worth(t.together[0], t.exact) - t.price_together(study.samples) for t in tests]
    # By what the recordings say alone: a force that nobody has named has no usual size to be held against either.
    without, with_ = (study.criterion(f) - study.surprise(f) for f in (smaller, best))
    return bool(without - max(worths, default=0.0) < with_ - margin)
