"""How far an experiment that nobody has done yet would part two hypotheses.

What the rival predicts is brought as near to the other as its initial state and its parameters allow, these as far as the
recordings at hand leave them open: what another initial state or a slightly different inertia makes up for parts nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.linearisation import telling_steps
from harness.diagnose.estimation.noise_colour import Colour
from harness.diagnose.experiment.constants import (
    ACCELEROMETER_NOISE,
    FIRST_SWINGS,
    FOUND_BACK_SHARE,
    MOVED_AWAY,
    NEARING_GAIN,
    NEARING_STEPS,
    NOTHING_PARTED_SIGMAS,
    SAMPLE_TIME,
    SEPARATION_DIFFERENCE,
    SHORTCUT_STEPS,
    VIBRATING_NEARING_STEPS,
)
from harness.diagnose.experiment.trials import Trial
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.problem import ChannelInfo, Problem, Run
from harness.diagnose.problem.windows import Window
from harness.diagnose.selection.study import Study
from harness.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class _Imagined:
    """An experiment with the means to predict it: noise (C, 1) [std] of its channels, number of samples."""

    predictor: Predictor
    noise: Array
    count: int

    def curves(self, fitted: Fit, xs: Array, states: Sequence[Array], count: int) -> Array:
        """Channels in units of their noise, (K, C·count), for parameter vectors (K, P) and as many initial states."""
        window = Window(0, 0, count)
        lanes = [(k, window, state) for k, state in enumerate(states)]
        found = np.array(self.predictor.predict(fitted.hypothesis, xs, lanes)) / self.noise
        return found.reshape(len(found), -1)


def separation(study: Study, first: Fit, second: Fit, trial: Trial, least: float = 0.0, most: float = np.inf) -> float:
    """Distance between two hypotheses' predictions in standard deviations of the noise, what is open of the second one left free.

    least, most: distances below and beyond which the exact one does not matter; beyond, it is what the beginning of the experiment
    parts them by. nan where nothing can be said: a run that leaves the numbers, or a motion so sensitive that not even the second
    hypothesis finds back to itself.
    """
    imagined = _imagined(study, trial)
    try:
        begun = _start(imagined.predictor, second, trial)
        rival = _open(study, second, len(begun))
        told = imagined.curves(first, first.x[None], [_start(imagined.predictor, first, trial)], imagined.count)[0]
        lengths = _lengths(study, imagined)
        distance, _, _ = _brought_near(imagined, rival, told, begun, lengths[-1:], SHORTCUT_STEPS)
        if distance <= max(least, NOTHING_PARTED_SIGMAS):
            return distance
        elastic = len(begun) > 2 * len(imagined.predictor.system.joint_names)
        patience = VIBRATING_NEARING_STEPS if elastic else NEARING_STEPS
        distance, state, needed = _brought_near(imagined, rival, told, begun, lengths, patience, most)
        if distance <= max(least, NOTHING_PARTED_SIGMAS):
            return distance
        own = imagined.curves(second, second.x[None], [begun], imagined.count)[0]
        moved = begun + np.where(np.abs(state - begun) > MOVED_AWAY, state - begun, MOVED_AWAY)
        back, _, _ = _brought_near(imagined, rival, own, moved, lengths[:needed], patience)
        return distance if back < FOUND_BACK_SHARE * distance < np.inf else np.nan
    except InputError:
        return np.nan


def _imagined(study: Study, trial: Trial) -> _Imagined:
    interval = max(SAMPLE_TIME, study.problem.train[0].interval)
    time = np.arange(0.0, trial.duration, interval)
    channels = study.problem.channels
    colours = list(study.likelihood.colours)
    if trial.link:
        channels = (*channels, ChannelInfo(f"{trial.link}.tip_acceleration", trial.link, "tip_acceleration", "m/s**2"))
        colours.append(Colour(ACCELEROMETER_NOISE, interval=interval))
    effort = None
    if trial.effort is not None:
        old = SAMPLE_TIME * np.arange(len(trial.effort))
        effort = np.column_stack([np.interp(time, old, column) for column in trial.effort.T])
    run = Run("proposed", time, np.full((len(channels), len(time)), np.nan), effort, interval)
    noise = np.array([c.std / np.sqrt(c.effective_fraction) for c in colours])[:, None]
    posed = Problem(study.problem.system, channels, (run,), (run,))
    predictor = Predictor(posed, deadline=study.predictor.deadline)
    predictor.shorten(np.array([min(colour.std, colour.innovation[1]) for colour in colours]))
    return _Imagined(predictor, noise, len(time))


def _lengths(study: Study, imagined: _Imagined) -> list[int]:
    """Numbers of samples over which a rival is brought near, one time after another; the last one is all of them."""
    lengths = [max(2, round(FIRST_SWINGS * study.swing / imagined.predictor.runs[0].interval))]
    while lengths[-1] < imagined.count:
        lengths.append(2 * lengths[-1])
    return [*lengths[:-1], imagined.count]


def _start(predictor: Predictor, fitted: Fit, trial: Trial) -> Array:
    names = predictor.mechanism(fitted.hypothesis).names
    state = np.zeros(2 * len(names))
    joints = predictor.system.joint_names
    for j, joint in enumerate(joints):
        state[names.index(joint)] = trial.state[j]
        state[len(names) + names.index(joint)] = trial.state[len(joints) + j]
    return state


@dataclass(frozen=True, eq=False)
class _Open:
    """What may still move of a hypothesis: initial state and, in what the recordings at hand leave open, its parameters.

    free: which parameters (P,) move; known: rows whose squares are the price of moving them. lower, upper, steps: of state and free
    parameters one after the other (S,).
    """

    fitted: Fit
    free: NDArray[np.intp]
    known: Array
    lower: Array
    upper: Array
    steps: Array

    def parameters(self, points: Array) -> Array:
        """Parameter vectors (K, P) of points (K, S)."""
        xs = np.tile(self.fitted.x, (len(points), 1))
        xs[:, self.free] = points[:, -len(self.free) :] if len(self.free) else 0.0
        return xs


def _open(study: Study, fitted: Fit, states: int) -> _Open:
    free = np.flatnonzero(fitted.free)
    stated = np.eye(len(fitted.x))[: len(study.predictor.nominal)]
    known = np.vstack([fitted.linear.matrix, stated])[:, free]
    lower, upper = (bound[free] for bound in study.objective(fitted.hypothesis).bounds())
    steps = telling_steps(fitted.linear)[free]
    steps = np.where(fitted.x[free] + steps > upper, -steps, steps)
    wide = np.full(states, np.inf)
    return _Open(
        fitted,
        free,
        known,
        np.append(-wide, lower),
        np.append(wide, upper),
        np.append(np.full(states, SEPARATION_DIFFERENCE), steps),
    )


def _brought_near(
    imagined: _Imagined, rival: _Open, told: Array, begun: Array, lengths: Sequence[int], patience: int,
    most: float = np.inf,
) -> tuple[float, Array, int]:  # fmt: skip
    """The least distance of a hypothesis from a prediction (C·T,), the initial state (n,) where it is reached, and how many of the
    ``lengths`` it took.

    Over ever longer times, so that a swing that runs ahead is not held against the one before; as long as the distance, which can
    only grow, is not beyond ``most``.
    """
    told = told.reshape(len(imagined.noise), -1)
    n = len(begun)
    at, distance = np.append(begun, rival.fitted.x[rival.free]), np.inf
    price = np.pad(rival.known, ((0, 0), (n, 0)))
    for taken, count in enumerate(lengths, 1):
        target = told[:, :count].ravel()
        seen: dict[bytes, tuple[Array, Array]] = {}

        def view(here: Array, count: int = count, target: Array = target, seen: dict = seen) -> tuple[Array, Array]:
            """Residuals at a point and their slopes there; both are asked for, one after the other."""
            if here.tobytes() not in seen:
                points = np.vstack([here, here + np.diag(rival.steps)])
                found = imagined.curves(rival.fitted, rival.parameters(points), list(points[:, :n]), count)
                slopes = np.nan_to_num((found[1:] - found[0]) / rival.steps[:, None])
                away = rival.known @ (here[n:] - rival.fitted.x[rival.free])
                seen.clear()
                seen[here.tobytes()] = np.append(found[0] - target, away), np.vstack([slopes.T, price])
            return seen[here.tobytes()]

        if not np.isfinite(view(at)[0]).all():
            return np.inf, begun, taken
        found = least_squares(
            lambda here, view=view: view(here)[0], at, jac=lambda here, view=view: view(here)[1],
            bounds=(rival.lower, rival.upper), x_scale="jac", ftol=NEARING_GAIN, max_nfev=patience,
        )  # fmt: skip
        at, distance = found.x, float(np.sqrt(2.0 * found.cost))
        if distance > most:
            break
    return distance, at[:n], taken
