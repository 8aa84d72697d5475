"""A reading that wanders: a course of a channel that is slower than the motion, in every window another.

As half waves over the window, two periods of the swing long or longer (those of a discrete cosine transform), all of which are
taken to begin at zero: a zero that is wrong from the start is another thing.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from harness.diagnose.criticism.check import Check, Remainder, Test
from harness.diagnose.criticism.constants import COLOUR_ERROR_RATIO, WANDERING_HALF_WAVES
from harness.diagnose.criticism.gains import window_by_window
from harness.diagnose.prediction.predictor import Predictor
from harness.diagnose.problem.windows import Window

Array = NDArray[np.float64]

WANDERS = "a reading that wanders"


def _asked(left: Remainder) -> Iterator[Test]:
    """For every channel the gain by such a course."""
    channels = left.predictor.problem.channels
    courses = [_courses(left.predictor, window, left.period) for window in left.fitted.windows]
    if not any(map(len, courses)):
        return
    for c, channel in enumerate(channels):
        columns = []
        for window, own in zip(left.fitted.windows, courses, strict=True):
            signal = np.zeros((len(own), len(channels), window.size))
            signal[:, c] = left.likelihood.colours[c].std * own
            columns.append(left.likelihood.whiten_signal(window, signal))
        gain, amplitudes, size = window_by_window(left.space, columns)
        chance = float(chi2.sf(gain / left.noise, max(size, 1.0))) if gain > COLOUR_ERROR_RATIO * size else 1.0
        extents = [float(np.ptp(a @ own)) for a, own in zip(amplitudes, courses, strict=True)]
        widest = int(np.argmax(extents))
        by = f"by {left.likelihood.colours[c].std * extents[widest]:.2g} {channel.unit}"
        where = (channel.name, f"{by} in {left.predictor.runs[left.fitted.windows[widest].run].name}")
        yield Test(WANDERS, gain, int(size), chance, where, exact=True)


def _courses(predictor: Predictor, window: Window, period: float) -> Array:
    """Half waves over a window (k, T), from zero on; none if no half wave is slow enough."""
    time = predictor.runs[window.run].time[window.first : window.last]
    count = min(int((time[-1] - time[0]) / period), WANDERING_HALF_WAVES)
    turns = np.arange(1, count + 1)[:, None] * (time - time[0]) / (time[-1] - time[0])
    return np.asarray(np.cos(np.pi * turns) - 1.0)


CHECK = Check(WANDERS, _asked, exact=True)
