"""Plain laws that are told where the evidence beside a force over the state and free runs do not agree.

A force over the state that nobody has named can be bent to nearly anything. Recordings of one kind of motion then hardly part one
law beside it from another, or from none, while free runs without it are left far nearer by some laws than by others. A law that
stands beside the force and foretells the data held out amply worse than others do is not borne out; these others may not be
claimed either, but who has to act on the answer should know of them.
"""

from __future__ import annotations

import numpy as np

from harness.diagnose.claims.constants import QUIETEST_VARIANCE
from harness.diagnose.criticism.constants import AMPLY_CARRIES_RATIO, CARRIES_RATIO
from harness.diagnose.estimation.constants import LOST
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.constants import UNPARTED_EVIDENCE
from harness.diagnose.selection.dissipation_starts import ordinary_everywhere
from harness.diagnose.selection.outcome import Outcome, judge
from harness.diagnose.selection.state_evidence import curious
from harness.diagnose.selection.study import Study
from harness.diagnose.selection.wald_test import rise_without


def by_free_runs(study: Study, fitted: Fit) -> float:
    """−2 log of how likely free runs of a set make the recordings, what they leave being as loud as it is, with the price of its
    numbers and of its members (``Study.criterion``).

    Under noise as loud as one set leaves, another that leaves a thousandth of that would be likelier by no more than there are
    samples.
    """
    loud = max(fitted.cost / study.samples, QUIETEST_VARIANCE)
    return study.criterion(fitted) - fitted.cost + study.samples * (1.0 + float(np.log(loud)))


def fit_ordinary(study: Study, near: Fit) -> None:
    """Fits of ordinary laws at every joint, which a search that weighs laws beside a force may never have asked for, and of what is
    left of them as members go that free runs are likelier without, the one first that the linear view misses least.

    near: a fit that states are begun from.
    """
    nominal = len(study.predictor.nominal)
    for fitted in ordinary_everywhere(study, near):
        left = fitted
        while (count := len(left.hypothesis.members)) > 1:
            smaller = study.reduce(left, int(np.argmin([rise_without(left, nominal, k) for k in range(count)])))
            if by_free_runs(study, smaller) > by_free_runs(study, left):
                break
            left = smaller


def plain_laws(outcome: Outcome, best: Fit, *, sure: bool) -> Fit | None:
    """The fewest plain laws that by free runs are likelier than a set beyond doubt, and foretell clearly more; None where none do.

    best: the set that stands beside the force; sure: whether the evidence there speaks for any member of it beyond doubt, so that
    others have to foretell amply more. Where that set runs so well only with nominal quantities far outside their tolerance, the
    drawing speaks against it, and laws that need none of that have to foretell no worse.
    """
    study = outcome.study
    plain = [
        (by_free_runs(study, f), f)
        for f in study.fits.values()
        if f.hypothesis.members and f.score < LOST and not curious(f)
    ]
    limit = by_free_runs(study, best) - UNPARTED_EVIDENCE
    lowest = min((value for value, _ in plain), default=limit)
    if lowest >= limit:
        return None
    likeliest = [row for row in plain if row[0] < min(lowest + UNPARTED_EVIDENCE, limit)]
    _, fewest = min(likeliest, key=lambda row: (len(row[1].hypothesis.members), row[0]))
    times = AMPLY_CARRIES_RATIO if sure else CARRIES_RATIO
    if study.stretched(best) and not study.stretched(fewest):
        times = 1.0
    return fewest if times**2 * judge(outcome, fewest).cost < judge(outcome, best).cost else None
