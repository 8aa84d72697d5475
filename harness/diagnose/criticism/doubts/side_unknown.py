"""A stop, or another thing that acts from a place on, of which not even the side of the middle is known: it is then no stop."""

from __future__ import annotations

from harness.diagnose.criticism.members import nowhere
from harness.diagnose.criticism.reason import Reason, Suspect


def _unknown(suspect: Suspect) -> bool:
    return nowhere(suspect.outcome, suspect.best, suspect.places[0])


REASON = Reason("not even its side is known", _unknown)
