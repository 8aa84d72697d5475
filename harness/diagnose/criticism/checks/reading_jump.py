"""A lasting jump of a channel's reading: a sensor that slips, a zero that was set."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.signal import correlate
from scipy.stats import chi2

from harness.diagnose.criticism.check import Check, Remainder, Test
from harness.diagnose.criticism.constants import READING_JUMP_PLACES
from harness.diagnose.criticism.gains import jointly
from harness.diagnose.estimation.noise_colour import Colour

Array = NDArray[np.float64]

JUMP = "a jump of the reading"


def _asked(left: Remainder) -> Iterator[Test]:
    """Largest gain by one jump, all channels and times counted in its chance; none where every window is too short for one."""
    best, count, where = 0.0, 0, ("", "")
    chosen = []
    for place, window in enumerate(left.fitted.windows):
        if window.size <= 2 * _edge(window.size):
            chosen.append(np.zeros((0, len(left.predictor.problem.channels) * window.size)))
            continue
        loudest = -1.0
        run = left.predictor.runs[window.run]
        edge = _edge(window.size)
        evenly = np.linspace(edge, window.size - edge, min(READING_JUMP_PLACES, window.size // 8)).astype(int)
        residual = left.fitted.linear.residuals[place].reshape(-1, window.size)
        for c, channel in enumerate(left.predictor.problem.channels):
            likely = _likeliest_jumps(left.likelihood.colours[c], residual[c], left.likelihood.weights(window)[c])
            places = np.union1d(evenly, likely)
            signal = np.zeros((len(places), len(left.predictor.problem.channels), window.size))
            signal[:, c] = left.likelihood.colours[c].std * (np.arange(window.size)[None, :] >= places[:, None])
            own = left.likelihood.whiten_signal(window, signal)
            gains = left.space.measure([own], only=place).gains()
            count += window.size
            top = int(np.argmax(gains))
            if gains[top] > loudest:
                loudest, column = float(gains[top]), own[top]
            if gains[top] > best:
                best = float(gains[top])
                where = (channel.name, f"{run.name} at {run.time[window.first + places[top]]:.2f} s")
        chosen.append(column[None])
    if not count:
        return
    chance = min(1.0, count * float(chi2.sf(best / left.noise, 1)))
    every = (jointly(left.space, chosen), sum(map(len, chosen)))
    yield Test(JUMP, best, 1, chance, where, 1, every, exact=True)


def _likeliest_jumps(colour: Colour, residual: Array, weights: Array) -> NDArray[np.intp]:
    """Samples at which a jump would take most from a whitened residual (T,) by itself, whatever else might adjust.

    Between the samples of a grid a jump would be lost: noise that remembers makes of it a single sharp sample.
    """
    step = np.ones(len(residual) + 1)
    step[0] = 0.0  # the first sample of a window is whitened in a way of its own
    shape = colour.whiten(step)[1:]
    along = correlate(residual * weights, shape)[len(residual) - 1 :]
    squares = correlate(weights**2, shape**2)[len(residual) - 1 :]
    edge = _edge(len(residual))
    inside = slice(edge, max(len(residual) - edge, edge))
    gains = along[inside] ** 2 / np.maximum(squares[inside], 1e-12)
    return np.asarray(edge + np.argsort(gains)[-READING_JUMP_PLACES:], dtype=np.intp)


def _edge(samples: int) -> int:
    """Samples at either end of a window among which a jump could not be told from a single reading that is far off."""
    return max(5, min(20, samples // 8))


CHECK = Check(JUMP, _asked, exact=True)
