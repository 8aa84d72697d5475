"""How far an experiment that nobody has done yet would part two hypotheses.

What the rival predicts is brought as near to the other as its initial state and its parameters allow, these as far as the
recordings at hand leave them open: what another initial state or a slightly different inertia makes up for parts nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.colour import Colour
from harness.diagnose.fit import Fit
from harness.diagnose.linearisation import telling_steps
from harness.diagnose.predict import Predictor
from harness.diagnose.problem import ChannelInfo, Problem, Run
from harness.diagnose.study import Study
from harness.diagnose.trials import FINEST, Trial
from harness.diagnose.windows import Window
from harness.errors import InputError

Array = NDArray[np.float64]

ACCELEROMETER = 0.05  # m/s², noise of a common micromechanical one
STEP = 1e-5  # rad, rad/s
FIRST = 1.5  # swings over which a rival is brought near to begin with; then twice as many, and so on
PATIENCE = 12  # steps over each such time
SHORTCUT = 3  # steps over all of it at once, which will do for what is alike and not far off
NOTHING = 1.0  # standard deviations that part nothing
ENOUGH = 0.02  # of the cost, below which a step's gain is not worth the next one
SOFT, HARDER, HARDEST = 1e-6, 10.0, 1e4  # damping, over the squared lengths of the directions
AWAY = 0.01  # rad, rad/s, at least, from which a hypothesis has to find back to itself
BACK = 0.1  # of a separation, that a hypothesis may stay away from itself


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


def separation(study: Study, first: Fit, second: Fit, trial: Trial, least: float = 0.0) -> float:
    """Distance between two hypotheses' predictions in standard deviations of the noise, what is open of the second one left free.

    least: distance below which the exact one does not matter. Zero where nothing can be said: a run that leaves the numbers, or a
    motion so sensitive that not even the second hypothesis finds back to itself.
    """
    imagined = _imagined(study, trial)
    try:
        begun = _start(imagined.predictor, second, trial)
        told = imagined.curves(first, first.x[None], [_start(imagined.predictor, first, trial)], imagined.count)[0]
        lengths = _lengths(study, imagined)
        distance, state = _brought_near(study, imagined, second, told, begun, lengths[-1:], least, SHORTCUT)
        if distance > max(least, NOTHING):
            distance, state = _brought_near(study, imagined, second, told, begun, lengths, least)
        if distance <= max(least, NOTHING):
            return distance
        if np.isinf(distance):
            return 0.0
        own = imagined.curves(second, second.x[None], [begun], imagined.count)[0]
        moved = begun + np.where(np.abs(state - begun) > AWAY, state - begun, AWAY)
        return (
            distance if _brought_near(study, imagined, second, own, moved, lengths, 0.0)[0] < BACK * distance else 0.0
        )
    except InputError:
        return 0.0


def _imagined(study: Study, trial: Trial) -> _Imagined:
    interval = max(FINEST, study.problem.train[0].interval)
    time = np.arange(0.0, trial.duration, interval)
    channels = study.problem.channels
    colours = list(study.likelihood.colours)
    if trial.link:
        channels = (*channels, ChannelInfo(f"{trial.link}.tip_acceleration", trial.link, "tip_acceleration", "m/s**2"))
        colours.append(Colour(ACCELEROMETER, interval=interval))
    effort = None
    if trial.effort is not None:
        old = FINEST * np.arange(len(trial.effort))
        effort = np.column_stack([np.interp(time, old, column) for column in trial.effort.T])
    run = Run("proposed", time, np.full((len(channels), len(time)), np.nan), effort, interval)
    noise = np.array([c.std / np.sqrt(c.effective_fraction) for c in colours])[:, None]
    predictor = Predictor(Problem(study.problem.system, channels, (run,), (run,)))
    predictor.shorten(np.array([min(colour.std, colour.innovation[1]) for colour in colours]))
    return _Imagined(predictor, noise, len(time))


def _lengths(study: Study, imagined: _Imagined) -> list[int]:
    """Numbers of samples over which a rival is brought near, one time after another; the last one is all of them."""
    interval = float(np.diff(imagined.predictor.runs[0].time[:2])[0])
    lengths = [max(2, round(FIRST * study.swing / interval))]
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


def _brought_near(
    study: Study,
    imagined: _Imagined,
    fitted: Fit,
    told: Array,
    begun: Array,
    lengths: Sequence[int],
    least: float,
    patience: int = PATIENCE,
) -> tuple[float, Array]:
    """The least distance of a hypothesis from a prediction (C·T,) and the initial state where it is reached.

    Levenberg's damped least squares over ever longer times, so that a swing that runs ahead is not held against the one before.
    """
    free = np.flatnonzero(fitted.free)
    known = _known(study, fitted, free)
    lower, upper = (bound[free] for bound in study.objective(fitted.hypothesis).bounds())
    steps = np.concatenate([np.full(len(begun), STEP), telling_steps(fitted.linear)[free]])
    steps[len(begun) :] = np.where(fitted.x[free] + steps[len(begun) :] > upper, -1.0, 1.0) * steps[len(begun) :]
    channels = len(imagined.noise)
    told = told.reshape(channels, -1)
    at = np.concatenate([begun, fitted.x[free]])
    best, linear, damping = np.inf, None, SOFT
    for count in lengths:
        best, linear, damping, here = np.inf, None, SOFT, at
        target = told[:, :count].ravel()
        for _ in range(patience):
            points = np.vstack([here, here + np.diag(steps)])
            xs = np.tile(fitted.x, (len(points), 1))
            xs[:, free] = points[:, len(begun) :]
            found = imagined.curves(fitted, xs, list(points[:, : len(begun)]), count)
            away = known @ (here[len(begun) :] - fitted.x[free])
            with np.errstate(over="ignore", invalid="ignore"):
                cost = float(np.sum((found[0] - target) ** 2) + np.sum(away**2))
            if cost < best:
                gain, best, at = best - cost, cost, here
                slopes = np.vstack(
                    [((found[1:] - found[0]) / steps[:, None]).T, np.pad(known, ((0, 0), (len(begun), 0)))]
                )
                linear = (np.nan_to_num(slopes), np.concatenate([found[0] - target, away]))
                if gain < ENOUGH * best or (count == lengths[-1] and best < least**2):
                    break
                damping = max(damping / HARDER, SOFT)
            else:
                damping *= HARDER**2
                if damping > HARDEST:
                    break
            if linear is None:
                return np.inf, begun
            matrix, rest = linear
            size = np.linalg.norm(matrix, axis=0)
            size[size == 0.0] = 1.0
            damped = np.vstack([matrix / size, np.sqrt(damping) * np.eye(len(size))])
            change = np.linalg.lstsq(damped, np.concatenate([-rest, np.zeros(len(size))]), rcond=1e-10)[0] / size
            here = at + change
            here[len(begun) :] = np.clip(here[len(begun) :], lower, upper)
    return float(np.sqrt(best)), at[: len(begun)]


def _known(study: Study, fitted: Fit, free: NDArray[np.intp]) -> Array:
    """What recordings and stated tolerances know of a fit's free parameters, as rows whose squares are its price."""
    stated = np.eye(len(fitted.x))[: len(study.predictor.nominal)]
    return np.asarray(np.vstack([fitted.linear.matrix, stated])[:, free])
