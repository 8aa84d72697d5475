"""Recordings that go on moving where dry friction holds the model."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from harness.diagnose.fit import Fit
from harness.diagnose.investigate import Outcome
from harness.diagnose.remainder import Test
from harness.diagnose.windows import Window
from harness.effects.effect import Family

Array = NDArray[np.float64]

WHERE_HELD = "motion where dry friction holds the model"
MOSTLY = 0.5  # of what a member explains, and of a stretch
FEWEST = 8  # samples of a stretch
STILL = 1e-3  # of the noise, by which a prediction that stands still changes from sample to sample at most


def creeps(outcome: Outcome, best: Fit, k: int) -> bool:
    """Whether member ``k`` mostly explains that recordings move where dry friction holds the model without it.

    Friction that gives way slowly (as lubricants do, and as most simulators have it) keeps nothing at rest. Beside dry friction
    that holds its joint for good, anything that frees it, such as a base that shakes, would seem to be there. Where a joint
    rests is another matter: a tilted base moves that, and holds it there. Of what a sensor does, which never rests, only how
    readings change within a stretch in which the model stands still is counted. All other effects stand as they are beside the
    member: fitted without it, they would give way as well.
    """
    effect = best.hypothesis.members[k].effect
    if effect.family is Family.DISSIPATION:
        return False
    without = outcome.study.standing_without(best, k)
    frees = effect.side == "dynamics"
    there = total = 0.0
    with_it = {window: (still, rows) for window, still, rows in _predicted(outcome, best)}
    for window, still, before in _predicted(outcome, without):
        rests, after = with_it[window]
        total += float(np.sum(before**2) - np.sum(after**2))
        for first, last in _stretches(still):
            one, other = before[:, first:last], after[:, first:last]
            if not frees:
                there += _variation(one) - _variation(other)
            elif np.mean(rests[first:last]) < 1.0 - MOSTLY:
                there += float(np.sum(one**2) - np.sum(other**2))
    return there > MOSTLY * total > 0.0


def motion_where_held(outcome: Outcome, fitted: Fit) -> Test | None:
    """A test of whether readings change where dry friction holds the model, if it does anywhere; names the plainest stretch."""
    found: list[tuple[float, int, str]] = []
    for window, still, rows in _predicted(outcome, fitted):
        run = outcome.problem.runs[window.run]
        for first, last in _stretches(still):
            begun = run.time[window.first + first] - run.time[0]
            found.append(
                (_variation(rows[:, first:last]), rows[:, first + 1 : last].size, f"{run.name} from {begun:.3g} s on")
            )
    if not found:
        return None
    cost, size = sum(c for c, _, _ in found), sum(n for _, n, _ in found)
    _, _, where = max(found)
    return Test(WHERE_HELD, cost - size, size, float(chi2.sf(cost, size)), (where,), -1)


def _predicted(outcome: Outcome, fitted: Fit) -> Iterator[tuple[Window, NDArray[np.bool_], Array]]:
    """Every window with where the prediction stands still, (T,), and what it leaves, in deviations of the noise, (C, T)."""
    lanes = [(0, window, fitted.states[window]) for window in fitted.windows]
    predicted = outcome.predictor.predict(fitted.hypothesis, fitted.x[None], lanes)
    slow = STILL * np.array([[colour.std] for colour in outcome.study.likelihood.colours])
    for window, channels, left in zip(fitted.windows, predicted, fitted.linear.residuals, strict=True):
        still = np.all(np.abs(np.diff(channels, axis=1)) <= slow, axis=0)
        yield window, np.append(still, still[-1:]), left.reshape(len(channels), -1)


def _stretches(still: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First sample of every stretch that is still, and the one after its last."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]]).astype(int)))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2) if b - a >= FEWEST]


def _variation(rows: Array) -> float:
    """Squares of what changes within a stretch, (C, T)."""
    return float(np.sum((rows - rows.mean(axis=1, keepdims=True)) ** 2))
