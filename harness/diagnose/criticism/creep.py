"""Recordings that go on moving where dry friction holds the model."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from harness.diagnose.criticism.probe import Test
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.problem.windows import Window
from harness.diagnose.selection.investigation import Outcome
from harness.effects.effect import Family

Array = NDArray[np.float64]

WHERE_HELD = "motion where dry friction holds the model"
MOSTLY = 0.5  # of what a member explains, and of a stretch
FEWEST = 8  # samples of a stretch
SLOWLY = 0.2  # of the fastest motion, up to which a joint creeps
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
    with_it = {window: (steps, rows) for window, steps, rows in _predicted(outcome, best)}
    fastest = np.max([steps.max(axis=1) for steps, _ in with_it.values()], axis=0)
    for window, steps, before in _predicted(outcome, without):
        moved, after = with_it[window]
        total += float(np.sum(before**2) - np.sum(after**2))
        for first, last in _stretches(_still(steps)):
            one, other = before[:, first:last], after[:, first:last]
            if not frees:
                there += _variation(one) - _variation(other)
                continue
            rests = np.mean(_still(moved)[first:last]) >= 1.0 - MOSTLY
            # A swing that goes on because there is more behind it is no creep.
            slow = bool(np.all(moved[:, first:last].max(axis=1) <= SLOWLY * fastest))
            if slow and not rests:
                there += float(np.sum(one**2) - np.sum(other**2))
    return there > MOSTLY * total > 0.0


def motion_where_held(outcome: Outcome, fitted: Fit) -> Test | None:
    """A test of whether readings change where dry friction holds the model, if it does anywhere; names the plainest stretch."""
    found: list[tuple[float, int, str]] = []
    for window, steps, rows in _predicted(outcome, fitted):
        run = outcome.problem.runs[window.run]
        for first, last in _stretches(_still(steps)):
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
    """Every window with how far the prediction goes to the next sample and what it leaves, in deviations of the noise, (C, T)."""
    lanes = [(0, window, fitted.states[window]) for window in fitted.windows]
    predicted = outcome.predictor.predict(fitted.hypothesis, fitted.x[None], lanes)
    noise = np.array([[colour.std] for colour in outcome.study.likelihood.colours])
    for window, channels, left in zip(fitted.windows, predicted, fitted.linear.residuals, strict=True):
        steps = np.abs(np.diff(channels, axis=1)) / noise
        yield window, np.hstack([steps, steps[:, -1:]]), left.reshape(len(channels), -1)


def _still(steps: Array) -> NDArray[np.bool_]:
    """Where a prediction stands still, (T,)."""
    return np.asarray(np.all(steps <= STILL, axis=0))


def _stretches(still: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First sample of every stretch that is still, and the one after its last."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]]).astype(int)))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2) if b - a >= FEWEST]


def _variation(rows: Array) -> float:
    """Squares of what changes within a stretch, (C, T)."""
    return float(np.sum((rows - rows.mean(axis=1, keepdims=True)) ** 2))
