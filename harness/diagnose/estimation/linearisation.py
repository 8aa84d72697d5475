"""Residuals and sensitivities of a hypothesis at a point, the initial states eliminated window by window.

Each window's residual and Jacobian are compressed by an orthogonal factorisation to a small triangle, from which the
step in the shared parameters, the initial states, score tests of further effects and the covariance all follow
(variable projection in the sense of Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.constants import (
    DIFFERENCE,
    FELT_CHANGE,
    LONGEST_DIFFERENCE,
    LONGEST_SHARP_DIFFERENCE,
    NARROWEST_ROOM,
    SHARP_CHANGE,
    SHORTEST_SHARP_DIFFERENCE,
    STEEPEST_SLOPE,
)
from harness.diagnose.estimation.objective import Objective, Residuals, States, price
from harness.diagnose.problem.windows import Window

Array = NDArray[np.float64]

BLOCK = 1024  # rows factorised at once, so that they stay in the cache


@dataclass(frozen=True, eq=False)
class Linearisation:
    """Residual and sensitivities of a hypothesis at a point, initial states eliminated.

    cost: sum of squared whitened residuals. residuals: per window, shape (M,).
    triangles: per window (R_ss, R_sp, r_s): how the state follows the parameters.
    matrix, vector: what is left for the shared parameters, rows of all windows stacked, shapes (W·P, P) and (W·P,).
    bases, shared: per window the Jacobians of the initial state (M, S) and of the shared parameters (M, P).
    """

    cost: float
    residuals: tuple[Array, ...]
    triangles: tuple[tuple[Array, Array, Array], ...]
    matrix: Array
    vector: Array
    bases: tuple[Array, ...]
    shared: tuple[Array, ...]


def linearise(
    objective: Objective,
    x: Array,
    states: States,
    *,
    upper: Array | None = None,
    fixed: NDArray[np.bool_] | None = None,
    known: Residuals | None = None,
    nearby: Linearisation | None = None,
) -> Linearisation:
    """Residuals and Jacobian by differences, all lanes of all windows at once; known: the residuals if they are at hand.

    nearby: a linear view of a point not far off, whose slopes say how long the steps of weak parameters have to be. upper: bounds
    beyond which no parameter is moved; fixed: parameters that are not moved at all.
    """
    predictor, hypothesis, windows = objective.predictor, objective.hypothesis, objective.windows
    size = len(x)
    moves = [k for k in range(size) if fixed is None or not fixed[k]]
    vectors = np.tile(x, (1 + len(moves), 1))
    steps = np.zeros(len(moves))
    felt = np.full(size, DIFFERENCE) if nearby is None else telling_steps(nearby)
    for row, k in enumerate(moves):
        step = max(float(felt[k]), 1e-9 * abs(x[k]))
        if upper is not None and x[k] + step > upper[k]:
            step = -step
        steps[row] = step
        vectors[row + 1, k] += step
    lanes: list[tuple[int, Window, Array]] = []
    # Stiff runs choose their steps together: only what has run beside the others may be subtracted from them.
    beside = known is None or predictor.shortened(hypothesis)
    first = 0 if beside else 1
    # What follows by loops is where the others ask for it, however it is moved.
    own = np.flatnonzero(~predictor.following(hypothesis)).tolist()
    for window in windows:
        s = states[window]
        lanes += [(row, window, s) for row in range(first, len(vectors))]
        for j in own:
            moved = s.copy()
            moved[j] += DIFFERENCE * max(1.0, abs(s[j]))
            lanes.append((0, window, moved))
    predictions = predictor.predict(hypothesis, vectors, lanes)
    cost = 0.0 if known is None else known[0]
    residuals, bases, shared = [], [], []
    count = len(predictions) // len(windows)
    for number, (window, white) in enumerate(
        zip(windows, objective.likelihood.whiten_windows(windows, predictions), strict=True)
    ):
        s = states[window]
        n = len(s)
        here = white[0] if known is None else known[1][number]
        if known is None:
            cost += price(here, predictions[number * count])
        r, white = (white[0], white[1:]) if beside else (here, white)
        # State and shared parameters side by side.
        both = np.zeros((len(r), n + size), order="F")
        for row, k in enumerate(moves):
            np.divide(white[row] - r, steps[row], out=both[:, n + k])
        for row, j in enumerate(own, start=len(moves)):
            np.divide(white[row] - r, DIFFERENCE * max(1.0, abs(s[j])), out=both[:, j])
        # A moved run that has gone so far says nothing of a slope, and squares of it would leave the numbers.
        both[:, ~(np.abs(both).max(axis=0, initial=0.0) < STEEPEST_SLOPE)] = 0.0
        residuals.append(here)
        bases.append(both[:, :n])
        shared.append(both[:, n:])
    return eliminated(cost, residuals, bases, shared)


def _norms(view: Linearisation) -> Array:
    """How much a unit of each shared parameter changes the whitened prediction, shape (P,)."""
    return np.asarray(np.sqrt(sum(np.sum(columns**2, axis=0) for columns in view.shared)))


def telling_steps(nearby: Linearisation) -> Array:
    """Steps (P,) of the shared parameters that change the prediction enough to be told from the unevenness of its runs."""
    return np.asarray(np.clip(FELT_CHANGE / np.maximum(_norms(nearby), FELT_CHANGE), DIFFERENCE, LONGEST_DIFFERENCE))


def sharply(objective: Objective, x: Array, states: States, rough: Linearisation) -> Linearisation:
    """The same linear view with the sensitivities of the shared parameters good to many more digits.

    Of parameters whose effects nearly make up for one another, only a small difference of long columns is told by the data. The
    curvature in a simple difference quotient looks like such a difference, and intervals would be far too narrow. So these are
    central differences over steps that change the prediction alike, extrapolated (Richardson, Phil. Trans. A 210 (1911) 307).
    """
    norms = _norms(rough)
    steps = np.maximum(
        np.clip(SHARP_CHANGE / np.maximum(norms, 1e-300), SHORTEST_SHARP_DIFFERENCE, LONGEST_SHARP_DIFFERENCE),
        1e-9 * np.abs(x),
    )
    lower, upper = objective.bounds()
    room = np.minimum(x - lower, upper - x)
    # What stands at a bound cannot be moved both ways, what is held was not moved at all.
    moves = np.flatnonzero((norms > 0.0) & (room >= np.minimum(steps, NARROWEST_ROOM)))
    steps = np.minimum(steps, np.maximum(room, 0.0))
    if not len(moves):
        return rough
    points = []
    for k in moves:
        for share in (1.0, -1.0, 0.5, -0.5):
            points.append(x.copy())
            points[-1][k] += share * steps[k]
    found = [residuals for _, residuals in objective.residuals([(point, states) for point in points])]
    shared = []
    for number, columns in enumerate(rough.shared):
        sharp = np.array(columns)
        for j, k in enumerate(moves):
            far, back, near, nearly_back = (found[4 * j + i][number] for i in range(4))
            quotient = (8.0 * (near - nearly_back) - (far - back)) / (6.0 * steps[k])
            if np.isfinite(quotient).all():
                sharp[:, k] = quotient
        shared.append(sharp)
    return eliminated(rough.cost, rough.residuals, rough.bases, shared)


def eliminated(
    cost: float, residuals: Sequence[Array], bases: Sequence[Array], shared: Sequence[Array]
) -> Linearisation:
    """The linear view of residuals (M,) and their Jacobians (M, S) and (M, P) with the initial states eliminated."""
    triangles, rows, right = [], [], []
    for r, js, jp in zip(residuals, bases, shared, strict=True):
        n, size = js.shape[1], jp.shape[1]
        # State, shared parameters, residual side by side, and rows below them that keep an unseen state from running away.
        stacked = np.zeros((len(r) + n, n + size + 1), order="F")
        stacked[: len(r), :n], stacked[: len(r), n:-1], stacked[: len(r), -1] = js, jp, r
        stacked[len(r) :, :n] = 1e-9 * np.eye(n)
        triangle = _triangle(stacked)[: n + size + 1]
        triangles.append((triangle[:n, :n], triangle[:n, n : n + size], triangle[:n, -1]))
        rows.append(triangle[n:, n : n + size])
        right.append(triangle[n:, -1])
    return Linearisation(
        cost, tuple(residuals), tuple(triangles), np.vstack(rows), np.concatenate(right), tuple(bases), tuple(shared)
    )


def _triangle(tall: Array) -> Array:
    """R of a tall matrix's QR factorisation, by blocks of rows (Demmel et al., SIAM J. Sci. Comput. 34 (2012) A206)."""
    if len(tall) <= 2 * BLOCK:
        return np.asarray(np.linalg.qr(tall, mode="r"))
    parts = [np.linalg.qr(part, mode="r") for part in np.array_split(tall, len(tall) // BLOCK)]
    return np.asarray(np.linalg.qr(np.vstack(parts), mode="r"))


def vibrating(here: Linearisation, stiff: Array) -> float:
    """How many initial states of vibrations the data tell, of all windows: what they take of the noise with them.

    stiff: one over what a vibration may plausibly begin with, zero for joints, (S,). Each counts by the share of its variance that
    the data take away (the effective number of parameters of a ridge regression).
    """
    own = np.flatnonzero(stiff > 0.0)
    if not len(own):
        return 0.0
    order = np.concatenate([np.flatnonzero(stiff == 0.0), own])
    total = 0.0
    for states, _, _ in here.triangles:
        beside = np.asarray(np.linalg.qr(states[:, order], mode="r"))[-len(own) :, -len(own) :]
        squares = np.linalg.svd(beside / stiff[own], compute_uv=False) ** 2
        total += float(np.sum(squares / (1.0 + squares)))
    return total
