"""Several members that a single force or jump that nobody has named explains, better than they do together.

A force of a shape that the catalogue does not have may be pieced together from several that it has. Beside a remainder every
force that nobody has named explains something; only what brings what it promises is then asked for, of single members too.
"""

from __future__ import annotations

from harness.diagnose.criticism.alternatives import imitated
from harness.diagnose.criticism.constants import UNNAMED_FORCE_BETTER
from harness.diagnose.criticism.reason import Reason, Suspect


def _one_does(suspect: Suspect) -> bool:
    exact = suspect.remains.significant
    return imitated(suspect.outcome.study, suspect.best, suspect.smaller, UNNAMED_FORCE_BETTER, exact=exact)


REASON = Reason("one force that nobody has named does better", _one_does, together=True)
