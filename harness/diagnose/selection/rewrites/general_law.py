"""A law of which a member is a special case, begun from what the member was fitted to.

A score test from absence cannot see such a law behind its special case: they act alike to first order.
"""

from __future__ import annotations

import numpy as np

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.problem.hypothesis import compatible, contains
from harness.diagnose.selection.constants.search import NEAR_EVIDENCE
from harness.diagnose.selection.rewrite import Rewrite, Room, Turn
from harness.diagnose.selection.starts import like
from harness.diagnose.selection.study import Study


def generalized(study: Study, base: Fit) -> list[Fit]:
    """Fits with a member replaced by a law of which it is a special case, begun from what the member was fitted to."""
    found = []
    for k, member in enumerate(base.hypothesis.members):
        values = study.predictor.effect_values(base.hypothesis, k, base.x)
        for wider in study.candidates:
            if not contains(wider, member):
                continue
            rest = base.hypothesis.without(k)
            if not compatible(rest, wider):
                continue
            hypothesis = rest.with_(wider)
            known = study.known(hypothesis) if study.was_exchanged(base, wider) else None
            if known is None:
                others = study.without(base, k)
                starts = [
                    np.concatenate([others, to_internal(wider, p)]) for p in like(wider, float(values[0]), by_way=True)
                ]
                # Neither better than the special case nor near the best set, it would be of no use.
                within = min(base.score, min(f.score for f in study.fits.values()) + NEAR_EVIDENCE)
                known = study.fit(hypothesis, starts, base, target=within)
            found.append(known)
    return found


def _fits(study: Study, best: Fit, room: Room) -> list[Fit]:
    return generalized(study, best)


REWRITE = Rewrite("a more general law for a member", _fits, (Turn.WIDER,))
