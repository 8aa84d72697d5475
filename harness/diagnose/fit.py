"""Least squares of a hypothesis on windows: Levenberg–Marquardt with the initial states eliminated window by window.

Each window's residual and Jacobian are compressed by an orthogonal factorisation to a small triangle, from which the
step in the shared parameters, the initial states, score tests of further effects and the covariance all follow
(variable projection in the sense of Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr, solve_triangular

from harness.diagnose.coordinates import internal_bounds
from harness.diagnose.hypothesis import Hypothesis
from harness.diagnose.likelihood import Likelihood
from harness.diagnose.predict import Predictor
from harness.diagnose.window_states import LOST, Residuals, best_states, loosely_held, price, settled, suspects
from harness.diagnose.windows import Window

Array = NDArray[np.float64]

# Relative step of difference quotients, in the fit's own coordinates (order one). Over a free run of a hundred radians
# curvature costs a ten thousandth of the quotient, which is less than most noise; rounding of the runs costs less still.
DIFFERENCE = 1e-6
HOPE = 6.0  # a step's predicted gain times this is the most that the rest of a search is expected to bring
HARDEST = 1e8  # damping beyond which no step helps
UNCHANGED = 3e-3  # a last step no longer than this (relative, at least to one) leaves the sensitivities as they are
ROUNDS = 3  # of bringing windows to better states and going on from there
SLOW = 1e-3  # of the cost, below which a step's gain by mixing states is not worth going on
CLEARLY = 0.8  # times its cost, below which a window is brought to another initial state
CURVED = 30.0  # times a step's length, beyond which what is added for its curvature is no correction
LANES = 8  # that run together at the price of one


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


@dataclass(frozen=True, eq=False)
class Fit:
    """The best point found. ``score`` is cost plus prior; ``converged`` says whether steps had become immaterial."""

    hypothesis: Hypothesis
    windows: tuple[Window, ...]
    x: Array
    states: Mapping[Window, Array]
    linear: Linearisation
    prior: float
    converged: bool
    free: NDArray[np.bool_]

    @property
    def cost(self) -> float:
        return self.linear.cost

    @property
    def score(self) -> float:
        return self.linear.cost + self.prior


def bounds(predictor: Predictor, hypothesis: Hypothesis) -> tuple[Array, Array]:
    """Lower and upper bounds of the parameter vector; nominal factors are held by their prior alone."""
    k = len(predictor.nominal)
    lower, upper = [np.full(k, -np.inf)], [np.full(k, np.inf)]
    for member in hypothesis.members:
        low, high = internal_bounds(member)
        lower.append(low)
        upper.append(high)
    return np.concatenate(lower), np.concatenate(upper)


def residuals_at(
    predictor: Predictor,
    likelihood: Likelihood,
    hypothesis: Hypothesis,
    windows: Sequence[Window],
    points: Sequence[tuple[Array, Mapping[Window, Array]]],
) -> list[Residuals]:
    """Residuals at several points (shared parameters, initial states), all lanes at once."""
    lanes = [(k, window, states[window]) for window in windows for k, (_, states) in enumerate(points)]
    predictions = predictor.predict(hypothesis, np.array([x for x, _ in points]), lanes)
    costs = [0.0] * len(points)
    residuals: list[list[Array]] = [[] for _ in points]
    for w, white in enumerate(likelihood.whiten_windows(windows, predictions)):
        chunk = predictions[w * len(points) : (w + 1) * len(points)]
        for k, r in enumerate(white):
            costs[k] += price(r, chunk[k])
            residuals[k].append(r)
    return [(cost, tuple(own)) for cost, own in zip(costs, residuals, strict=True)]


def linearise(
    predictor: Predictor,
    likelihood: Likelihood,
    hypothesis: Hypothesis,
    windows: Sequence[Window],
    x: Array,
    states: Mapping[Window, Array],
    *,
    upper: Array | None = None,
    fixed: NDArray[np.bool_] | None = None,
    state_damping: float = 0.0,
    known: Residuals | None = None,
) -> Linearisation:
    """Residuals and Jacobian by differences, all lanes of all windows at once; known: the residuals if they are at hand."""
    size = len(x)
    moves = [k for k in range(size) if fixed is None or not fixed[k]]
    vectors = np.tile(x, (1 + len(moves), 1))
    steps = np.zeros(len(moves))
    for row, k in enumerate(moves):
        step = DIFFERENCE * max(1.0, abs(x[k]))
        if upper is not None and x[k] + step > upper[k]:
            step = -step
        steps[row] = step
        vectors[row + 1, k] += step
    lanes: list[tuple[int, Window, Array]] = []
    # Stiff runs choose their steps together: only what has run beside the others may be subtracted from them.
    beside = known is None or predictor.shortened(hypothesis)
    first = 0 if beside else 1
    for window in windows:
        s = states[window]
        lanes += [(row, window, s) for row in range(first, len(vectors))]
        for j in range(len(s)):
            moved = s.copy()
            moved[j] += DIFFERENCE * max(1.0, abs(s[j]))
            lanes.append((0, window, moved))
    predictions = predictor.predict(hypothesis, vectors, lanes)
    cost = 0.0 if known is None else known[0]
    residuals, bases, shared = [], [], []
    count = len(predictions) // len(windows)
    for number, (window, white) in enumerate(
        zip(windows, likelihood.whiten_windows(windows, predictions), strict=True)
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
        for j in range(n):
            np.divide(white[len(moves) + j] - r, DIFFERENCE * max(1.0, abs(s[j])), out=both[:, j])
        residuals.append(here)
        bases.append(both[:, :n])
        shared.append(both[:, n:])
    return _eliminated(cost, residuals, bases, shared, state_damping)


def _eliminated(
    cost: float, residuals: Sequence[Array], bases: Sequence[Array], shared: Sequence[Array], state_damping: float = 0.0
) -> Linearisation:
    """The linear view with the initial states eliminated window by window."""
    triangles, rows, right = [], [], []
    for r, js, jp in zip(residuals, bases, shared, strict=True):
        n, size = js.shape[1], jp.shape[1]
        # State, shared parameters, residual side by side, and rows that keep the state from running away below them.
        stacked = np.zeros((len(r) + n, n + size + 1), order="F")
        stacked[: len(r), :n], stacked[: len(r), n:-1], stacked[: len(r), -1] = js, jp, r
        stacked[len(r) :, :n] = np.diag(np.sqrt(state_damping) * np.linalg.norm(js, axis=0) + 1e-9)
        triangle = _triangle(stacked)[: n + size + 1]
        triangles.append((triangle[:n, :n], triangle[:n, n : n + size], triangle[:n, -1]))
        rows.append(triangle[n:, n : n + size])
        right.append(triangle[n:, -1])
    return Linearisation(
        cost, tuple(residuals), tuple(triangles), np.vstack(rows), np.concatenate(right), tuple(bases), tuple(shared)
    )


SOFTEST = 1e-9  # least damping
BLOCK = 1024  # rows factorised at once, so that they stay in the cache


def _triangle(tall: Array) -> Array:
    """R of a tall matrix's QR factorisation, by blocks of rows (Demmel et al., SIAM J. Sci. Comput. 34 (2012) A206)."""
    if len(tall) <= 2 * BLOCK:
        return np.asarray(qr(tall, mode="r", check_finite=False)[0])
    parts = [
        qr(part, mode="r", check_finite=False)[0][: tall.shape[1]] for part in np.array_split(tall, len(tall) // BLOCK)
    ]
    return np.asarray(qr(np.vstack(parts), mode="r", check_finite=False)[0])


def fit(
    predictor: Predictor,
    likelihood: Likelihood,
    hypothesis: Hypothesis,
    windows: Sequence[Window],
    x: Array,
    states: Mapping[Window, Array],
    *,
    fixed: NDArray[np.bool_] | None = None,
    most_steps: int = 30,
    enough: float = 0.02,
    target: float = -np.inf,
    louder: float = 1.0,
    others: Sequence[Mapping[Window, Array]] = (),
) -> Fit:
    """Minimise whitened residuals plus the prior of the nominal quantities from one starting point.

    fixed: parameters that do not move. enough: a predicted gain in cost below this ends the search. target: a score that has
    to come within reach, or the search ends early. louder: variance that the residuals are taken to have beside the prior, in
    units of the noise's. others: further initial states; wherever a window does better with its own, it takes that.
    """
    x = np.clip(x, *bounds(predictor, hypothesis))
    doubled = _stated_twice(predictor, hypothesis)
    if doubled.any():
        x, fixed = np.where(doubled, 0.0, x), doubled if fixed is None else fixed | doubled
    if others:
        start, (cost, residuals) = best_states(predictor, likelihood, hypothesis, windows, x, [states, *others])
        if cost >= LOST:
            return _given_up(predictor, hypothesis, windows, x, start, cost, residuals)
        states = _unstuck(predictor, likelihood, hypothesis, windows, x, start, others, residuals)
    problem = predictor, likelihood, hypothesis, windows
    found = _descend(*problem, x, states, fixed, most_steps, enough, target, louder)
    for _ in range(ROUNDS if others else 0):
        again = _unstuck(*problem, found.x, found.states, others, found.linear.residuals)
        if again is found.states or found.score > target > -np.inf:
            break
        better = _descend(*problem, found.x, again, fixed, most_steps, enough, target, louder)
        if better.score > found.score - enough:
            break
        found = better
    return found


def _given_up(
    predictor: Predictor,
    hypothesis: Hypothesis,
    windows: Sequence[Window],
    x: Array,
    states: Mapping[Window, Array],
    cost: float,
    residuals: Sequence[Array],
) -> Fit:
    """The starting point itself, whose motion cannot be computed: there is nothing to descend along."""
    bases = [np.zeros((len(r), len(states[w]))) for r, w in zip(residuals, windows, strict=True)]
    shared = [np.zeros((len(r), len(x))) for r in residuals]
    prior = float(np.sum(x[: len(predictor.nominal)] ** 2))
    here = _eliminated(cost, residuals, bases, shared)
    return Fit(hypothesis, tuple(windows), x, states, here, prior, False, np.ones(len(x), dtype=bool))


def _stated_twice(predictor: Predictor, hypothesis: Hypothesis) -> NDArray[np.bool_]:
    """Which parameters are nominal dampings whose joint has a damping of its own among the effects: only the sum can be told."""
    damped = {member.site for member in hypothesis.members if member.effect.name == "viscous_damping"}
    doubled = np.zeros(predictor.size(hypothesis), dtype=bool)
    doubled[: len(predictor.nominal)] = [q.kind == "damping" and q.name in damped for q in predictor.nominal]
    return doubled


def _unstuck(
    predictor: Predictor,
    likelihood: Likelihood,
    hypothesis: Hypothesis,
    windows: Sequence[Window],
    x: Array,
    states: Mapping[Window, Array],
    others: Sequence[Mapping[Window, Array]],
    residuals: Sequence[Array],
) -> Mapping[Window, Array]:
    """The same states, those apart where a window that is fitted far worse than most does clearly better with another."""
    places = suspects(residuals)
    odd = [windows[k] for k in places]
    if not odd:
        return states
    found = settled(predictor, likelihood, hypothesis, odd, x, [states, *others])
    better = {
        windows[k]: found[windows[k]][0]
        for k in places
        if found[windows[k]][1] < CLEARLY * float(residuals[k] @ residuals[k])
    }
    return {**states, **better} if better else states


def _descend(
    predictor: Predictor,
    likelihood: Likelihood,
    hypothesis: Hypothesis,
    windows: Sequence[Window],
    x: Array,
    states: Mapping[Window, Array],
    fixed: NDArray[np.bool_] | None,
    most_steps: int,
    enough: float,
    target: float,
    louder: float,
) -> Fit:
    """Levenberg–Marquardt from one point; see ``fit``."""
    lower, upper = bounds(predictor, hypothesis)
    k = len(predictor.nominal)
    prior_weight = np.zeros(len(x))
    prior_weight[:k] = louder
    held = np.zeros(len(x), dtype=bool) if fixed is None else fixed.copy()
    current = dict(states)
    here = linearise(predictor, likelihood, hypothesis, windows, x, current, upper=upper, fixed=held)
    prior = float(np.sum(prior_weight * x**2))
    damping, converged = 1e-3, False
    free = ~held
    stiff = loosely_held(predictor, hypothesis)
    # A step that fails is tried again with more damping, from the same place: as many such trials as fit beside the first
    # one into lanes that run anyway are made at once.
    together = max(1, LANES * -(-len(windows) // LANES) // len(windows))
    tried: dict[float, tuple[Trial, Residuals]] = {}
    mended, loosened = False, False
    for _ in range(most_steps):
        if damping not in tried:
            trials = [_trial(here, windows, x, current, prior_weight, lower, upper, held, damping, stiff)]
            if trials[0].predicted < enough and damping > SOFTEST and not loosened:
                # Along a valley with steep sides a damped step promises little, however far there is to go.
                loosened = True
                loose = _trial(here, windows, x, current, prior_weight, lower, upper, held, SOFTEST, stiff)
                if loose.predicted >= enough:
                    damping, trials = SOFTEST, [loose]
            while len(trials) < together and trials[-1].predicted >= enough and trials[-1].damping <= HARDEST:
                harder = _harder(trials[-1].damping)
                trials.append(_trial(here, windows, x, current, prior_weight, lower, upper, held, harder, stiff))
            if here.cost + prior - HOPE * max(trials[0].predicted, 0.0) > target > -np.inf:
                free = trials[0].free
                break
            if trials[0].predicted >= 1e-3 * enough:
                at = residuals_at(predictor, likelihood, hypothesis, windows, [(t.x, t.states) for t in trials])
                if trials[0].predicted >= enough and _worse(here, prior, prior_weight, trials[0], at[0]):
                    curved = _along_the_curve(here, windows, trials[0], at[0], prior_weight, lower, upper, held, stiff)
                    if curved is not None:
                        (there,) = residuals_at(predictor, likelihood, hypothesis, windows, [(curved.x, curved.states)])
                        if not _worse(here, prior, prior_weight, curved, there):
                            trials[0], at[0] = curved, there
            else:
                at = [(np.inf, ())] * len(trials)
            tried = {t.damping: (t, found) for t, found in zip(trials, at, strict=True)}
        trial, found = tried[damping]
        free, predicted = trial.free, trial.predicted
        if here.cost + prior - HOPE * max(predicted, 0.0) > target > -np.inf:
            break
        if predicted < enough:
            converged = True
            # One last full step costs nothing further and takes the rest of the way.
            if predicted < 1e-3 * enough:
                break
        trial_prior = float(np.sum(prior_weight * trial.x**2))
        gain = here.cost + prior - found[0] - trial_prior
        if gain <= 0.0 and not mended and _hindered(here, found) + prior > trial_prior:
            mended = True
            options = [trial.states, _between(current, trial.states), current]
            own, found = best_states(predictor, likelihood, hypothesis, windows, trial.x, options)
            trial = replace(trial, states=own)
            gain = here.cost + prior - found[0] - trial_prior
        if gain > 0.0:
            reach = max(_reach(x, trial.x), *(_reach(current[w], trial.states[w]) for w in windows))
            x, current, prior = trial.x, trial.states, trial_prior
            if converged and reach < UNCHANGED:
                here = _eliminated(found[0], found[1], here.bases, here.shared)
                break
            here = linearise(
                predictor, likelihood, hypothesis, windows, x, current, upper=upper, fixed=held, known=found
            )
            tried, mixed, mended, loosened = {}, mended, False, False
            # Quickly where the linear view holds: along a valley whose sides are steep, little damping is much.
            damping = max(
                damping * (0.01 if gain > 0.9 * predicted else 0.1 if gain > 0.5 * predicted else 0.5), SOFTEST
            )
            # What only a mixture of states could gain may go on for long by ever less.
            if converged or (mixed and gain < max(enough, SLOW * here.cost)):
                break
        else:
            if converged or damping > HARDEST:
                break
            damping = _harder(damping)
    return Fit(hypothesis, tuple(windows), x, current, here, prior / louder, converged, free)


@dataclass(frozen=True, eq=False)
class Trial:
    """A step proposed: where it leads, what it is expected to gain, and which parameters were free of their bounds."""

    damping: float
    x: Array
    states: dict[Window, Array]
    predicted: float
    free: NDArray[np.bool_]
    step: Array
    state_steps: Array


def _worse(here: Linearisation, prior: float, weight: Array, trial: Trial, found: Residuals) -> bool:
    """Whether a trial costs no less than where it began."""
    return bool(found[0] + float(np.sum(weight * trial.x**2)) >= here.cost + prior)


def _along_the_curve(
    here: Linearisation,
    windows: Sequence[Window],
    trial: Trial,
    found: Residuals,
    prior_weight: Array,
    lower: Array,
    upper: Array,
    held: NDArray[np.bool_],
    stiff: Array,
) -> Trial | None:
    """A trial brought back into the valley by what its residuals have beyond the linear view; none where that is no correction.

    The second-order correction of sequential quadratic programming (Fletcher, Practical Methods of Optimization, 1987, §14.4),
    here as in the geodesic acceleration of Transtrum and Sethna (arXiv:1201.5885).
    """
    with np.errstate(over="ignore", invalid="ignore"):
        beyond = [
            np.nan_to_num(after - before - basis @ moved - shared @ trial.step)
            for after, before, basis, shared, moved in zip(
                found[1], here.residuals, here.bases, here.shared, trial.state_steps, strict=True
            )
        ]
    curve = _eliminated(0.0, beyond, here.bases, here.shared)
    zero = np.zeros(len(trial.x))
    step, _ = _step(curve, zero, prior_weight, lower - trial.x, upper - trial.x, held, trial.damping)
    steps = _state_steps(curve.triangles, step, trial.damping, stiff, np.zeros_like(trial.state_steps))
    if not (_length(step) <= CURVED * _length(trial.step) and _length(steps) <= CURVED * _length(trial.state_steps)):
        return None
    moved = {w: trial.states[w] + s for w, s in zip(windows, steps, strict=True)}
    return replace(trial, x=np.clip(trial.x + step, lower, upper), states=moved)


def _length(step: Array) -> float:
    with np.errstate(over="ignore"):
        return float(np.sqrt(np.sum(step**2)))


def _hindered(here: Linearisation, found: Residuals) -> float:
    """What a step would gain if no window lost by it; nothing unless there are windows that do not."""
    if len(here.residuals) < 2:
        return 0.0
    # A run that has gone astray may be too far off for its square.
    with np.errstate(over="ignore"):
        return sum(max(float(a @ a) - float(b @ b), 0.0) for a, b in zip(here.residuals, found[1], strict=True))


def _between(before: Mapping[Window, Array], after: Mapping[Window, Array]) -> dict[Window, Array]:
    """States a quarter of the way."""
    return {window: 0.75 * state + 0.25 * after[window] for window, state in before.items()}


def _harder(damping: float) -> float:
    """The damping after a step that failed."""
    # Along a valley with steep sides little damping is much, so that none of its orders of magnitude is left out.
    return damping * (30.0 if damping < 1e-5 else 8.0)


def _trial(
    here: Linearisation,
    windows: Sequence[Window],
    x: Array,
    states: Mapping[Window, Array],
    prior_weight: Array,
    lower: Array,
    upper: Array,
    held: NDArray[np.bool_],
    damping: float,
    stiff: Array,
) -> Trial:
    """The step that the linear model proposes under a damping. stiff: of the initial states, (S,), see ``loosely_held``."""
    step, free = _step(here, x, prior_weight, lower, upper, held, damping)
    begun = np.array([states[w] for w in windows])
    gain = _predicted_gain(here, prior_weight, x, step)
    state_steps = _state_steps(here.triangles, step, damping, stiff, begun)
    predicted = gain - _left(here, step, state_steps)
    if predicted < 0.0 and stiff.any():
        # What begins far off is not brought back at a loss.
        state_steps = _state_steps(here.triangles, step, damping, stiff, np.zeros_like(begun))
        predicted = gain - _left(here, step, state_steps)
    moved = {w: states[w] + s for w, s in zip(windows, state_steps, strict=True)}
    return Trial(damping, np.clip(x + step, lower, upper), moved, predicted, free, step, state_steps)


def _step(
    here: Linearisation,
    x: Array,
    prior_weight: Array,
    lower: Array,
    upper: Array,
    held: NDArray[np.bool_],
    damping: float,
) -> tuple[Array, NDArray[np.bool_]]:
    """Damped Gauss–Newton step in the shared parameters that respects the bounds; and which of them were free."""
    size = len(x)
    free = ~held
    step = np.zeros(size)
    scale = np.sqrt(np.sum(here.matrix**2, axis=0) + prior_weight)
    for _ in range(size + 1):
        index = np.flatnonzero(free)
        if len(index) == 0:
            return step * 0.0, free
        a = np.vstack(
            [
                here.matrix[:, index],
                np.diag(np.sqrt(prior_weight[index])),
                np.sqrt(damping) * np.diag(scale[index] + 1e-12),
            ]
        )
        fixed_part = here.matrix @ np.where(free, 0.0, step)
        b = -np.concatenate([here.vector + fixed_part, np.sqrt(prior_weight[index]) * x[index], np.zeros(len(index))])
        step[index] = np.linalg.lstsq(a, b, rcond=None)[0]
        beyond = free & ((x + step < lower - 1e-12) | (x + step > upper + 1e-12))
        if not np.any(beyond):
            break
        step[beyond] = np.where(x[beyond] + step[beyond] < lower[beyond], lower[beyond], upper[beyond]) - x[beyond]
        free = free & ~beyond
    return step, free


def _reach(before: Array, after: Array) -> float:
    """Longest change of a coordinate, relative where it is larger than one."""
    return float(np.max(np.abs(after - before) / np.maximum(1.0, np.abs(before)), initial=0.0))


def _state_steps(
    triangles: Sequence[tuple[Array, Array, Array]], step: Array, damping: float, stiff: Array, begun: Array
) -> Array:
    """How the initial states of all windows follow a step of the shared parameters, shape (W, S).

    stiff: how stiffly states are held to zero, (S,); begun: where they stand, (W, S).
    """
    rss = np.array([t[0] for t in triangles])
    size = rss.shape[2]
    scale = np.linalg.norm(rss, axis=1) + 1e-9
    held = np.zeros((len(rss), 2 * size, size))
    held[:, :size] = (np.sqrt(damping * 1e-3) * scale + 1e-9)[:, :, None] * np.eye(size)
    held[:, size:] = np.diag(stiff)
    right = -np.array([t[2] for t in triangles]) - np.array([t[1] for t in triangles]) @ step
    right = np.concatenate([right, np.zeros_like(right), -stiff * begun], axis=1)
    # Least squares by singular values, of all windows at once.
    u, s, vt = np.linalg.svd(np.concatenate([rss, held], axis=1), full_matrices=False)
    along = np.einsum("wij,wi->wj", u, right)
    least = np.finfo(np.float64).eps * 2 * size * s[:, :1]
    along = np.where(s > least, along / np.where(s > least, s, 1.0), 0.0)
    return np.asarray(np.einsum("wji,wj->wi", vt, along))


def _left(here: Linearisation, step: Array, state_steps: Array) -> float:
    """What the initial states leave of the part of the residuals that they alone could take away, under a step."""
    left = [r + b @ step + a @ own for (a, b, r), own in zip(here.triangles, state_steps, strict=True)]
    return sum(float(rest @ rest) for rest in left)


def _predicted_gain(here: Linearisation, prior_weight: Array, x: Array, step: Array) -> float:
    state_part = sum(float(rs @ rs) for _, _, rs in here.triangles)
    before = float(here.vector @ here.vector) + float(np.sum(prior_weight * x**2))
    moved = here.vector + here.matrix @ step
    after = float(moved @ moved) + float(np.sum(prior_weight * (x + step) ** 2))
    return before - after + state_part


def covariance(fitted: Fit, nominal: int, inflation: float = 1.0) -> Array:
    """Covariance of the shared parameters, initial states profiled out; parameters at a bound have none (nan).

    nominal: number of leading parameters with a unit normal prior. inflation: variance of the whitened residual.
    """
    size = len(fitted.x)
    index = np.flatnonzero(fitted.free)
    information = fitted.linear.matrix[:, index].T @ fitted.linear.matrix[:, index] / inflation
    information += np.diag((index < nominal).astype(np.float64))
    out = np.full((size, size), np.nan)
    values, vectors = np.linalg.eigh(information)
    values = np.maximum(values, 1e-14 * max(float(values.max(initial=0.0)), 1e-300))
    out[np.ix_(index, index)] = (vectors / values) @ vectors.T
    return out


def project(basis: Array, columns: Array) -> Array:
    """Columns (M, k) with their part along ``basis`` (M, j) removed."""
    q, r = qr(basis, mode="economic", check_finite=False)
    strong = np.abs(np.diag(r)) > 1e-10 * max(float(np.abs(np.diag(r)).max(initial=0.0)), 1e-300)
    q = q[:, strong]
    return columns - q @ (q.T @ columns)


def solve_upper(r: Array, b: Array) -> Array:
    """R⁻¹ b for an upper triangle."""
    return np.asarray(solve_triangular(r, b, check_finite=False))
