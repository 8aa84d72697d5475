"""Initial states chosen window by window: windows share parameters, but where one starts is nothing to the others.

A step that is right for most windows may lead one of them across a kink of its motion (a mass that comes to rest, a stop, a
slack), where the linear view of its initial state fails. Judged by the sum of all windows it would be refused.

So a step that most windows gain by is tried with their states mixed, and a window that is fitted far worse than most begins again
from the state that the recording reads. Initial states of a vibration that has died out before a sensor saw it are held loosely to
zero in the steps, though not in the cost: what the recording shows is followed, and what it cannot show does not wander off to
motions that no solver follows in few steps.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.estimation.assemblies import closed_as_recorded
from harness.diagnose.estimation.constants import (
    FIRST_DAMPING,
    ODD_WINDOW_RATIO,
    STATE_DIFFERENCE,
    STATE_READING_TIME,
    STATE_STEPS,
    SWING_SPEED,
    VIBRATION_AMPLITUDE,
)
from harness.diagnose.estimation.objective import Objective, Residuals, States
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.hypothesis import Hypothesis
from harness.diagnose.problem.problem import Problem
from harness.diagnose.problem.windows import Window, local_state
from harness.effects.scale import references

Array = NDArray[np.float64]


def loosely_held(predictor: Predictor, hypothesis: Hypothesis) -> Array:
    """How stiffly a step holds each initial position and velocity, (S,): one over what a vibration may plausibly begin with.

    Joints are free. Where a vibration dies out before a sensor has seen it, noise alone says how it began: steps would lead
    ever farther off, to motions that no solver follows in few steps and no recording contradicts.
    """
    names = predictor.mechanism(hypothesis).names
    joints = predictor.system.joint_names
    rate = SWING_SPEED * max((references(predictor.system, name).frequency for name in joints), default=1.0)
    dependent = predictor.mechanism(hypothesis).model.dependent
    loose = np.array([0.0 if name in joints and name not in dependent else 1.0 / VIBRATION_AMPLITUDE for name in names])
    return np.concatenate([loose, loose / rate])


def best_states(objective: Objective, x: Array, options: Sequence[States]) -> tuple[dict[Window, Array], Residuals]:
    """Of several initial states of every window the one that costs least under the parameters ``x``, and the residuals there."""
    windows = objective.windows
    costs, residuals = objective.of_options(x, [options] * len(windows))
    best = np.argmin(costs, axis=1)
    chosen = {window: options[k][window] for window, k in zip(windows, best, strict=True)}
    return chosen, (float(costs.min(axis=1).sum()), tuple(own[k] for own, k in zip(residuals, best, strict=True)))


def suspects(residuals: Sequence[Array]) -> list[int]:
    """Places of windows that are fitted far worse than most, as those are that have ended beyond a kink."""
    squares = np.array([float(r @ r) / max(len(r), 1) for r in residuals])
    return [int(k) for k in np.flatnonzero(squares > ODD_WINDOW_RATIO * np.median(squares))]


def settled(objective: Objective, x: Array, options: Sequence[States]) -> dict[Window, tuple[Array, float]]:
    """Every window's best initial state under the parameters ``x``, and its cost: each option is followed downhill by itself."""
    windows = objective.windows
    states = [np.array([own[window] for own in options]) for window in windows]
    costs, residuals = objective.of_options(x, _named(windows, states))
    damping = np.full(costs.shape, FIRST_DAMPING)
    n = states[0].shape[1]
    for _ in range(STATE_STEPS):
        moved = [np.concatenate([own + STATE_DIFFERENCE * e for e in np.eye(n)]) for own in states]
        _, changed = objective.of_options(x, _named(windows, moved))
        trials = []
        for w, own in enumerate(states):
            trial = own.copy()
            for k in range(len(own)):
                jacobian = (
                    np.array([changed[w][j * len(own) + k] - residuals[w][k] for j in range(n)]).T / STATE_DIFFERENCE
                )
                scale = np.linalg.norm(jacobian, axis=0) + 1e-12
                stacked = np.vstack([jacobian, np.sqrt(damping[w, k]) * np.diag(scale)])
                right = np.concatenate([-residuals[w][k], np.zeros(n)])
                trial[k] += np.linalg.lstsq(stacked, right, rcond=None)[0]
            trials.append(trial)
        tried, there = objective.of_options(x, _named(windows, trials))
        for w, k in np.argwhere(tried < costs):
            states[w][k], residuals[w][k] = trials[w][k], there[w][k]
        damping = np.where(tried < costs, 0.1 * damping, 30.0 * damping)
        costs = np.minimum(costs, tried)
    best = np.argmin(costs, axis=1)
    return {window: (states[w][best[w]], float(costs[w, best[w]])) for w, window in enumerate(windows)}


def _named(windows: Sequence[Window], states: Sequence[Array]) -> list[list[States]]:
    return [[{window: state} for state in own] for window, own in zip(windows, states, strict=True)]


def measured_state(
    problem: Problem, predictor: Predictor, window: Window, shortest: float = STATE_READING_TIME
) -> Array:
    """Initial positions and velocities read off the recording by a local cubic over six samples or ``shortest`` [s] either way;
    what is not measured begins at zero."""
    names = predictor.mechanism(Hypothesis()).names
    run = problem.runs[window.run]
    state = np.zeros(2 * len(names))
    span = max(6.0 * run.interval, shortest)
    for c, channel in enumerate(problem.channels):
        if channel.quantity != "position" or channel.site not in names:
            continue
        k = names.index(channel.site)
        state[k], state[len(names) + k] = local_state(run, c, window.first, span)
    for c, channel in enumerate(problem.channels):
        if channel.quantity == "velocity" and channel.site in names:
            k = names.index(channel.site)
            state[len(names) + k] = local_state(run, c, window.first, span)[0]
    return closed_as_recorded(predictor, window, state) if problem.system.loops else state
