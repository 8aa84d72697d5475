"""Plain laws that are told where the evidence beside a force over the state and free runs do not agree.

A force over the state that nobody has named can be bent to nearly anything. Recordings of one kind of motion then hardly part one
law beside it from another, or from none, while free runs without it are left far nearer by some laws than by others. A law that
stands beside the force and foretells the data held out amply worse than others do is not borne out; these others may not be
claimed either, but who has to act on the answer should know of them.
"""

from __future__ import annotations

from harness.diagnose.criticism.constants import AMPLY_CARRIES_RATIO, CARRIES_RATIO
from harness.diagnose.estimation.constants import LOST
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.constants import UNPARTED_EVIDENCE
from harness.diagnose.selection.outcome import Outcome, judge
from harness.diagnose.selection.state_evidence import curious


def plain_laws(outcome: Outcome, best: Fit, *, sure: bool) -> Fit | None:
    """The fewest plain laws that by free runs are likelier than a set beyond doubt, and foretell clearly more; None where none do.

    best: the set that stands beside the force; sure: whether the evidence there speaks for any member of it beyond doubt, so that
    others have to foretell amply more. What is left counts as noise as loud as that set leaves it. Where that set runs so well only
    with nominal quantities far outside their tolerance, the drawing speaks against it, and laws that need none of that have to
    foretell no worse.
    """
    study = outcome.study
    plain = [f for f in study.fits.values() if f.hypothesis.members and f.score < LOST and not curious(f)]
    lowest = min(map(study.criterion, plain), default=0.0)
    if not plain or lowest >= study.criterion(best) - UNPARTED_EVIDENCE:
        return None
    likeliest = [
        f
        for f in plain
        if study.criterion(f) < min(lowest + UNPARTED_EVIDENCE, study.criterion(best) - UNPARTED_EVIDENCE)
    ]
    fewest = min(likeliest, key=lambda f: (len(f.hypothesis.members), study.criterion(f)))
    times = AMPLY_CARRIES_RATIO if sure else CARRIES_RATIO
    if study.stretched(best) and not study.stretched(fewest):
        times = 1.0
    return fewest if times**2 * judge(outcome, fewest).cost < judge(outcome, best).cost else None
