"""Least squares of a hypothesis on windows: Levenberg–Marquardt with the initial states eliminated window by window."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.constants import (
    BETTER_STATE_RATIO,
    ENOUGH_FIT_GAIN,
    EXPECTED_GAIN_RATIO,
    FIRST_DAMPING,
    LEAST_DAMPING,
    LOST,
    MOST_DAMPING,
    MOST_FIT_STEPS,
    PACE_STEPS,
    STATE_MIXING_GAIN,
    STATE_MIXING_ROUNDS,
    UNCHANGED_STEP,
    WIDEST_INTERVAL,
)
from harness.diagnose.estimation.gauss_newton import Stepping, Trial
from harness.diagnose.estimation.linearisation import Linearisation, eliminated, linearise, vibrating
from harness.diagnose.estimation.objective import Objective, Residuals, States
from harness.diagnose.estimation.window_states import (
    best_states,
    loosely_held,
    settled,
    suspects,
)
from harness.diagnose.prediction.predictor import ABREAST
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.windows import Window

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Fit:
    """The best point found. ``score`` is cost plus prior; ``converged`` says whether steps had become immaterial.

    vibrating: how many initial states of vibrations the data tell, phases of waves that are every window's own among them.
    """

    hypothesis: Hypothesis
    windows: tuple[Window, ...]
    x: Array
    states: Mapping[Window, Array]
    linear: Linearisation
    prior: float
    converged: bool
    free: NDArray[np.bool_]
    vibrating: float = 0.0

    @property
    def cost(self) -> float:
        return self.linear.cost

    @property
    def score(self) -> float:
        return self.linear.cost + self.prior

    def beginning(self, windows: Sequence[Window]) -> Fit:
        """The same with the initial states of those windows that begin where one of its own does, to start a fit of them from."""
        states = {w: self.states[v] for w in windows for v in self.windows if (v.run, v.first) == (w.run, w.first)}
        return replace(self, states=states)


@dataclass(frozen=True)
class Patience:
    """When a descent ends.

    most_steps: at most. enough: a predicted gain in cost below this. target: a score that has to come within reach.
    """

    most_steps: int
    enough: float
    target: float


def fit(
    objective: Objective,
    x: Array,
    states: States,
    *,
    fixed: NDArray[np.bool_] | None = None,
    most_steps: int = MOST_FIT_STEPS,
    enough: float = ENOUGH_FIT_GAIN,
    target: float = -np.inf,
    louder: float = 1.0,
    others: Sequence[States] = (),
) -> Fit:
    """Minimise whitened residuals plus the prior of the nominal quantities from one starting point.

    fixed: parameters that do not move. enough: a predicted gain in cost below this ends the search. target: a score that has
    to come within reach, or the search ends early. louder: variance that the residuals are taken to have beside the prior, in
    units of the noise's. others: further initial states; wherever a window does better with its own, it takes that.
    """
    x = np.clip(x, *objective.bounds())
    held = _stated_twice(objective)
    x = np.where(held, 0.0, x)
    if fixed is not None:
        held = held | fixed
    if others:
        start, (cost, residuals) = best_states(objective, x, [states, *others])
        if cost >= LOST:
            return _given_up(objective, x, start, cost, residuals)
        states = _unstuck(objective, x, start, others, residuals)
    patience = Patience(most_steps, enough, target)
    found = _descend(objective, x, states, held, patience, louder)
    for _ in range(STATE_MIXING_ROUNDS if others else 0):
        if objective.predictor.deadline.over:
            break
        again = _unstuck(objective, found.x, found.states, others, found.linear.residuals)
        if again is found.states or found.score > target > -np.inf:
            break
        better = _descend(objective, found.x, again, held, patience, louder)
        if better.score > found.score - enough:
            break
        found = better
    return found


def _given_up(objective: Objective, x: Array, states: States, cost: float, residuals: Sequence[Array]) -> Fit:
    """The starting point itself, whose motion cannot be computed: there is nothing to descend along."""
    bases = [np.zeros((len(r), len(states[w]))) for r, w in zip(residuals, objective.windows, strict=True)]
    shared = [np.zeros((len(r), len(x))) for r in residuals]
    here = eliminated(cost, residuals, bases, shared)
    free = np.ones(len(x), dtype=bool)
    return Fit(objective.hypothesis, objective.windows, x, states, here, objective.prior(x), False, free)


def _stated_twice(objective: Objective) -> NDArray[np.bool_]:
    """Which parameters are nominal dampings whose joint has a damping of its own among the effects: only the sum can be told."""
    members = objective.hypothesis.members
    damped = {member.site for member in members if member.effect.name == "viscous_damping"}
    doubled = np.zeros(objective.size, dtype=bool)
    nominal = objective.predictor.nominal
    doubled[: len(nominal)] = [q.kind == "damping" and q.name in damped for q in nominal]
    return doubled


def _unstuck(
    objective: Objective, x: Array, states: States, others: Sequence[States], residuals: Sequence[Array]
) -> States:
    """The same states, those apart where a window that is fitted far worse than most does clearly better with another."""
    windows, places = objective.windows, suspects(residuals)
    odd = [windows[k] for k in places]
    if not odd:
        return states
    found = settled(objective.on(odd), x, [states, *others])
    better = {
        windows[k]: found[windows[k]][0]
        for k in places
        if found[windows[k]][1] < BETTER_STATE_RATIO * float(residuals[k] @ residuals[k])
    }
    return {**states, **better} if better else states


def _descend(
    objective: Objective, x: Array, states: States, held: NDArray[np.bool_], patience: Patience, louder: float
) -> Fit:
    """Levenberg–Marquardt from one point; see ``fit``."""
    windows, enough = objective.windows, patience.enough
    weights = np.zeros(len(x))
    weights[: objective.nominal] = louder
    lower, upper = objective.bounds()
    predictor, hypothesis = objective.predictor, objective.hypothesis
    stiff, stay = loosely_held(predictor, hypothesis), predictor.following(hypothesis)
    stepping = Stepping(windows, weights, lower, upper, held, stiff, stay)
    current = dict(states)
    here = linearise(objective, x, current, upper=upper, fixed=held)
    prior = stepping.prior(x)
    damping, converged = FIRST_DAMPING, False
    free = ~held
    # A step that fails is tried again with more damping, from the same place: as many such trials as fit beside the first
    # one into lanes that run anyway are made at once.
    together = max(1, ABREAST * -(-len(windows) // ABREAST) // len(windows))
    tried: dict[float, tuple[Trial, Residuals]] = {}
    mended, loosened = False, False

    scores = [here.cost + prior]

    def beyond_reach(predicted: float, left: int) -> bool:
        if patience.target == -np.inf:
            return False
        missing, hope = here.cost + prior - patience.target, max(predicted, 0.0)
        if missing > patience.target and len(scores) >= PACE_STEPS:
            # Far from any fit the linear view promises all there is; what the last steps brought says more.
            hope = min(hope, left * (scores[-PACE_STEPS] - scores[-1]) / (PACE_STEPS - 1))
        return missing > EXPECTED_GAIN_RATIO * hope

    deadline = objective.predictor.deadline
    for left in range(patience.most_steps, 0, -1):
        if deadline.over:
            # Where it is not spared, the next prediction ends it: half a fit would speak for whatever has more parameters.
            deadline.check()
            break
        if damping not in tried:
            trials = [stepping.trial(here, x, current, damping)]
            if trials[0].predicted < enough and damping > LEAST_DAMPING and not loosened:
                # Along a valley with steep sides a damped step promises little, however far there is to go.
                loosened = True
                loose = stepping.trial(here, x, current, LEAST_DAMPING)
                if loose.predicted >= enough:
                    damping, trials = LEAST_DAMPING, [loose]
            while len(trials) < together and trials[-1].predicted >= enough and trials[-1].damping <= MOST_DAMPING:
                trials.append(stepping.trial(here, x, current, _harder(trials[-1].damping)))
            if beyond_reach(trials[0].predicted, left):
                free = trials[0].free
                break
            tried = _tried(objective, stepping, here, prior, trials, enough)
        trial, found = tried[damping]
        free, predicted = trial.free, trial.predicted
        if beyond_reach(predicted, left):
            break
        if predicted < enough:
            converged = True
            # One last full step costs nothing further and takes the rest of the way.
            if predicted < 1e-3 * enough:
                break
        trial_prior = stepping.prior(trial.x)
        gain = here.cost + prior - found[0] - trial_prior
        if gain <= 0.0 and not mended and _hindered(here, found) + prior > trial_prior:
            mended = True
            own, found = best_states(objective, trial.x, [trial.states, _between(current, trial.states), current])
            trial = replace(trial, states=own)
            gain = here.cost + prior - found[0] - trial_prior
        if gain > 0.0:
            reach = max(_reach(x, trial.x), *(_reach(current[w], trial.states[w]) for w in windows))
            x, current, prior = trial.x, predictor.with_followers(hypothesis, trial.x, trial.states), trial_prior
            if converged and reach < UNCHANGED_STEP:
                here = eliminated(found[0], found[1], here.bases, here.shared)
                break
            here = linearise(objective, x, current, upper=upper, fixed=held, known=found, nearby=here)
            scores.append(here.cost + prior)
            tried, mixed, mended, loosened = {}, mended, False, False
            # Quickly where the linear view holds: along a valley whose sides are steep, little damping is much.
            damping = max(
                damping * (0.01 if gain > 0.9 * predicted else 0.1 if gain > 0.5 * predicted else 0.5), LEAST_DAMPING
            )
            # What only a mixture of states could gain may go on for long by ever less.
            if converged or (mixed and gain < max(enough, STATE_MIXING_GAIN * here.cost)):
                break
        else:
            if converged or damping > MOST_DAMPING:
                break
            damping = _harder(damping)
    begun = vibrating(here, stepping.stiff) + objective.hypothesis.out_of_step * len(windows)
    return Fit(objective.hypothesis, windows, x, current, here, prior / louder, converged, free, begun)


def _tried(
    objective: Objective, stepping: Stepping, here: Linearisation, prior: float, trials: list[Trial], enough: float
) -> dict[float, tuple[Trial, Residuals]]:
    """Trials by their damping with the residuals where they lead, the first one bent along its valley if that helps."""
    if trials[0].predicted < 1e-3 * enough:
        return {t.damping: (t, (np.inf, ())) for t in trials}

    def worse(trial: Trial, found: Residuals) -> bool:
        return found[0] + stepping.prior(trial.x) >= here.cost + prior

    at = objective.residuals([(t.x, t.states) for t in trials])
    if trials[0].predicted >= enough and worse(trials[0], at[0]):
        curved = stepping.along_the_curve(here, trials[0], at[0])
        if curved is not None:
            (there,) = objective.residuals([(curved.x, curved.states)])
            if not worse(curved, there):
                trials, at = [curved, *trials[1:]], [there, *at[1:]]
    return {t.damping: (t, found) for t, found in zip(trials, at, strict=True)}


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


def _reach(before: Array, after: Array) -> float:
    """Longest change of a coordinate, relative where it is larger than one."""
    return float(np.max(np.abs(after - before) / np.maximum(1.0, np.abs(before)), initial=0.0))


def covariance(fitted: Fit, nominal: int, inflation: float = 1.0) -> Array:
    """Covariance of the shared parameters, initial states profiled out; parameters at a bound have none (nan).

    nominal: number of leading parameters with a unit normal prior. inflation: variance of the whitened residual.
    """
    size = len(fitted.x)
    index = np.flatnonzero(fitted.free)
    information = fitted.linear.matrix[:, index].T @ fitted.linear.matrix[:, index] / inflation
    information += np.diag((index < nominal).astype(np.float64))
    out = np.full((size, size), np.nan)
    out[np.ix_(index, index)] = inverse(information)
    return out


def inverse(information: Array) -> Array:
    """Covariance of an information matrix (P, P); directions that are not seen are as wide as rounding lets them be, and a number
    that nothing turns on is as wide as any interval is told.
    """
    # Beside what is known a million times better, what is hardly known is no rounding: each number in its own unit.
    known = np.sqrt(np.maximum(np.diag(information), 0.0))
    seen = known > 0.0
    unit = np.where(seen, known, 1.0)
    values, vectors = np.linalg.eigh(information / np.outer(unit, unit))
    values = np.maximum(values, 1e-14 * max(float(values.max(initial=0.0)), 1e-300))
    out = np.asarray((vectors / values) @ vectors.T) / np.outer(unit, unit)
    out[~seen], out[:, ~seen] = 0.0, 0.0
    out[~seen, ~seen] = WIDEST_INTERVAL**2
    return out
