"""A member that mostly explains that recordings move where dry friction holds the model without it.

Friction that gives way slowly (as lubricants do, and as most simulators have it) keeps nothing at rest. Beside dry friction
that holds its joint for good, anything that frees it, such as a base that shakes, would seem to be there. Where a joint
rests is another matter: a tilted base moves that, and holds it there. Of what a sensor does, which never rests, only how
readings change within a stretch in which the model stands still is counted. All other effects stand as they are beside the
member: fitted without it, they would give way as well.
"""

from __future__ import annotations

import numpy as np

from harness.diagnose.criticism.constants import CREEP_SHARE, CREEP_SPEED_SHARE
from harness.diagnose.criticism.reason import Reason, Suspect
from harness.diagnose.criticism.where_held import predicted, still, stretches, variation
from harness.effects.effect import Family


def _creeps(suspect: Suspect) -> bool:
    study, best = suspect.outcome.study, suspect.best
    effect = suspect.effects[0]
    if effect.family is Family.DISSIPATION:
        return False
    without = study.standing_without(best, suspect.places[0])
    frees = effect.side == "dynamics"
    there = total = 0.0
    with_it = {window: (steps, rows) for window, steps, rows in predicted(study, best)}
    fastest = np.max([steps.max(axis=1) for steps, _ in with_it.values()], axis=0)
    for window, steps, before in predicted(study, without):
        moved, after = with_it[window]
        total += float(np.sum(before**2) - np.sum(after**2))
        for first, last in stretches(still(steps)):
            one, other = before[:, first:last], after[:, first:last]
            if not frees:
                there += variation(one) - variation(other)
                continue
            rests = np.mean(still(moved)[first:last]) >= 1.0 - CREEP_SHARE
            # A swing that goes on because there is more behind it is no creep.
            slow = bool(np.all(moved[:, first:last].max(axis=1) <= CREEP_SPEED_SHARE * fastest))
            if slow and not rests:
                there += float(np.sum(one**2) - np.sum(other**2))
    return there > CREEP_SHARE * total > 0.0


REASON = Reason("it only frees what dry friction would hold", _creeps)
