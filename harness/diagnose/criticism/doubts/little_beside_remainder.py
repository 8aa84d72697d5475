"""A member that predictions do not need, and that explains little beside what is left, or no more than an unnamed force."""

from __future__ import annotations

from harness.diagnose.criticism.alternatives import imitated
from harness.diagnose.criticism.constants import FAKED_RATIO
from harness.diagnose.criticism.held_out import firm
from harness.diagnose.criticism.members import beside_force
from harness.diagnose.criticism.reason import Reason, Suspect
from harness.diagnose.criticism.remainder import excess


def _little(suspect: Suspect) -> bool:
    outcome, best, smaller, remains = suspect.outcome, suspect.best, suspect.smaller, suspect.remains
    (k,) = suspect.places
    if not remains.significant or beside_force(outcome, best, k):
        return False
    study = outcome.study
    if smaller.score - best.score >= FAKED_RATIO * excess(study, best, remains) and not imitated(study, best, smaller):
        return False
    return not firm(outcome, best, k)


REASON = Reason("the remainder might have faked it", _little)
