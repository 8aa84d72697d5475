"""What may have bent a set's nominal quantities out of their tolerance: effects that do to the prediction what bending does.

Score tests pass such effects by. Bent by a dozen deviations, nominal quantities imitate an effect to less than the linear view is
good to, and only the tolerance speaks against them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.prediction.coordinates import to_internal
from harness.diagnose.problem.hypothesis import Candidate, compatible, dear
from harness.diagnose.selection.constants.search import BENT_ALIKE_SHARE, BENT_BACK_STEPS
from harness.diagnose.selection.constants.starts import GREATEST_START_RATIO
from harness.diagnose.selection.multi_start import bent_back
from harness.diagnose.selection.rewrite import Rewrite, Room, Turn
from harness.diagnose.selection.score_tests import brought_near, may_reverse, near_changes, nuisance
from harness.diagnose.selection.starts import rays
from harness.diagnose.selection.study import Study

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Straight:
    """A candidate that could stand for how a fit is bent. gain: what it takes off the prior; start: of a fit with it."""

    candidate: Candidate
    gain: float
    start: Array


def _fits(study: Study, fitted: Fit, room: Room) -> list[Fit]:
    """Fits with one more effect each, that may have bent the nominal quantities of a set; the most promising ones."""
    found = []
    for straight in bending(study, fitted)[: room.count]:
        hypothesis = fitted.hypothesis.with_(straight.candidate)
        found.append(bent_back(study, fitted, straight.start, hypothesis, most_steps=BENT_BACK_STEPS))
    return found


def bending(study: Study, fitted: Fit) -> list[Straight]:
    """Candidates that could stand for how a fit's nominal quantities are bent, best first."""
    open_ones = [c for c in study.candidates if not dear(c) and compatible(fitted.hypothesis, c)]
    lines = [[line for line in rays(c, study.problem) if len(line) == 1][:1] for c in open_ones]
    asked = [(c, own[0]) for c, own in zip(open_ones, lines, strict=True) if own]
    near = near_changes(
        fitted, study.predictor, study.likelihood, [c for c, _ in asked], [list(own) for _, own in asked], {}
    )
    states = nuisance(fitted, study.predictor).states
    adjustable = _without(states, fitted.linear.shared)
    found = []
    for (candidate, _), (points, changes, factors) in zip(asked, near, strict=True):
        if all(np.isfinite(part).all() for part in changes):
            change = _without(states, [part.T for part in changes])
            found += _stands_for(study, fitted, candidate, points[0], factors[0], adjustable, change[:, 0])
    return sorted(found, key=lambda s: -s.gain)


def _stands_for(
    study: Study, fitted: Fit, candidate: Candidate, point: Array, factor: float, adjustable: Array, change: Array
) -> list[Straight]:
    """The candidate if bending can undo what it does (M,), and it then takes something off the prior."""
    k = len(study.predictor.nominal)
    # As the tolerance wants it: no quantity is bent for what the recordings do not see.
    held = np.eye(k, adjustable.shape[1])
    parts = np.linalg.lstsq(np.vstack([adjustable, held]), np.concatenate([change, np.zeros(k)]), rcond=None)[0]
    left = change - adjustable @ parts
    bends, bent = parts[:k], fitted.x[:k]
    weight = float(bends @ bends)
    if not (float(left @ left) < BENT_ALIKE_SHARE * float(change @ change) and weight > 0.0):
        return []
    amount = float(bent @ bends) / weight
    if amount <= 0.0 and not may_reverse(candidate):
        return []
    amount = float(np.clip(amount, -GREATEST_START_RATIO / factor, GREATEST_START_RATIO / factor))
    own = np.clip(brought_near(candidate, point, amount), candidate.effect.lower, candidate.effect.upper)
    # What the candidate does, all others undo.
    start = np.concatenate([fitted.x - amount * parts, to_internal(candidate, own)])
    return [Straight(candidate, amount**2 * weight, start)]


def _without(states: Sequence[Array], columns: Sequence[Array]) -> Array:
    """Columns (M, K) of every window without what its initial state, an orthonormal basis (M, S), can do; all windows stacked."""
    return np.vstack([own - q @ (q.T @ own) for q, own in zip(states, columns, strict=True)])


REWRITE = Rewrite("what may have bent the nominal quantities", _fits, (Turn.STRAIGHTER,))
