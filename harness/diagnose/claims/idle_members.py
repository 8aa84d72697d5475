"""Members that beside a force over the state are as good as absent, and are then not told."""

from __future__ import annotations

import numpy as np

from harness.diagnose.estimation.constants import NORMAL_95
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.prediction.coordinates import from_internal
from harness.diagnose.selection.outcome import Outcome
from harness.diagnose.selection.state_evidence import Evidence


def without_idle(outcome: Outcome, best: Fit) -> Fit:
    """A set without members whose interval beside the force holds their absence; as it is where no force is left out.

    What a member gains is the square of its distance from absence over its deviation (Wald's test): within the interval that is
    less than any member costs. A search that was cut short, and the choice of the plainest among sets that are as likely, which
    goes by free runs, leave such members in.
    """
    while outcome.evidence is not None and best.hypothesis.members:
        off = [_off(outcome, outcome.evidence, best, k) for k in range(len(best.hypothesis.members))]
        if min(off) >= 1.0:
            break
        best = outcome.study.reduce(best, int(np.argmin(off)))
    return best


def _off(outcome: Outcome, evidence: Evidence, best: Fit, k: int) -> float:
    """How far a member's first number is from its absence, in halves of its interval; infinite where that is not known."""
    member, found = best.hypothesis.members[k], evidence.beside(outcome.study, best)
    if not member.effect.parameters or not np.isfinite(neutral := member.effect.parameters[0].neutral):
        return np.inf
    count, span = len(outcome.predictor.nominal), best.hypothesis.span(k)
    own, spread = found.x[count:][span], found.spread[count:][span]
    if not np.isfinite(spread[0]):
        return np.inf  # where the force was not fitted beside it, nothing is known
    sides = np.zeros((3, len(own)))
    sides[:, 0] = np.array([-NORMAL_95, 0.0, NORMAL_95]) * spread[0]
    low, value, high = (float(from_internal(member, own + side)[0]) for side in sides)
    return abs(value - neutral) / (0.5 * abs(high - low)) if high != low else np.inf
