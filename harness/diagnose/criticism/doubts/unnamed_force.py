"""A member in whose place a force or error that nobody has named does better, where nothing is left or a force is left out."""

from __future__ import annotations

from harness.diagnose.criticism.alternatives import imitated
from harness.diagnose.criticism.constants import UNNAMED_FORCE_BETTER
from harness.diagnose.criticism.members import beside_force
from harness.diagnose.criticism.reason import Reason, Suspect


def _does_better(suspect: Suspect) -> bool:
    study, best, remains = suspect.outcome.study, suspect.best, suspect.remains
    if not remains.significant:
        return imitated(study, best, suspect.smaller, UNNAMED_FORCE_BETTER)
    if not beside_force(suspect.outcome, best, suspect.places[0]):
        return False
    # A force that nobody has named, and that has this law in it, explains what is left beside the law as well.
    beside = max((min(t.worth(study.samples), best.score) for t in remains.tests if t.places >= 0), default=0.0)
    return imitated(study, best, suspect.smaller, UNNAMED_FORCE_BETTER + max(beside, 0.0))


REASON = Reason("a force that nobody has named does better", _does_better)
