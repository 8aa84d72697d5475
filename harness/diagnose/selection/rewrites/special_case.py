"""A special case of a member, begun from what the member was fitted to.

A fit of the special case that was begun elsewhere may have ended in a wrong valley.
"""

from __future__ import annotations

import numpy as np

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.problem.hypothesis import compatible, contains
from harness.diagnose.selection.constants.search import NEAR_EVIDENCE
from harness.diagnose.selection.rewrite import Rewrite, Room, Turn
from harness.diagnose.selection.study import Study


def specialized(study: Study, base: Fit) -> list[Fit]:
    """Fits with a member replaced by a special case of it, begun from what the member was fitted to."""
    found = []
    for k, member in enumerate(base.hypothesis.members):
        values = study.predictor.effect_values(base.hypothesis, k, base.x)
        rest = base.hypothesis.without(k)
        for simpler in study.candidates:
            if not contains(member, simpler):
                continue
            if not compatible(rest, simpler):
                continue
            hypothesis = rest.with_(simpler)
            known = study.known(hypothesis) if study.was_exchanged(base, simpler) else None
            if known is None:
                own = to_internal(simpler, values[: len(simpler.effect.parameters)])
                # Out of reach of this, it would be of no use, however few its parameters are.
                within = base.score + NEAR_EVIDENCE * study.loudness(base)
                known = study.fit(hypothesis, [np.concatenate([study.without(base, k), own])], base, target=within)
            found.append(known)
    return found


def _fits(study: Study, best: Fit, room: Room) -> list[Fit]:
    return specialized(study, best)


REWRITE = Rewrite("a special case for a member", _fits, (Turn.PRUNING,))
