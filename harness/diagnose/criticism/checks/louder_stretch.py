"""A stretch of a recording that is louder than the others, and is no louder noise: its samples follow one another."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from harness.diagnose.criticism.check import Check, Remainder, Test, nothing_left
from harness.diagnose.criticism.constants import FEWEST_LOUDER_STRETCHES, LOUDER_STRETCH_SAMPLES, LOUDER_STRETCHES
from harness.diagnose.criticism.residual_correlation import by_channel, follows_itself
from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.likelihood import Likelihood

Array = NDArray[np.float64]

LOUDER = "a louder stretch"


def _asked(left: Remainder) -> Iterator[Test]:
    gain, chance = louder_stretch(left.likelihood, left.fitted)
    yield Test(LOUDER, gain, 1, chance, places=-1)


def louder_stretch(likelihood: Likelihood, fitted: Fit) -> tuple[float, float]:
    """Excess of the loudest stretch of the whitened residual over the others, and its chance under noise.

    A stretch counts if it is louder than the usual one, than rounding alone could make it, and if its samples follow one another.
    """
    stretches: list[Array] = []
    rounded: list[float] = []
    channels = len(likelihood.colours)
    for k, own in enumerate(by_channel(fitted, fitted.windows)):
        for part in np.array_split(own, max(LOUDER_STRETCHES // channels, 1)):
            if np.count_nonzero(part) >= LOUDER_STRETCH_SAMPLES:
                stretches.append(part)
                rounded.append(likelihood.roundest(k % channels))
    if len(stretches) < FEWEST_LOUDER_STRETCHES:
        return 0.0, 1.0
    count = np.array([np.count_nonzero(part) for part in stretches])
    square = np.array([float(part @ part) for part in stretches])
    level = np.maximum(max(1.0, float(np.median(square / count))), rounded)
    chances = chi2.sf(square / level, count)
    for k in np.argsort(chances):
        if chances[k] * len(stretches) >= 1.0:
            break
        chances[k] = max(chances[k], follows_itself([stretches[k]]))
    top = int(np.argmin(chances))
    return float(square[top] / level[top] - count[top]), min(1.0, float(chances[top]) * len(stretches))


CHECK = Check(LOUDER, _asked, leaves=nothing_left)
