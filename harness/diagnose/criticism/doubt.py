"""What must be doubted: findings that something nobody has named could have made. Each reason is a file of ``doubts/``."""

from __future__ import annotations

from itertools import combinations

from harness.diagnose.criticism.doubts.catalogue import reasons
from harness.diagnose.criticism.reason import suspect
from harness.diagnose.criticism.remainder import Remains
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.outcome import Outcome


def doubtful(outcome: Outcome, best: Fit, k: int, remains: Remains) -> bool:
    """Whether member ``k`` may only stand in for something that nobody has named."""
    one = suspect(outcome, best, [k], remains)
    return any(reason.holds(one) for reason in reasons().values() if not reason.together)


def doubtful_together(outcome: Outcome, best: Fit, remains: Remains) -> list[str]:
    """Members that only together may stand in for something that nobody has named; beside a remainder single ones too."""
    found: list[str] = []
    members = range(len(best.hypothesis.members))
    for size in range(1 if remains.significant else 2, len(members) + 1):
        for some in combinations(members, size):
            several = suspect(outcome, best, some, remains)
            if any(reason.holds(several) for reason in reasons().values() if reason.together):
                found += [key for key in (best.hypothesis.keys[k] for k in some) if key not in found]
    return found
