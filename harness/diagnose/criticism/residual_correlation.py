"""Whether what a fit leaves is a misfit or only noise that is louder in some places: a misfit goes on from sample to sample.

Noise of real sensors is seldom as loud everywhere: outliers, tails heavier than Gaussian, time stamps that are late while the joint
is fast, a motor switched on. None of that is left-out physics as long as samples do not follow one another.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from harness.diagnose.estimation.least_squares import Fit
from harness.diagnose.estimation.likelihood import Likelihood
from harness.diagnose.problem.windows import Window

Array = NDArray[np.float64]

STRETCHES = 16  # of a window, over all channels
FEWEST = 20  # samples that a stretch must have
FEWEST_STRETCHES = 8  # that can be compared
LAGS = 10  # samples over which a misfit is looked for to go on, at most a quarter of a stretch


def by_channel(fitted: Fit, windows: Sequence[Window]) -> list[Array]:
    """Whitened residuals of some of a fit's windows, one (T,) a channel and window, channels of a window in a row."""
    return [
        own
        for window, r in zip(fitted.windows, fitted.linear.residuals, strict=True)
        if window in windows
        for own in r.reshape(-1, window.size)
    ]


def follows_itself(stretches: Sequence[Array]) -> float:
    """Chance that samples of stretches (T,) would follow one another so if they were independent, however loud each of them is.

    Autocorrelations over their own standard errors, which hold for any variance from sample to sample (Lo and MacKinlay, Rev.
    Financ. Stud. 1 (1988) 41, theorem 3; Escanciano and Lobato, J. Econometrics 151 (2009) 140).
    """
    total, count = 0.0, 0
    for lag in range(1, LAGS + 1):
        along, variance = 0.0, 0.0
        for r in stretches:
            if len(r) >= 4 * lag:
                products = r[lag:] * r[:-lag]
                along += float(products.sum())
                variance += float(products @ products)
        if variance > 0.0:
            total += along**2 / variance
            count += 1
    return float(chi2.sf(total, count)) if count else 1.0


def louder_stretch(likelihood: Likelihood, fitted: Fit) -> tuple[float, float]:
    """Excess of the loudest stretch of the whitened residual over the others, and its chance under noise.

    A stretch counts if it is louder than the usual one, than rounding alone could make it, and if its samples follow one another.
    """
    stretches: list[Array] = []
    rounded: list[float] = []
    channels = len(likelihood.colours)
    for k, own in enumerate(by_channel(fitted, fitted.windows)):
        for part in np.array_split(own, max(STRETCHES // channels, 1)):
            if np.count_nonzero(part) >= FEWEST:
                stretches.append(part)
                rounded.append(likelihood.roundest(k % channels))
    if len(stretches) < FEWEST_STRETCHES:
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
