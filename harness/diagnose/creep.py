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
MOSTLY = 0.5  # of what a member explains
FEWEST = 8  # samples of a stretch


def creeps(outcome: Outcome, smaller: Fit, best: Fit, k: int) -> bool:
    """Whether member ``k`` mostly explains that recordings move where dry friction holds the model without it.

    Friction that gives way slowly (as lubricants do, and as most simulators have it) keeps nothing at rest. The catalogue holds its
    joints for good, so anything that frees them, such as a base that shakes, would seem to be there. Where a joint rests is
    another matter: what is counted is how readings change within a stretch in which the model stands still.
    """
    if best.hypothesis.members[k].effect.family is Family.DISSIPATION:
        return False
    moving = total = 0.0
    residuals = dict(zip(best.windows, best.linear.residuals, strict=True))
    for window, channels, before in _predicted(outcome, smaller):
        after = residuals[window].reshape(before.shape)
        total += float(np.sum(before**2) - np.sum(after**2))
        for first, last in _held(channels):
            moving += _variation(before[:, first:last]) - _variation(after[:, first:last])
    return moving > MOSTLY * total > 0.0


def motion_where_held(outcome: Outcome, fitted: Fit) -> Test | None:
    """A test of whether readings change where dry friction holds the model, if it does anywhere; names the plainest stretch."""
    found: list[tuple[float, int, str]] = []
    for window, channels, rows in _predicted(outcome, fitted):
        run = outcome.problem.runs[window.run]
        for first, last in _held(channels):
            begun = run.time[window.first + first] - run.time[0]
            found.append(
                (_variation(rows[:, first:last]), rows[:, first + 1 : last].size, f"{run.name} from {begun:.3g} s on")
            )
    if not found:
        return None
    cost, size = sum(c for c, _, _ in found), sum(n for _, n, _ in found)
    _, _, where = max(found)
    return Test(WHERE_HELD, cost - size, size, float(chi2.sf(cost, size)), (where,), -1)


def _predicted(outcome: Outcome, fitted: Fit) -> Iterator[tuple[Window, Array, Array]]:
    """Every window with what a fit predicts there and what it leaves, in deviations of the noise, (C, T) each."""
    lanes = [(0, window, fitted.states[window]) for window in fitted.windows]
    predicted = outcome.predictor.predict(fitted.hypothesis, fitted.x[None], lanes)
    for window, channels, left in zip(fitted.windows, predicted, fitted.linear.residuals, strict=True):
        yield window, channels, left.reshape(len(channels), -1)


def _held(channels: Array) -> list[tuple[int, int]]:
    """Stretches of samples in which no predicted channel (C, T) changes at all."""
    still = np.concatenate([[False], np.all(np.diff(channels, axis=1) == 0.0, axis=0), [False]])
    edges = np.flatnonzero(np.diff(still.astype(int)))
    return [(int(a), int(b) + 1) for a, b in edges.reshape(-1, 2) if b + 1 - a >= FEWEST]


def _variation(rows: Array) -> float:
    """Squares of what changes within a stretch, (C, T)."""
    return float(np.sum((rows - rows.mean(axis=1, keepdims=True)) ** 2))
