"""A support that moves up and down or sideways, put to what a fit leaves: the first is gravity that comes and goes with time.

It pumps a swing or brakes it (Mathieu's equation), and in a few swings looks much like a base that shakes sideways, at the sum or
the difference of its frequency and the swing's; the catalogue's shakes sideways only.

Source: A. H. Nayfeh and D. T. Mook, Nonlinear Oscillations (1979), chapter 5.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from harness.denoc.model import Denoc
from harness.diagnose.criticism.check import Test
from harness.diagnose.criticism.constants import (
    HIGHEST_SHAKING,
    LOWEST_SHAKING,
    MOST_SHAKING_FREQUENCIES,
    SHAKING_FINENESS,
    SHAKING_WAVES_DEPENDENT,
)
from harness.diagnose.criticism.gains import jointly
from harness.diagnose.criticism.probe import Probe, probe
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.linear_response import responsive, to_channels
from harness.diagnose.problem.windows import Window
from harness.diagnose.selection.score_tests import MOST_TOGETHER, Nuisance, Projected, nuisance
from harness.diagnose.selection.study import Study
from harness.effects.scale import pull
from harness.system import System

Array = NDArray[np.float64]

UP_AND_DOWN, SIDEWAYS = "a support that moves up and down", "a support that moves sideways"
AT_ONCE = MOST_TOGETHER // 2  # two waves each


def shaken_up_and_down(study: Study, fitted: Fit) -> Test | None:
    """Gain by gravity that comes and goes at one frequency; none where no joint moves, which it would turn.

    In one phase, counted from the first sample of every recording; ``together``: with an amplitude and a phase of its own in every
    window.
    """
    problem = study.problem
    if not problem.system.joint_names:
        return None
    own = _probe(study, fitted)
    by_window: dict[Window, Array] = {}
    for run in dict.fromkeys(window.run for window in own.motions):
        found = {window: motion.q for window, motion in own.motions.items() if window.run == run}
        weights = _gravity(own.names, problem.system_in(problem.runs[run]), np.concatenate([*found.values()]))
        ends = np.cumsum([len(q) for q in found.values()])[:-1]
        by_window |= dict(zip(found, np.split(weights / own.torque, ends), strict=True))

    def changes(window: Window, waves: Array) -> Array:
        names = problem.system.joint_names
        pulses = [own.pulses(name, window, waves * by_window[window][:, j]) for j, name in enumerate(names)]
        return np.asarray(np.sum(pulses, axis=0))

    return _at_one_frequency(study, own, changes, UP_AND_DOWN)


def shaken_sideways(study: Study, fitted: Fit) -> Test | None:
    """The same by a base that shakes sideways, as the catalogue's does; none where channels are not linear in the motion."""
    if not responsive(study.predictor):
        return None
    own = _probe(study, fitted)

    def changes(window: Window, waves: Array) -> Array:
        found = own.motions[window]
        moved = found.by_shaking(waves)
        return np.nan_to_num(to_channels(own.predictor, own.likelihood, fitted, found, moved))

    return _at_one_frequency(study, own, changes, SIDEWAYS)


def _probe(study: Study, fitted: Fit) -> Probe:
    system = study.problem.system
    torque = pull(system)
    return probe(study.predictor, study.likelihood, fitted, torque)


def _at_one_frequency(study: Study, own: Probe, changes: Callable[[Window, Array], Array], name: str) -> Test:
    """Gain by what waves over time (2K, G) do to the channels of a window (2K, M), at the best of many frequencies."""
    fitted = own.fitted
    space = nuisance(fitted, study.predictor)
    swing = 1.0 / study.swing
    longest = max(float(m.time[-1]) for m in own.motions.values())
    count = int(
        np.clip((HIGHEST_SHAKING - LOWEST_SHAKING) * swing * longest * SHAKING_FINENESS, 2, MOST_SHAKING_FREQUENCIES)
    )
    # What does not come round once in any recording is a gravity, or a trend, of its own in each.
    lowest = max(LOWEST_SHAKING * swing, 1.0 / longest)
    frequencies = np.linspace(lowest, max(HIGHEST_SHAKING * swing, lowest), count)
    alike, apart = np.zeros(count), np.zeros(count)

    def moved_at(part: slice) -> list[Array]:
        angles = {w: 2.0 * np.pi * frequencies[part, None] * m.time for w, m in own.motions.items()}
        return [changes(w, np.concatenate([np.cos(angle), np.sin(angle)])) for w, angle in angles.items()]

    for k in range(0, count, AT_ONCE):
        part = slice(k, k + AT_ONCE)
        moved = moved_at(part)
        alike[part] = _gains(space.measure(moved))
        for window, one in zip(own.motions, moved, strict=True):
            apart[part] += _gains(space.measure([one], only=fitted.windows.index(window)))
    # Windows by themselves only say which frequency to ask them all about.
    best, windows = int(np.argmax(apart)), len(own.motions)
    every = _of_all(space, own, moved_at(slice(best, best + 1)))
    loudness = study.loudness(fitted)
    chances = (chi2.sf(alike.max() / loudness, 2), chi2.sf(every / loudness, 2 * windows))
    chance = min(1.0, count * float(min(chances)))
    # An amplitude and a phase for every window; that they share a frequency is paid for at once.
    together = (every - float(np.log(study.samples)), windows)
    return Test(name, float(alike.max()), 2, chance, (f"at {frequencies[best]:.3g} Hz",), 1, together)


def _of_all(space: Nuisance, own: Probe, moved: Sequence[Array]) -> float:
    """Gain by waves of their own in the windows that move."""
    found = dict(zip(own.motions, moved, strict=True))
    still = [np.zeros((0, len(states))) for states in space.states]
    return jointly(space, [found.get(w, none) for w, none in zip(own.fitted.windows, still, strict=True)])


def _gains(seen: Projected) -> Array:
    """Gain by a cosine and a sine of each frequency (K,)."""
    assert seen.gram is not None
    k = len(seen.along) // 2
    a, b, c = np.diag(seen.gram)[:k], np.diag(seen.gram)[k:], np.diag(seen.gram[:k, k:])
    p, q = seen.along[:k], seen.along[k:]
    # Of two columns by Cramer's rule; those of which nothing is left outside the adjustable gain nothing.
    area = a * b - c**2
    open_ones = area > SHAKING_WAVES_DEPENDENT * np.maximum(a, b).max(initial=0.0) ** 2
    return np.where(open_ones, (b * p**2 - 2.0 * c * p * q + a * q**2) / np.where(open_ones, area, 1.0), 0.0)


def _gravity(names: Sequence[str], system: System, positions: Array) -> Array:
    """Generalized forces of gravity (G, n) of the joints at positions (G, coordinates) of so many names."""
    joints = [names.index(name) for name in system.joint_names]
    # Of a mechanism with loops the tree's, which its motions answer as they can.
    tree = replace(system.rigid(), loops=())
    model, weightless = Denoc(tree), Denoc(replace(tree, gravity=np.zeros(3)))
    q = np.ascontiguousarray(positions[:, joints])
    still = np.zeros_like(q)
    return np.asarray(
        weightless.inverse_dynamics_batch(q, still, still) - model.inverse_dynamics_batch(q, still, still)
    )
