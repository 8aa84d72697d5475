"""A set without members, and without generality, that do not pay for themselves beside the others."""

from __future__ import annotations

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.selection.rewrite import Room, Turn
from harness.diagnose.selection.rewrites.catalogue import rewritten
from harness.diagnose.selection.study import Study


def pruned(study: Study, fitted: Fit, louder: float = 1.0) -> Fit:
    """The set without members, and without generality, that do not pay for themselves beside the others.

    louder: variance of the noise, in units of what it is taken to be: what the set leaves, where that is no noise.
    """

    def criterion(of: Fit) -> float:
        return study.criterion(of) - of.score * (1.0 - 1.0 / louder)

    while fitted.hypothesis.members:
        fewer = [study.reduce(fitted, k) for k in range(len(fitted.hypothesis.members))]
        smaller = min(
            [*fewer, *(f for _, own in rewritten(study, fitted, Turn.PRUNING, Room()) for f in own)], key=criterion
        )
        if criterion(smaller) > criterion(fitted):
            break
        fitted = smaller
    return fitted
