"""The next experiment: rivals are simulated in experiments one could do, and the one that parts them best is proposed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.diagnose.colour import Colour
from harness.diagnose.fit import Fit
from harness.diagnose.investigate import Outcome
from harness.diagnose.predict import Predictor
from harness.diagnose.problem import ChannelInfo, Problem, Run
from harness.diagnose.windows import Window
from harness.effects.scale import references
from harness.errors import InputError
from harness.system.description import Array as SystemArray

Array = NDArray[np.float64]

PARTED = 5.0  # standard deviations of noise by which predictions must differ for an experiment to decide
PROFILED = 8  # steps in which the rival's initial state is brought as near as it comes
STEP = 1e-5  # rad, rad/s
FINEST = 1 / 250.0  # s between the samples of a proposed recording


@dataclass(frozen=True)
class Proposal:
    """An experiment in words, the effects it parts, and by how many standard deviations of noise."""

    what: str
    separates: tuple[str, ...]
    separation: float


@dataclass(frozen=True, eq=False)
class _Trial:
    what: str
    state: SystemArray
    effort: SystemArray | None
    duration: float
    channel: str


def propose(outcome: Outcome, pairs: list[tuple[Fit, Fit, tuple[str, ...]]]) -> Proposal | None:
    """The experiment that best parts the first pair of rivals that any can part; None without rivals.

    pairs: fits of rival hypotheses, and the names of the effects they disagree on.
    """
    if not pairs:
        return None
    best: Proposal | None = None
    for first, second, names in pairs:
        for trial in _trials(outcome):
            size = _separation(outcome, first, second, trial)
            if best is None or size > best.separation:
                best = Proposal(trial.what, names, size)
        if best is not None and best.separation >= PARTED:
            return best
    assert best is not None
    if best.separation < PARTED:
        return Proposal(
            "none of the releases, drives and further sensors considered would part them: measure the base's inclination, "
            "the sensor's zero or the masses directly",
            best.separates,
            best.separation,
        )
    return best


def _trials(outcome: Outcome) -> list[_Trial]:
    """Releases at small, middle and large angles, longer, driven, and with a further sensor on the last link."""
    system = outcome.problem.system
    n = len(system.joint_names)
    duration = float(max(run.duration for run in outcome.problem.train))
    time = np.arange(0.0, 3.0 * duration, FINEST)
    torque = references(system, system.joint_names[0]).torque
    trials = []
    for angle, name in ((0.15, "0.15"), (0.3, "0.3"), (0.8, "0.8"), (1.5, "1.5"), (2.6, "2.6")):
        state = np.zeros(2 * n)
        state[0] = angle
        for factor, words in ((1.0, f"for {duration:.0f} s"), (3.0, f"for {3 * duration:.0f} s, or until rest")):
            trials.append(_Trial(f"release from {name} rad and record {words}", state, None, factor * duration, ""))
    rest = np.zeros(2 * n)
    for ratio in (0.4, 0.8, 1.6):
        frequency = ratio / outcome.period
        effort = np.zeros((len(time), n))
        effort[:, 0] = 0.15 * torque * np.sin(2.0 * np.pi * frequency * time)
        what = f"drive {system.joint_names[0]} with a known torque of {0.15 * torque:.2g} N·m at {frequency:.2g} Hz"
        trials.append(_Trial(what, rest, effort, duration, ""))
    last = system.links[-1].name
    swing = np.zeros(2 * n)
    swing[0] = 0.8
    trials.append(
        _Trial(
            f"mount an accelerometer at the tip of {last}, release from 0.8 rad, record {duration:.0f} s",
            swing,
            None,
            duration,
            last,
        )
    )
    return trials


def _separation(outcome: Outcome, first: Fit, second: Fit, trial: _Trial) -> float:
    """Distance between two hypotheses' predictions, initial states free, in standard deviations of the noise."""
    interval = max(FINEST, outcome.problem.train[0].interval)
    time = np.arange(0.0, trial.duration, interval)
    channels = outcome.problem.channels
    colours = list(outcome.study.likelihood.colours)
    if trial.channel:
        channels = (
            *channels,
            ChannelInfo(f"{trial.channel}.tip_acceleration", trial.channel, "tip_acceleration", "m/s**2"),
        )
        colours.append(Colour(0.05, interval=interval))  # a common micromechanical accelerometer
    effort = None
    if trial.effort is not None:
        old = FINEST * np.arange(len(trial.effort))
        effort = np.column_stack([np.interp(time, old, column) for column in trial.effort.T])
    run = Run("proposed", time, np.full((len(channels), len(time)), np.nan), effort, interval)
    problem = Problem(outcome.problem.system, channels, (run,), (run,))
    predictor = Predictor(problem)
    window = Window(0, 0, len(time))
    n = len(problem.system.joint_names)
    scale = np.array([c.std / np.sqrt(c.effective_fraction) for c in colours])[:, None]
    try:
        reference = _curves(predictor, first, window, trial, n, None)[0]
        state: Array | None = None
        distance = np.inf
        for _ in range(PROFILED):
            state, found, directions = _with_directions(predictor, second, window, trial, n, state)
            difference = np.nan_to_num((found - reference) / scale).ravel()
            if np.linalg.norm(difference) > distance:
                break
            distance = float(np.linalg.norm(difference))
            columns = np.column_stack([np.nan_to_num(d / scale).ravel() for d in directions])
            state = state - np.linalg.lstsq(columns, difference, rcond=1e-10)[0]
    except InputError:
        return 0.0
    return distance if np.isfinite(distance) else 0.0


def _start(predictor: Predictor, fitted: Fit, trial: _Trial, n: int) -> Array:
    names = predictor.mechanism(fitted.hypothesis).names
    state = np.zeros(2 * len(names))
    for j, joint in enumerate(predictor.system.joint_names):
        state[names.index(joint)] = trial.state[j]
        state[len(names) + names.index(joint)] = trial.state[n + j]
    return state


def _curves(
    predictor: Predictor, fitted: Fit, window: Window, trial: _Trial, n: int, states: list[Array] | None
) -> list[Array]:
    """Predicted channels (C, T) from each of the states, by default from the trial's own."""
    chosen = states if states is not None else [_start(predictor, fitted, trial, n)]
    return predictor.predict(fitted.hypothesis, fitted.x[None, :], [(0, window, state) for state in chosen])


def _with_directions(
    predictor: Predictor, fitted: Fit, window: Window, trial: _Trial, n: int, state: Array | None
) -> tuple[Array, Array, list[Array]]:
    """A state, the channels predicted from it, and how they change with every component of it."""
    at = _start(predictor, fitted, trial, n) if state is None else state
    found = _curves(predictor, fitted, window, trial, n, [at, *(at + STEP * np.eye(len(at)))])
    return at, found[0], [(f - found[0]) / STEP for f in found[1:]]
