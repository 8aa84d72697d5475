"""How far a motion can be foretold: windows in which an error of the initial state does not outgrow what fits can follow."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.fit import Fit
from harness.diagnose.hypothesis import Hypothesis
from harness.diagnose.predict import Predictor
from harness.diagnose.problem import Problem
from harness.diagnose.vibration_windows import FEWEST_SAMPLES
from harness.diagnose.window_states import measured_state
from harness.diagnose.windows import Window, equal_parts

Array = NDArray[np.float64]

STEP = 1e-6
FORETOLD = 300.0  # times that an error may grow within a window; beyond, motion counts as unpredictable
# The same before anything is fitted. What falls over, as an arm that is held up by its motors, leads a model that is off by a
# hundredth of its weight astray by a tenth of a radian then.
AT_FIRST = 30.0


def calm(problem: Problem, predictor: Predictor, windows: Sequence[Window], rate: float) -> tuple[Window, ...]:
    """The windows, those halved over which errors grow too much for a first fit, until they do not or hold few samples.

    rate: of the slowest swing [rad/s]. What bends is left as it is: its vibrations have windows of their own (``stages``).
    """
    if problem.system.flexible:
        return tuple(windows)
    hypothesis, x = Hypothesis(), np.zeros(len(predictor.nominal))
    done: list[Window] = []
    left = list(windows)
    while left:
        halved: list[Window] = []
        for window in left:
            grown = _growth(
                transition(predictor, hypothesis, x, window, measured_state(problem, predictor, window), rate)
            )
            if grown < AT_FIRST or window.size < 2 * FEWEST_SAMPLES:
                done.append(window)
            else:
                halved += equal_parts(window, 2)
        left = halved
    return tuple(sorted(done, key=lambda w: (w.run, w.first)))


def joined(predictor: Predictor, fitted: Fit, rate: float) -> tuple[Window, ...]:
    """The windows of a fit joined as long as an initial error does not grow beyond what a linear view can follow.

    rate: of the slowest swing [rad/s].
    """
    groups: list[Window] = []
    current: Window | None = None
    growth = np.zeros((0, 0))
    for window in fitted.windows:
        own = transition(predictor, fitted.hypothesis, fitted.x, window, fitted.states[window], rate)
        if current is not None and current.run == window.run and _growth(own @ growth) < FORETOLD:
            current = Window(window.run, current.first, window.last)
            growth = own @ growth
            continue
        if current is not None:
            groups.append(current)
        current, growth = window, own
    if current is not None:
        groups.append(current)
    return tuple(groups)


def transition(
    predictor: Predictor, hypothesis: Hypothesis, x: Array, window: Window, state: Array, rate: float
) -> Array:
    """Sensitivity (2n, 2n) of the final to the initial state of a window, in units of one radian and the swing's ``rate``."""
    mechanism = predictor.mechanism(hypothesis)
    n = len(state)
    half = n // 2
    grid = predictor.grid(window, predictor.margin(hypothesis))
    states = np.vstack([state, state + STEP * np.eye(n)])
    tau = None
    if predictor.runs[window.run].effort is not None:
        tau = predictor.efforts(hypothesis, x[None, :], mechanism, [(0, window, state)], grid.own)
        tau = np.repeat(tau, n + 1, axis=0)
    q, qd, _ = mechanism.model.simulate(
        np.tile(predictor.row(hypothesis, x), (n + 1, 1)), states[:, :half], states[:, half:], grid.own,
        tau=tau, hold=predictor.hold, tolerance=predictor.tolerance,
    )  # fmt: skip
    end = np.concatenate([q[:, -1], qd[:, -1]], axis=1)
    change = ((end[1:] - end[0]) / STEP).T
    units = np.concatenate([np.ones(half), np.full(half, rate)])
    return np.asarray(change * units[None, :] / units[:, None])


def _growth(change: Array) -> float:
    """The most that an error of unit size grows; infinite where the motion was lost."""
    return float(np.linalg.norm(change, 2)) if np.isfinite(change).all() else np.inf
