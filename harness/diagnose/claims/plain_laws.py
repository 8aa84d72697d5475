"""Plain laws that are told where the evidence beside a force over the state and free runs do not agree.

A force over the state that nobody has named can be bent to nearly anything. Recordings of one kind of motion then hardly part one
law beside it from another, or from none, while free runs without it are left far nearer by some laws than by others. A law that
stands beside the force and foretells the data held out worse than others do is not borne out; these others may not be claimed
either, but who has to act on the answer should know of them.
"""

from __future__ import annotations

from harness.diagnose.claims.rivals import APART
from harness.diagnose.criticism.held_out import CARRIES
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.objective import LOST
from harness.diagnose.selection.investigation import Outcome, judge
from harness.diagnose.selection.state_evidence import curious

ASKED = 3  # of the likeliest such sets, which are judged on the data held out


def plain_laws(outcome: Outcome, best: Fit) -> Fit | None:
    """The plain laws that by free runs are likelier than a set beyond doubt, and foretell clearly more; None where none do.

    best: the set that stands beside the force. What is left counts as noise as loud as that set leaves it.
    """
    study = outcome.study
    limit = study.criterion(best) - APART
    plain = [f for f in study.fits.values() if f.hypothesis.members and f.score < LOST and not curious(f)]
    likelier = sorted((f for f in plain if study.criterion(f) < limit), key=study.criterion)[:ASKED]
    own = judge(outcome, best).cost
    return next((f for f in likelier if CARRIES**2 * judge(outcome, f).cost < own), None)
