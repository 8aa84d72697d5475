"""A residual that is louder around the swing's frequency than elsewhere: where a misfit of the motion shows first."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.stats import chi2

from harness.diagnose.criticism.check import Check, Remainder, Test
from harness.diagnose.criticism.constants import COLOUR_ERROR_RATIO, SWING_BAND

SPECTRUM = "the spectrum around the swing"


def _asked(left: Remainder) -> Iterator[Test]:
    """Whether the whitened residual is louder around the swing's frequency than it should be."""
    total, count = 0.0, 0
    beyond, others = 0.0, 0
    channels = len(left.predictor.problem.channels)
    for window, r in zip(left.fitted.windows, left.fitted.linear.residuals, strict=True):
        interval = left.predictor.runs[window.run].interval
        for x in r.reshape(channels, window.size):
            if np.count_nonzero(x) < 0.5 * len(x):
                continue
            power = np.abs(np.fft.rfft(x)) ** 2 / max(np.count_nonzero(x), 1)
            frequency = np.fft.rfftfreq(len(x), interval)
            inside = (frequency > SWING_BAND[0] / left.period) & (frequency < SWING_BAND[1] / left.period)
            total += float(power[inside].sum())
            count += int(inside.sum())
            above = frequency >= SWING_BAND[1] / left.period
            beyond += float(power[above].sum())
            others += int(above.sum())
    # Noise that is louder for a while is so at all frequencies.
    total /= max(1.0, beyond / others) if others > count else 1.0
    if count < 10:
        yield Test(SPECTRUM, 0.0, 1, 1.0)
        return
    # Powers of white noise are exponential: twice their sum is chi-squared with two degrees of freedom each.
    chance = float(chi2.sf(2.0 * total, 2 * count)) if total > COLOUR_ERROR_RATIO * count else 1.0
    yield Test(SPECTRUM, 2.0 * (total - count), count, chance, places=-1)


CHECK = Check(SPECTRUM, _asked)
