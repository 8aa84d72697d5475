"""A base that is taken to shake sideways where one that moves up and down does as well: either is as likely."""

from __future__ import annotations

from harness.diagnose.criticism.alternatives import do_better
from harness.diagnose.criticism.members import shakes
from harness.diagnose.criticism.reason import Reason, Suspect
from harness.diagnose.criticism.shaken_support import shaken_sideways, shaken_up_and_down


def _as_well(suspect: Suspect) -> bool:
    study, best, smaller = suspect.outcome.study, suspect.best, suspect.smaller
    if not shakes(best.hypothesis.members[suspect.places[0]]):
        return False
    vertical = shaken_up_and_down(study, smaller)
    if vertical is None:
        return False
    if do_better(study, best, smaller, [vertical]):
        return True
    if not suspect.remains.significant:
        return False
    # What does not explain all has only gained more by a fit than the other by a linear view, where the swing is changed much.
    sideways = shaken_sideways(study, smaller)
    return sideways is not None and vertical.worth(study.samples) > sideways.worth(study.samples)


REASON = Reason("a support that moves up and down does as well", _as_well)
